"""`pendcore plot`: draw a saved solution."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from pendcore.cli.arguments import add_flags, add_number, add_out, load_solution
from pendcore.cli.files_to_write import named_if_lost
from pendcore.cli.usage import blamed_on_usage, written
from pendcore.messages import whole_file
from pendcore.plotting import KINDS, save_figure

HELP = "draw a saved solution"
DESCRIPTION = "Draw a figure: without --what the textbook's, the angles in degrees over time."
EPILOG = """
example:
  pendcore plot out/textbook/solution.npz -o angles.pdf
  pendcore plot out/textbook/solution.npz --what path -o path.png
  pendcore plot out/textbook/solution.npz --what free_bodies --at 1.5 -o bodies.png
"""


DRAWN = [kind for kind in KINDS if kind != "section"]
"""A section needs events, which a saved solution does not always have."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("solution", type=Path, metavar="RUN.npz", help="written by `pendcore run`")
    told = "figure to write, its kind from the suffix (png, pdf, svg); default: RUN.png"
    add_out(parser, "FILE", told)
    told = "which figure (default: angles)"
    parser.add_argument("--what", choices=DRAWN, default="angles", help=told)
    add_number(parser, "--at", "T", "s, the time at which free_bodies are shown")
    told = "shade what lies past the time until which the error of an angle is below this"
    add_number(parser, "--horizon", "RAD", told)
    add_flags(parser, json="print what was written as JSON")


def execute(args: argparse.Namespace) -> int:
    out = args.out or args.solution
    if args.out is None or not out.suffix:
        out = out.with_suffix(".png")
    with blamed_on_usage():
        solution = load_solution(args.solution)
        where = written(out, [out])
        out.parent.mkdir(parents=True, exist_ok=True)
        with named_if_lost(out), whole_file(out) as path:
            save_figure(solution, path, what=args.what, t=args.at, horizon=args.horizon)
    print(where, file=sys.stderr)
    if args.json:
        print(json.dumps({"figure": str(out), "status": solution.status}))
    return 0
