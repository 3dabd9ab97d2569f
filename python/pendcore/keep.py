"""What an ensemble keeps of each member: reducers for the ``keep`` of `pendcore.ensemble`."""

from __future__ import annotations

from pendcore.ensemble.keep import FirstEvent, Reducer

__all__ = ["FirstEvent", "Reducer"]
