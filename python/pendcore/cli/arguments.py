"""The arguments that several commands take: a case, a saved solution, a folder."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from pendcore import AccuracyError, Case, Solution, load, read_case
from pendcore.cli.usage import UsageError


def add_case(parser: argparse.ArgumentParser, *, or_solution: bool = False) -> None:
    """Add the argument for a case, or for a saved solution as well."""
    what, metavar = "what to simulate", "CASE.toml"
    if or_solution:
        what, metavar = "a solution that `pendcore run` wrote, or a case", "RUN.npz|CASE.toml"
    told = f"{what}; default: the textbook's case"
    parser.add_argument("case", nargs="?", type=Path, metavar=metavar, help=told)


def add_out(
    parser: argparse.ArgumentParser,
    metavar: str = "FOLDER",
    told: str = "default: out/ and the name of the case",
) -> None:
    """Add the option for what is written."""
    parser.add_argument("-o", "--out", type=Path, metavar=metavar, help=told)


def add_number(
    parser: argparse.ArgumentParser,
    name: str,
    metavar: str,
    told: str,
    default: float | None = None,
    kind: type = float,
) -> None:
    """Add an option that is a number."""
    told += "" if default is None else "; default: %(default)s"
    parser.add_argument(name, type=kind, default=default, metavar=metavar, help=told)


def add_flags(parser: argparse.ArgumentParser, **told: str) -> None:
    """Add options without a value, each with its help."""
    for name, text in told.items():
        parser.add_argument(f"--{name.replace('_', '-')}", action="store_true", help=text)


def case_of(args: argparse.Namespace) -> Case:
    """Return the case that was named, or the textbook's."""
    return Case.textbook() if args.case is None else read_case(args.case)


def folder_of(args: argparse.Namespace) -> Path:
    """Return the folder that was named, or one named after the case."""
    return args.out or Path("out", args.case.stem if args.case else "textbook")


def load_solution(path: Path) -> Solution:
    """Read a solution; an ensemble is refused with a ValueError."""
    found = load(path)
    if not isinstance(found, Solution):
        raise ValueError(f"{path}: is an ensemble, not a solution: pc.load() reads it, in Python")
    return found


def solution_of(args: argparse.Namespace) -> Solution:
    """Return the solution that was named, or that of the case; the most accurate, if none will do.

    Where nothing was computed, as an error that a case asks for cannot be kept, it is a UsageError.
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
