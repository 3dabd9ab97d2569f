"""`pendcore show`: a case or a saved solution as a page, a film, or a strip of positions."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from pendcore import Solution
from pendcore.cli import arguments
from pendcore.cli.files_to_write import named_if_lost
from pendcore.cli.usage import UsageError, blamed_on_usage, written
from pendcore.messages import whole_file
from pendcore.page.html import why_it_plays_back
from pendcore.plotting import save_figure

HELP = "see a case move: a page, a film, or a strip of positions"
DESCRIPTION = "Write a page that simulates a case, a film of it, or a strip of positions."
EPILOG = """
examples:
  pendcore show swing.toml                         a page with the core inside: out/swing.html
  pendcore show swing.toml -o swing.mp4            a film, in true time
  pendcore show swing.toml -o swing.gif --speed 0.5 --reactions
  pendcore show out/swing/solution.npz -o swing.png   a strip of positions

ffmpeg writes MP4; where it is missing, a GIF is written instead.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    arguments.add_case(parser, or_solution=True)
    told = "its suffix: html, mp4, gif, png; default: out/ and the name of the case, .html"
    arguments.add_out(parser, "FILE", told)
    arguments.add_number(parser, "--speed", "X", "1, the default, is true time, 0.25 slow motion")
    arguments.add_number(parser, "--fps", "N", "frames a second (default: 30)")
    arguments.add_number(parser, "--trace", "S", "s of the tip's path that are shown (default: 2)")
    told = "draw the run pale once the error of an angle may be above this"
    arguments.add_number(parser, "--horizon", "RAD", told)
    arguments.add_flags(
        parser,
        reactions="show the forces at the joints as arrows",
        energy="show the energies over time",
        json="print what was written as JSON",
    )


def execute(args: argparse.Namespace) -> int:
    args.out = args.out or Path("out", f"{args.case.stem if args.case else 'textbook'}.html")
    if args.out.suffix.lower() not in (".html", ".mp4", ".gif", ".png"):
        raise UsageError(f"-o {args.out}: must end with .html, .mp4, .gif or .png")
    if args.out.suffix.lower() not in (".mp4", ".gif"):
        for name in _of_films(args):
            raise UsageError(f"--{name}: is for films: -o FILE.mp4 or FILE.gif")
    with blamed_on_usage():
        solution = arguments.solution_of(args)
        args.out.parent.mkdir(parents=True, exist_ok=True)
        where = written(args.out, [args.out])
        with named_if_lost(args.out):
            out = _write(solution, args)
    print(where if out == args.out else f"written to {out}", file=sys.stderr)
    if out.suffix == ".html" and (told := why_it_plays_back(solution)):
        print(told, file=sys.stderr)
    if not solution.success:
        print(f"the run is not complete: {solution.message}", file=sys.stderr)
    if args.json:
        print(json.dumps({"file": str(out), "status": solution.status}))
    return 0 if solution.success else 1


def _of_films(args: argparse.Namespace) -> dict[str, Any]:
    """Return the options of films that were given."""
    names = ("speed", "fps", "trace", "reactions", "energy", "horizon")
    given = {name: getattr(args, name) for name in names}
    return {name: x for name, x in given.items() if x is not None and x is not False}


def _write(solution: Solution, args: argparse.Namespace) -> Path:
    if args.out.suffix.lower() == ".html":
        return solution.to_html(args.out)
    if args.out.suffix.lower() == ".png":
        with whole_file(args.out) as path:
            save_figure(solution, path, what="strip")
        return Path(args.out)
    return solution.to_video(args.out, **_of_films(args))
