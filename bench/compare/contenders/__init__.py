"""THE list of contenders: each line is a module, in the order of the tables."""

from __future__ import annotations

import importlib

from contenders.contender import Contender
from contenders.programs import SOLVERS, solvers_of

MODULES = ("heyoka_taylor", "pendcore_python", "cyrk", "scipy_solvers")


def installed() -> tuple[list[Contender], dict[str, str]]:
    """Find the contenders that are installed or built, and the reasons why others are not."""
    found: list[Contender] = []
    absent: dict[str, str] = {}
    for program in SOLVERS:
        try:
            found += solvers_of(program)
        except (ImportError, OSError) as absence:
            absent[program] = str(absence)
    for module in MODULES:
        try:
            found += importlib.import_module(f"contenders.{module}").CONTENDERS
        except ImportError as absence:
            absent[module] = str(absence)
    return found, absent
