"""THE list of contenders: a module a line, in the order of the tables."""

from __future__ import annotations

import importlib
import sys

from contenders.contender import Contender

MODULES = ("compiled", "pendcore_python", "cyrk", "scipy_rk45")


def installed() -> list[Contender]:
    """Find the contenders whose packages or programs are here; stderr says why others are not."""
    found: list[Contender] = []
    for module in MODULES:
        try:
            found += importlib.import_module(f"contenders.{module}").CONTENDERS
        except ImportError as absence:
            print(f"{module}: left out: {absence}", file=sys.stderr)
    return found
