"""Random starts and parameters for ensembles, functions of a seed and an index alone.

Sample number k of a seed is the same however many samples are drawn: a larger ensemble has those of
a smaller one first. The generator is Philox (Salmon, Moraes, Dror and Shaw, SC11, 2011), NumPy's.
"""

from __future__ import annotations

from pendcore._ensemble.sampling import normal, uniform

__all__ = ["normal", "uniform"]
