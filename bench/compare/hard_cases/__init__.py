"""Hard cases, run by pendcore and its peers: the list is cases.toml, a class each has the scene."""

from __future__ import annotations

import datetime
import sys
import tomllib
from functools import cache
from importlib import metadata
from math import isfinite
from pathlib import Path
from typing import Any

from machine import machine
from record import Point, Record

from hard_cases.outcome import Absent, Outcome, run_bounded

CASES: dict[str, Any] = tomllib.loads((Path(__file__).parent / "cases.toml").read_text("utf-8"))
FACTS: dict[str, Any] = {
    "title": "",
    "scene": "",
    "answer": "",
    "unit": "",
    "allowed": 0.0,
    "figure": "",
    "loop_not_run": [],
}


@cache
def scene(name: str) -> Any:
    """Return the scene of a case."""
    from hard_cases import accuracy, endings, events, friction, scales

    wanted = name.replace("_", "")
    for module in (friction, events, endings, scales, accuracy):
        for kind in vars(module).values():
            if isinstance(kind, type) and kind.__name__.lower() == wanted:
                return kind()
    raise KeyError(name)


def run(name: str, program: str, arguments: dict[str, Any]) -> Outcome:
    how = {key: value for key, value in arguments.items() if key != "own_loop"}
    return run_bounded(lambda: scene(name).run(program, **how))


def row_of(name: str, program: str, how: str, arguments: dict[str, Any]) -> Point:
    """Run a contender; return its row."""
    outcome = run(name, program, arguments)
    error = None if outcome.error is None else float(outcome.error)
    right = outcome.right
    if right is None:
        right = error is not None and error <= CASES[name]["allowed"]
    return {
        "contender": program,
        "case": name,
        "setting": how,
        "error": error if error is not None and isfinite(error) else None,
        "said": outcome.said,
        "right": bool(right),
        "own_loop": arguments.get("own_loop", False),
        "trace": shortened(outcome.trace) or None,
    }


def shortened(curves: Any) -> dict[str, list[float]]:
    return {name: [float(f"{x:.6g}") for x in curve] for name, curve in curves.items()}


def measure(name: str, before: Record | None) -> Record:
    """Run a case in all programs, beside what is recorded; name absent programs on stderr."""
    facts = {key: CASES[name].get(key, default) for key, default in FACTS.items()}
    numbers = scene(name).numbers
    facts |= {key: facts[key].format(**numbers) for key in ("scene", "answer")}
    cases = {**(before.cases if before else {}), name: facts}
    facts["reference"] = shortened(scene(name).reference())
    rows = [row for row in before.rows() if row["case"] != name] if before else []
    for contender in CASES[name]["contenders"]:
        try:
            rows.append(row_of(name, *contender))
        except Absent as absence:
            print(f"{name}: {contender[0]}: {absence}", file=sys.stderr)
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    measured = {"date": today, "machine": {**machine(), **versions()}}
    return Record.of(measured, {}, {each: cases[each] for each in CASES if each in cases}, rows)


def versions() -> dict[str, str]:
    """Name the versions that took part; the version of Boost comes from its headers."""
    from hard_cases.programs import odeint

    found = {}
    for name, distribution in (("SciPy", "scipy"), ("MuJoCo", "mujoco-core")):
        try:
            found[name] = metadata.version(distribution)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    try:
        found["Boost"] = odeint().VERSION.replace("_", ".")
    except ImportError:
        found["Boost"] = "not built"
    return {**found, "pendcore": metadata.version("pendcore")}
