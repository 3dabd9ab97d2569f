"""The arguments of commands that read a case and write into a folder."""

from __future__ import annotations

import argparse
from pathlib import Path

from pendcore import Case, read_case


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
