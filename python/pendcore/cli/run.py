"""`pendcore run`: simulate a case; write its solution, summary and figure into a folder."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pendcore.archive import save
from pendcore.case import Case
from pendcore.case_file import read_case, with_line
from pendcore.cli.usage import UsageError, blamed_on_usage, written
from pendcore.solution import Solution
from pendcore.views.plot import save_figure
from pendcore.views.summary import facts, text

_EPILOG = """
what is written into the folder:
  solution.npz   t (s), q (rad), qd (rad/s), y, the case as TOML; pendcore.load() reads it whole
  summary.txt    what was simulated, how it ended, what it took, drift of energy, largest reactions
  summary.json   the same facts for programs
  angles.png     the angles in degrees over time

a case:
  gravity = 9.807                  # m/s^2
  [[link]]                         # uniform rods, from the pivot outwards
  mass = 1.0                       # kg
  length = 1.0                     # m
  [[link]]
  mass = 1.0
  length = 1.0
  [[effect]]                       # none is needed; pendcore.effects has the kinds
  kind = "viscous_joint"
  joint = 2
  damping = 0.05                   # N m s/rad
  [start]
  q_deg = [45, 60]                 # from the horizontal, downward; or q in rad
  [run]
  t_end = 5.0                      # s; also rtol, t_eval, ...: any keyword of pendcore.simulate()
  # docs/case_files.md has every key, docs/effects a page per effect
"""

FILES = ("solution.npz", "summary.txt", "summary.json", "angles.png")
_CAN_GO_ON = {"max_steps", "max_turns", "time_limit", "interrupted"}


def add_parser(commands: Any) -> None:
    """Add the sub-command and its arguments."""
    parser = commands.add_parser(
        "run",
        help="simulate a case, write solution, summary and figure",
        description="Simulate a case; without one, the textbook's double pendulum.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("case", nargs="?", type=Path, metavar="CASE.toml", help="what to simulate")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FOLDER", help="default: out/ and the name of the case"
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    parser.set_defaults(execute=execute)


def execute(args: argparse.Namespace) -> int:
    """Do it; return the exit status."""
    with blamed_on_usage():
        case = Case.textbook() if args.case is None else read_case(args.case)
    folder = args.out or Path("out", args.case.stem if args.case else "textbook")
    with _ready(folder):
        solution = _simulated(case, args.case)
    found = facts(solution)
    where = written(folder, [folder / name for name in FILES])
    _write(folder, solution, found)
    print(where, file=sys.stderr)
    if not solution.success:
        print(f"the run is not complete: {solution.message}", file=sys.stderr)
    if solution.status in _CAN_GO_ON:
        t_end = found["run"]["t_end"]
        file = str(folder / "solution.npz")
        print(f"to go on, in Python: pc.load({file!r}).resume({t_end!r})", file=sys.stderr)
    print(json.dumps(found, indent=2) if args.json else text(found), end="\n" * args.json)
    return 0 if solution.success else 1


@contextmanager
def _ready(folder: Path) -> Iterator[None]:
    """Make the folder before a run may take hours, and leave none behind if nothing comes of it."""
    new = [path for path in (folder, *folder.parents) if not path.exists()]
    with blamed_on_usage():
        folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        with suppress(OSError):
            for path in new:
                path.rmdir()
        raise


def _simulated(case: Case, file: Path | None) -> Solution:
    try:
        return case.simulate()
    except (ValueError, TypeError) as error:
        raise UsageError(with_line(file, str(error)) if file else str(error)) from None
    except KeyboardInterrupt as stop:
        if isinstance(so_far := getattr(stop, "solution", None), Solution):
            return so_far
        raise


def _write(folder: Path, solution: Solution, found: dict[str, Any]) -> None:
    save(solution, folder / "solution.npz")
    (folder / "summary.txt").write_text(text(found), encoding="utf-8")
    (folder / "summary.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    save_figure(solution, folder / "angles.png")
