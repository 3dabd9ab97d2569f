"""What an ensemble keeps of each member: reducers for the ``keep`` of `pendcore.ensemble`."""

from __future__ import annotations

from pendcore._ensemble.reducers import EnergyDrift, Extremes, FirstEvent, LargestExponent, Reducer

__all__ = ["EnergyDrift", "Extremes", "FirstEvent", "LargestExponent", "Reducer"]
