"""The keywords of `pendcore.simulate` that say how to run, and their defaults."""

from __future__ import annotations

from math import inf
from types import MappingProxyType
from typing import Any

RUN_DEFAULTS: MappingProxyType[str, Any] = MappingProxyType(
    {
        "method": "auto",
        "rtol": 1e-9,
        "atol": 1e-12,
        "t_eval": None,
        "store": None,
        "first_step": None,
        "max_step": inf,
        "step": None,
        "max_steps": 10_000_000,
        "time_limit": None,
        "events": (),
        "ledger": False,
        "compensated": False,
        "error": None,
        "check": None,
        "progress": None,
    }
)
"""In the order of the signature; a test compares the two."""
