"""`pendcore cost`: measure what accuracy costs on a case; write table, figure and JSON."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from pendcore import Case
from pendcore.cli import arguments
from pendcore.cli.files_to_write import FilesToWrite
from pendcore.cli.usage import UsageError, blamed_on_usage, new_folder
from pendcore.cost.accuracy_cost import FIGURE_SIZE, AccuracyCost, text
from pendcore.cost.sweep import REPEATS, TIME_LIMIT, accuracy_cost
from pendcore.messages import at_least, positive
from pendcore.options import OPTIONS
from pendcore.plotting import new_axes

HELP = "measure what accuracy costs on a case: errors and times of every method"
DESCRIPTION = "Sweep methods and tolerances on a case; without one, the textbook's."
EPILOG = """
what is written into the folder:
  cost.txt    error, time and right-hand sides of every method at every tolerance; what to take
  cost.png    time against error, a line for each method
  cost.json   the same numbers for programs

example:
  pendcore cost swing.toml --error 1e-9
"""

FILES = ("cost.txt", "cost.json", "cost.png")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    arguments.add_case(parser)
    arguments.add_out(parser)
    told = "error to recommend a method for: largest position error / total length"
    arguments.add_number(parser, "--error", "E", told, 1e-6)
    told = "default: all that can carry the case"
    parser.add_argument("--methods", metavar="A,B,...", help=told)
    arguments.add_number(parser, "--time-limit", "S", "seconds that it may take", TIME_LIMIT)
    told = "timed calls of each method, as far as the time allows"
    arguments.add_number(parser, "--repeats", "N", told, REPEATS, int)
    arguments.add_flags(parser, json="print the numbers as JSON")


def execute(args: argparse.Namespace) -> int:
    from matplotlib.figure import Figure

    with blamed_on_usage():
        at_least("--repeats", args.repeats, 1)
        positive("--error", args.error, "of the total length")
        positive("--time-limit", args.time_limit, "s")
        case = arguments.case_of(args)
    folder = arguments.folder_of(args)
    with new_folder(folder):
        cost, whole = _measured(case, args)
        files = FilesToWrite(folder, FILES)
        table = text(cost, args.error)
        with files.one("cost.txt") as path:
            path.write_text(table, encoding="utf-8")
        with files.one("cost.json") as path:
            path.write_text(cost.to_json() + "\n", encoding="utf-8")
        with files.one("cost.png") as path:
            (axes,) = new_axes(FIGURE_SIZE, new_figure=Figure)
            cost.plot(axes)
            figure: Any = axes.figure
            figure.savefig(path, dpi=160)
        print(files.outcome(), file=sys.stderr)
        if not whole:
            print("interrupted: this is what was measured until then", file=sys.stderr)
        print(cost.to_json() if args.json else table, end="\n" * args.json)
        files.refuse_if_none()
    return 0 if whole and not files.left_out else 1


def _measured(case: Case, args: argparse.Namespace) -> tuple[AccuracyCost, bool]:
    """Return what was measured, and whether the measurement is complete."""
    options = {key: x for key, x in case.options.items() if OPTIONS[key].limits_every_method}
    try:
        return accuracy_cost(
            case.scene, case.t_span, case.q0, case.qd0,
            methods=None if args.methods is None else args.methods.split(","),
            repeats=args.repeats, time_limit=args.time_limit, name=case.name, **options,
        ), True  # fmt: skip
    except (ValueError, TypeError) as error:
        raise UsageError(str(error)) from None
    except KeyboardInterrupt as stop:
        so_far = getattr(stop, "accuracy_cost", None)
        if isinstance(so_far, AccuracyCost) and so_far.points:
            return so_far, False
        raise
