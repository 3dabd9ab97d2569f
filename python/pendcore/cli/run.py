"""`pendcore run`: simulate a case; write its solution, summary and figure into a folder."""

from __future__ import annotations

import argparse
import csv
import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pendcore import AccuracyError, Case, Solution
from pendcore.case_files import KEYS, with_line
from pendcore.cli import arguments
from pendcore.cli.files_to_write import FilesToWrite
from pendcore.cli.horizon import Horizon, unasked_horizon
from pendcore.cli.summary import facts, text
from pendcore.cli.usage import UsageError, blamed_on_usage, new_folder
from pendcore.cli.words import CHOSEN_FOR_ERROR, of_the_run
from pendcore.messages import reporting
from pendcore.plotting import save_figure

HELP = "simulate a case, write solution, summary and figure"
DESCRIPTION = "Simulate a case; without one, the textbook's double pendulum."
EPILOG = """
what is written into the folder:
  solution.npz   t (s), q (rad), qd (rad/s), y, the case as TOML; pendcore.load() reads it whole
  summary.txt    what was simulated, how it ended, what it took, drift of energy, largest reactions
  summary.json   the same facts for programs
  angles.png     the angles in degrees over time
  states.csv     t (s), q (rad), qd (rad/s) for spreadsheets, with --csv
Ctrl-C ends the run, and all of these files are written, the figure last. If a file is being
written, Ctrl-C or an error, such as a full disk, leaves that file out, and the others are written.
No file is incomplete.

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
  # docs/how_to/case_files.md has every key, docs/effects a page per effect
"""

