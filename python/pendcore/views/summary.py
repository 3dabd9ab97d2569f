"""The facts of a run: what was simulated, how it ended, what it took, how well energy was kept."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from math import degrees, isfinite
from textwrap import wrap
from typing import Any

import numpy as np

from pendcore import _core
from pendcore.solution import Solution
from pendcore.views import energy_drift
from pendcore.views.table import listed, outcome

NOT_SIMULATED = (
    "friction and damping in the joints, drag of the air, motors, springs, stops, a moving pivot, "
    "bending of the links, play in the joints, motion out of the plane"
)


def facts(solution: Solution) -> dict[str, Any]:
    """Return the facts as JSON can hold them: SI units, rad; None where there is no number."""
    case, run = solution.case(), solution._run
    n = len(case.scene.links)
    found = {
        "name": case.name,
        "links": [asdict(link) for link in case.scene.links],
        "gravity": case.scene.gravity,
        "mobility": case.scene.mobility()._asdict(),
        "start": {"t": case.t_span[0], "q": case.q0, "qd": case.qd0},
        "run": {"t_end": case.t_span[1]} | _run_options(solution),
        "status": solution.status,
        "message": solution.message,
        "success": solution.success,
        "end": {"t": run.t_reached, "q": run.y_reached[:n], "qd": run.y_reached[n:]},
        "statistics": solution.stats._asdict(),
        "energy": energy_drift.energy_drift(solution)._asdict(),
        "kept": {"times": len(solution.t), "every_step": energy_drift.has_every_step(solution)},
        "largest_reactions": _largest_reactions(solution),
        "not_simulated": NOT_SIMULATED,
        "version": _core.__version__,
    }
    return _json(found)  # type: ignore[no-any-return]


def text(found: dict[str, Any]) -> str:
    """Return the facts for people."""
    blocks = [
        [found["name"] or "chain of links"],
        ["What was simulated", *_link_table(found), *_rows(_asked(found))],
        ["What came of it", *_rows(_happened(found))],
    ]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _run_options(solution: Solution) -> dict[str, Any]:
    asked = solution._run.arguments
    always = {key: asked[key] for key in ("method", "rtol", "atol")}
    options = always | dict(solution.case().options)
    if "step" in options:  # a fixed step takes the place of the tolerances
        del options["rtol"], options["atol"]
    return options


def _largest_reactions(solution: Solution) -> list[dict[str, Any]]:
    if not len(solution.t):
        return []
    forces = np.linalg.norm(solution.reactions(), axis=-1)
    when = forces.argmax(axis=0)
    return [{"joint": i + 1, "force": forces[k, i], "t": solution.t[k]} for i, k in enumerate(when)]


def _link_table(found: dict[str, Any]) -> Iterator[str]:
    yield "  link    mass (kg)   length (m)   center (m)   inertia (kg m^2)"
    for i, link in enumerate(found["links"], start=1):
        mass, length, center, inertia = link.values()
        yield f"  {i:4} {mass:12.6g} {length:12.6g} {center:12.6g} {inertia:18.6g}"


def _asked(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    start, run = found["start"], dict(found["run"])
    n, c5, c4, freedom = found["mobility"].values()
    yield "gravity", f"{found['gravity']:.6g} m/s^2, downward"
    yield "mobility", f"M = 3 n - 2 c5 - c4 = 3*{n} - 2*{c5} - {c4} = {freedom}"
    yield "start", f"t = {start['t']:.6g} s, {_state(start, in_degrees=True)}"
    yield "end", f"t = {run.pop('t_end'):.6g} s"
    yield (
        "method",
        ", ".join([run.pop("method"), *(f"{key} {_brief(x)}" for key, x in run.items())]),
    )
    yield "not simulated", found["not_simulated"]


def _happened(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    stats, end, energy = found["statistics"], found["end"], found["energy"]
    yield "status", outcome(found["status"], found["message"])
    yield "end", f"t = {end['t']:.6g} s, {_state(end)}"
    yield "steps", f"{stats['accepted']} accepted, {stats['rejected']} rejected"
    yield "", f"{stats['min_step']:.3g} ... {stats['max_step']:.3g} s long"
    yield "work", f"{stats['nfev']} right-hand sides"
    yield "energy drift", energy_drift.text(energy["largest_drift"], energy["relative_drift"])
    if energy["too_large"]:
        yield "", energy_drift.TOO_LARGE
    for largest in found["largest_reactions"]:
        force = f"{_number(largest['force'])} N at t = {largest['t']:.6g} s"
        name = "largest reaction" if largest["joint"] == 1 else ""
        yield name, f"joint {largest['joint']}: {force}"
    if not found["kept"]["every_step"]:
        times = found["kept"]["times"]
        name = "" if times else "largest reaction"
        yield name, f"among the {times} kept time{'s'[: times != 1]}"


def _state(at: dict[str, Any], in_degrees: bool = False) -> str:
    q = f"q = ({listed(at['q'])}) rad"
    if in_degrees:
        q += f" = ({listed([degrees(x) for x in at['q']])}) deg"
    return f"{q}, qd = ({listed(at['qd'])}) rad/s"


def _number(value: float | None) -> str:
    return "not a number of" if value is None else f"{value:.6g}"


def _brief(value: Any) -> str:
    return f"({listed(value)})" if isinstance(value, list) else str(value)


def _rows(pairs: Iterator[tuple[str, str]]) -> Iterator[str]:
    for name, value in pairs:
        first, *more = wrap(value, 76)
        yield f"  {name:16}  {first}"
        yield from (f"{'':20}{line}" for line in more)


def _json(value: Any) -> Any:
    """JSON knows no tuples, no NumPy, and neither infinities nor NaN."""
    if isinstance(value, dict):
        return {key: _json(x) for key, x in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _json(value.tolist())
    if isinstance(value, list | tuple):
        return [_json(x) for x in value]
    return None if isinstance(value, float) and not isfinite(value) else value
