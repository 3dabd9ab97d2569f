"""The arguments that several commands take: a case, a saved solution, a folder."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pendcore import AccuracyError, Case, Solution, load, read_case
from pendcore.cli.usage import UsageError


def add_case_and_folder(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for the case and the folder."""
    parser.add_argument("case", nargs="?", type=Path, metavar="CASE.toml", help="what to simulate")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FOLDER", help="default: out/ and the name of the case"
    )


def case_of(args: argparse.Namespace) -> Case:
    """Return the case that was named, or the textbook's."""
    return Case.textbook() if args.case is None else read_case(args.case)


def folder_of(args: argparse.Namespace) -> Path:
    """Return the folder that was named, or one named after the case."""
    return args.out or Path("out", args.case.stem if args.case else "textbook")


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