FILES = ("summary.txt", "summary.json", "solution.npz", "angles.png")
CSV = "states.csv"
_START = re.compile(r"(q0|qd0)\[(\d+)\]")
_MANY_STEPS = 100_000
"""The number of steps above which writing the solution takes seconds."""
_ROWS_AT_ONCE = 10_000
"""The number of rows of a CSV file between two reports of progress."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    arguments.add_case(parser)
    arguments.add_out(parser)
    told = "largest position error / total length to keep: method and tolerances are chosen, in "
    told += "place of those of the case, and the run is verified"
    arguments.add_number(parser, "--error", "E", told)
    parser.add_argument("--method", metavar="NAME", help="method, in place of that of the case")
    for name, kind in (("rtol", "relative"), ("atol", "absolute")):
        told = f"{kind} tolerance, in place of that of the case"
        arguments.add_number(parser, f"--{name}", "X", told)
    arguments.add_number(parser, "--step", "X", "s, a fixed step, in place of tolerances")
    parser.add_argument(
        "--parameters",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME=VALUE",
        help="replace numbers of the case: gravity=1.62, link[2].mass=0.9, q0[1]=0.5, ...; "
        "scene.parameters() lists those of a scene",
    )
    arguments.add_flags(
        parser,
        no_horizon="do not estimate until when the run is right: that takes second runs",
        csv=f"write the states into {CSV} as well, a row per time",
        json="print the summary as JSON",
    )


def execute(args: argparse.Namespace) -> int:
    with blamed_on_usage():
        case = arguments.case_of(args)
        case = _with_parameters(case, args.parameters) if args.parameters else case
        case = _with_options(case, _options_of(args))
    folder = arguments.folder_of(args)
    with new_folder(folder):
        solution, complaint, refusal = _simulated(case, args)
        files = FilesToWrite(folder, (*FILES, CSV) if args.csv else FILES)
        horizon = None if args.no_horizon else unasked_horizon(solution)
        found = _write(files, solution, refusal, horizon)
        print(files.outcome(), file=sys.stderr)
        if not solution.success:
            complaint = f"the run is not complete: {solution.message}"
        complaint = complaint or solution.why_unverified
        if complaint:
            print(complaint, file=sys.stderr)
        if solution.can_resume and "solution.npz" not in files.left_out:
            t_end = solution.case().t_span[1]
            file = str(folder / "solution.npz")
            print(f"to go on, in Python: pc.load({file!r}).resume({t_end!r})", file=sys.stderr)
        if found:
            print(json.dumps(found, indent=2) if args.json else text(found), end="\n" * args.json)
        files.refuse_if_none()
    return 1 if complaint or files.left_out else 0


def _simulated(case: Case, args: argparse.Namespace) -> tuple[Solution, str, str]:
    """Return the run, the complaint about it, and the refusal of the error in that complaint."""
    try:
        return case.simulate(on_failure="ignore"), "", ""  # the complaint comes once, at the end
    except (ValueError, TypeError) as error:
        given = [*_options_of(args)]
        if "method" in given and "step" not in case.options:
            given.append("step")  # which the method needs
        is_of_the_command = re.split(r"\W", str(error))[0] in given
        if args.case is None or is_of_the_command:
            raise UsageError(f"--{error}" if is_of_the_command else str(error)) from None
        raise UsageError(with_line(args.case, str(error))) from None
    except (KeyboardInterrupt, AccuracyError) as stop:
        if isinstance(so_far := getattr(stop, "solution", None), Solution):
            return so_far, str(stop) or "interrupted", str(stop)
        raise


def _options_of(args: argparse.Namespace) -> dict[str, Any]:
    """Return the options of the run that the command line has."""
    found = {name: getattr(args, name) for name in ("error", *CHOSEN_FOR_ERROR)}
    return {name: value for name, value in found.items() if value is not None}


def _with_parameters(case: Case, given: list[str]) -> Case:
    """Return the case with numbers replaced, each ``NAME=VALUE``.

    A name is that of a parameter of the scene, or of the start: ``q0[1]``, ``qd0[2]``.
    """
    starts: dict[str, Any] = {"q0": list(case.q0), "qd0": list(case.qd0)}
    of_scene: dict[str, float] = {}
    names, n = set[str](), len(case.q0)
    for one in given:
        name, equals, text = one.partition("=")
        if name in names:
            raise UsageError(f"--parameters {one}: {name} is given twice: give it once")
        names.add(name)
        if name in KEYS["run"]:
            shorter = f", or give --{name} {text}" if name in ("error", *CHOSEN_FOR_ERROR) else ""
            raise UsageError(f"--parameters {one}: {of_the_run(name, text)}{shorter}")
        try:
            value = float(text)
        except ValueError:
            equals = ""
        if not equals:
            raise UsageError(f"--parameters {one}: must be NAME=VALUE, such as link[2].mass=0.9")
        start = _START.fullmatch(name)
        if name in starts:
            raise UsageError(f"--parameters {one}: must say of which link, such as {name}[1]")
        if start is None:
            of_scene[name] = value
        elif not 1 <= int(start[2]) <= n:
            raise UsageError(f"--parameters {one}: the scene has {n} links, counted from 1")
        else:
            starts[start[1]][int(start[2]) - 1] = value
    return replace(case, scene=case.scene.with_parameters(of_scene), **starts)


def _with_options(case: Case, given: dict[str, Any]) -> Case:
    """Return the case with other options, and without those that they take the place of."""
    gone = set(given)
    if "error" in given:
        gone.update(CHOSEN_FOR_ERROR)
    elif given:
        gone.add("error")
    if "rtol" in given or "atol" in given:
        gone.add("step")
    lost = {name: value for name, value in case.options.items() if name in gone - set(given)}
    if lost:
        told = ", ".join(f"{name} = {value}" for name, value in lost.items())
        print(f"left out of the case: {told} (--{' --'.join(given)} in its place)", file=sys.stderr)
    kept = {name: value for name, value in case.options.items() if name not in gone}
    return replace(case, options=kept | given)


def _write(
    files: FilesToWrite, solution: Solution, refusal: str, horizon: Horizon | None
) -> dict[str, Any]:
    """Write small files first, the figure last; return the facts, if there was time for them."""
    found: dict[str, Any] = {}
    until = None if horizon is None else horizon.valid_until
    if (steps := solution.stats.accepted) > _MANY_STEPS:
        print(f"writing {steps} steps to {files.folder}", file=sys.stderr)
    with files.needed_for("summary.txt", "summary.json"):
        found = facts(solution, refusal)
        found |= {"valid_until": until, "horizon": horizon and horizon.sentence}
    if found:
        with files.one("summary.txt") as path:
            path.write_text(text(found), encoding="utf-8")
        with files.one("summary.json") as path:
            path.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    with files.needed_for("solution.npz"):
        solution.save(files.folder / "solution.npz")
    if CSV in files.names:
        with files.one(CSV) as path:
            _write_csv(solution, path)
    with files.one("angles.png") as path:
        save_figure(solution, path, until)
    return found


def _write_csv(solution: Solution, path: Path) -> None:
    """Write a row per time: t (s), q_1.. (rad), qd_1.. (rad/s), every number with all its digits.

    The first row names columns and units. A jump has two rows at one time.
    """
    links = range(1, len(solution.scene.links) + 1)
    names = ["t (s)", *(f"q_{i} (rad)" for i in links), *(f"qd_{i} (rad/s)" for i in links)]
    rows = np.column_stack([solution.t, solution.q, solution.qd])
    with (
        reporting(None, f"writing {path.name}") as report,
        path.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(names)
        for begin in range(0, len(rows), _ROWS_AT_ONCE):
            writer.writerows(rows[begin : begin + _ROWS_AT_ONCE].tolist())
            report(min(begin + _ROWS_AT_ONCE, len(rows)) / len(rows))
