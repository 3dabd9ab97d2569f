"""`pendcore run`: simulate a case; write its solution, summary and figure into a folder."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from pendcore.archive import save
from pendcore.case import Case
from pendcore.case_file import read_case
from pendcore.cli.usage import blamed_on_usage
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
  [start]
  q_deg = [45, 60]                 # from the horizontal, downward; or q in rad
  [run]
  t_end = 5.0                      # s; also rtol, t_eval, ...: any keyword of pendcore.simulate()
"""


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
        folder.mkdir(parents=True, exist_ok=True)
    with blamed_on_usage(str(args.case)):
        solution = _simulated(case)
    found = facts(solution, case)
    _write(folder, solution, case, found)
    print(json.dumps(found, indent=2) if args.json else text(found), end="\n" * args.json)
    print(f"written to {folder}", file=sys.stderr)
    if not solution.success:
        print(f"the run failed: {solution.message}", file=sys.stderr)
    return 0 if solution.success else 1


def _simulated(case: Case) -> Solution:
    try:
        return case.simulate()
    except KeyboardInterrupt as stop:
        return stop.solution  # type: ignore[attr-defined,no-any-return]


def _write(folder: Path, solution: Solution, case: Case, found: dict[str, Any]) -> None:
    save(solution, folder / "solution.npz", case.name)
    (folder / "summary.txt").write_text(text(found), encoding="utf-8")
    (folder / "summary.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    save_figure(solution, folder / "angles.png")
