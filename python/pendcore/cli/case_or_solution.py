"""The argument of commands that take a case or a saved solution."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pendcore import AccuracyError, Solution, load
from pendcore.cli.case_and_folder import case_of
from pendcore.cli.usage import UsageError


def add_case_or_solution(parser: argparse.ArgumentParser) -> None:
    """Add the argument."""
    parser.add_argument(
        "case",
        nargs="?",
        type=Path,
        metavar="RUN.npz|CASE.toml",
        help="a solution that `pendcore run` wrote, or a case; default: the textbook's case",
    )


def load_solution(path: Path) -> Solution:
    """Read a solution; an ensemble is refused with a ValueError."""
    found = load(path)
    if not isinstance(found, Solution):
        raise ValueError(f"{path}: is an ensemble, not a solution: pc.load() reads it, in Python")
    return found


def solution_of(args: argparse.Namespace) -> Solution:
    """Return the solution that was named, or that of the case; the most accurate, if none will do.

    Raises
    ------
    UsageError
        If a case asks for an error that cannot be kept, and nothing was computed.
    """
    if args.case is not None and args.case.suffix == ".npz":
        return load_solution(args.case)
    try:
        return case_of(args).simulate(on_failure="ignore")
    except AccuracyError as refusal:
        if not isinstance(refusal.solution, Solution):
            raise UsageError(str(refusal)) from None
        print(f"{refusal}; what follows is about the most accurate run", file=sys.stderr)
        return refusal.solution
