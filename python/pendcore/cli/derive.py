"""`pendcore derive`: the equations of motion in symbols, as text, LaTeX, code or a report."""

from __future__ import annotations

import argparse
import shutil
import sys
from typing import Any

import pendcore
from pendcore import Case
from pendcore.cli.arguments import add_case, add_flags, add_out, case_of, folder_of
from pendcore.cli.files_to_write import named_if_lost
from pendcore.cli.usage import UsageError, blamed_on_usage, new_folder, written
from pendcore.messages import whole_file

HELP = "derive the equations of motion in symbols: steps, code, a report"
DESCRIPTION = "Derive the equations of motion of a case in symbols, as the textbook does."
EPILOG = """
forms:
  text     every step of the derivation, as text
  latex    the same for LaTeX with amsmath
  octave   a function file for MATLAB and Octave, like the textbook's RR.m
  inline   the same as the textbook's inline function
  python   a module for NumPy
  cpp      a header for C++
  report   a folder: derivation, numbers, solution and its plots, to hand in or to teach from

examples:
  pendcore derive                               the textbook's double pendulum, step by step
  pendcore derive --to octave -o RR.m
  pendcore derive swing.toml --to report -o homework --worksheet
"""

FORMS = ("text", "latex", "octave", "inline", "python", "cpp", "report")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_case(parser)
    parser.add_argument("--to", choices=FORMS, default="text", help="default: %(default)s")
    told = "the file to write, default: print the text; for a report the folder, default: out/ and "
    add_out(parser, "PATH", f"{told}the case's name")
    add_flags(parser, worksheet="write a worksheet beside the report: the same with blanks")


def execute(args: argparse.Namespace) -> int:
    if args.worksheet and args.to != "report":
        raise UsageError("--worksheet: belongs to a report: add --to report")
    with blamed_on_usage():
        case = case_of(args)
        derivation = pendcore.derive.Derivation(case.scene)
    if args.to == "report":
        return _report(derivation, case, args)
    with blamed_on_usage("-o"):
        text = _text(derivation, args)
    if args.out is None:
        print(text, end="")
        return 0
    where = written(args.out, [args.out])
    with blamed_on_usage():
        args.out.parent.mkdir(parents=True, exist_ok=True)
    with named_if_lost(args.out), whole_file(args.out) as path:
        path.write_text(text, encoding="utf-8")
    print(where, file=sys.stderr)
    return 0


def _text(derivation: Any, args: argparse.Namespace) -> str:
    if args.to == "octave":  # the function is called what its file is called
        return str(derivation.to_octave(args.out.stem if args.out else "RR"))
    of = {"inline": "to_octave_inline", "python": "to_python", "cpp": "to_cpp", "latex": "latex"}
    return str(getattr(derivation, of[args.to])() if args.to in of else derivation)


def _report(derivation: Any, case: Case, args: argparse.Namespace) -> int:
    folder = folder_of(args)
    with new_folder(folder), blamed_on_usage(), named_if_lost(folder):
        made = derivation.report(case, folder, worksheet=args.worksheet)
    print(f"written to {folder}: {', '.join(path.name for path in made)}", file=sys.stderr)
    if shutil.which("pandoc") is None:
        print("no .html and .pdf: these need pandoc, which is not installed", file=sys.stderr)
    return 0 if made.is_whole else 1
