"""The facts of a run: what was simulated, how it ended, what it took, how well energy was kept."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from math import degrees
from textwrap import wrap
from typing import Any

from pendcore import Accuracy, Case, Solution, build
from pendcore.effects import Effect, Part
from pendcore.messages import as_json, listed
from pendcore.methods import evaluations

_MANY = 12
"""The number of links up to which a table for people has a row for each."""


def facts(solution: Solution, refusal: str = "") -> dict[str, Any]:
    """Return the facts as JSON can hold them: SI units, rad; None where there is no number.

    ``refusal`` is what an `AccuracyError` said, if the run comes from one.
    """
    case, end = solution.case(), solution.y_reached
    n = len(case.scene.links)
    drift = solution.energy_drift()
    ledger = solution.energy().ledger if len(solution.t) else None
    found = {
        "name": case.name,
        "links": [asdict(link) for link in case.scene.links],
        "gravity": case.scene.gravity,
        "effects": [_effect(effect) for effect in case.scene.effects],
        "mobility": case.scene.mobility()._asdict(),
        "start": {"t": case.t_span[0], "q": case.q0, "qd": case.qd0},
        "run": {"t_end": case.t_span[1]} | _run_options(case, solution),
        "events": [
            {"kind": x.kind, "text": repr(x), "times": [one.t for one in of_x]}
            for x, of_x in zip(solution.events_asked_for(), solution.events, strict=True)
        ],
        "status": solution.status,
        "message": solution.message,
        "last_method": solution.last_method,
        "success": solution.success,
        "refusal": refusal or None,
        "end": {"t": solution.t_reached, "q": end[:n], "qd": end[n:]},
        "statistics": solution.stats._asdict(),
        "accuracy": None if solution.accuracy is None else solution.accuracy.to_dict(),
        "energy": drift._asdict() | {"sentence": str(drift)},
        "ledger": ledger and {name: entry[-1] for name, entry in ledger.items()},
        "kept": {
            "times": len(solution.t),
            "every_step": solution.keeps_every_step,
            "between_steps": solution.store == "dense",
        },
        "largest_reactions": [one._asdict() for one in solution.largest_reactions()],
        "trusted_digits": solution.trusted_digits(),
        "not_simulated": [absence._asdict() for absence in case.scene.not_simulated()],
        "version": build.version,
    }
    return dict(as_json(found))


def text(found: dict[str, Any]) -> str:
    """Return the facts for people."""
    blocks = [
        [found["name"] or "chain of links"],
        ["What was simulated", *_link_table(found), *_rows(_asked(found))],
        ["What came of it", *_rows(_happened(found))],
    ]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _effect(effect: Effect) -> dict[str, Any]:
    """Return the kind and the parameters of an effect; a part is a dict of its parameters."""
    given = effect.particulars().items()
    values = {name: x.particulars() if isinstance(x, Part) else x for name, x in given}
    return {"kind": effect.kind, **values, "text": repr(effect)}


def _run_options(case: Case, solution: Solution) -> dict[str, Any]:
    always = {key: solution.options[key] for key in ("method", "rtol", "atol")}
    options = always | dict(case.options)
    options.pop("events", None)
    if "step" in options:  # a fixed step takes the place of the tolerances
        del options["rtol"], options["atol"]
    return options


def _link_table(found: dict[str, Any]) -> Iterator[str]:
    yield "  link    mass (kg)   length (m)   center (m)   inertia (kg m^2)"
    for i, link in enumerate(found["links"][:_MANY], start=1):
        mass, length, center, inertia = link.values()
        yield f"  {i:4} {mass:12.6g} {length:12.6g} {center:12.6g} {inertia:18.6g}"
    if len(found["links"]) > _MANY:
        yield f"   ... {len(found['links']) - _MANY} more"


def _asked(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    start, run = found["start"], dict(found["run"])
    n, c5, c4, freedom = found["mobility"].values()
    yield "gravity", f"{found['gravity']:.6g} m/s^2, downward"
    for i, effect in enumerate(found["effects"]):
        yield "" if i else "effects", effect["text"]
    yield "mobility", f"M = 3 n - 2 c5 - c4 = 3*{n} - 2*{c5} - {c4} = {freedom}"
    yield "start", f"t = {start['t']:.6g} s, {_state(start, in_degrees=True)}"
    yield "end", f"t = {run.pop('t_end'):.6g} s"
    names = run.pop("sensitivities", [])
    brief = {key: f"({listed(x)})" if isinstance(x, list) else x for key, x in run.items()}
    told = (f"{key} {x}" for key, x in brief.items() if key != "method")
    yield "method", ", ".join([run["method"], *told])
    if names:
        yield "derivatives", "by " + ", ".join(names)
    words = [absence["kind"].replace("_", " ") for absence in found["not_simulated"]]
    yield "not simulated", ", ".join(words)


def _happened(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    stats, end, energy = found["statistics"], found["end"], found["energy"]
    yield "status", f"{found['status']}: {found['message'].removeprefix(found['status'] + ': ')}"
    if found["refusal"] is not None:
        yield "refused", found["refusal"]
    yield "end", f"t = {end['t']:.6g} s, {_state(end)}"
    for i, event in enumerate(found["events"]):
        yield "" if i else "events", f"{event['text']}: {_times(event['times'])}"
    yield "steps", f"{stats['accepted']} accepted, {stats['rejected']} rejected"
    yield "", f"{stats['min_step']:.3g} ... {stats['max_step']:.3g} s long"
    method = found["run"]["method"]
    yield "work", evaluations(method, found["last_method"], stats["nfev"])
    if found["accuracy"] is not None:
        yield "accuracy", str(Accuracy.from_dict(found["accuracy"]))
    if found.get("horizon") is not None:
        yield "right to 0.1 rad", found["horizon"]
    for i, told in enumerate(energy["sentence"].split("; ")):
        yield "" if i else "energy drift", told
    for i, (name, value) in enumerate((found["ledger"] or {}).items()):
        yield "" if i else "ledger", f"{name} {value:.6g} J"
    yield from _largest_reactions(found)


def _largest_reactions(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    largest, kept = found["largest_reactions"], found["kept"]
    for one in largest[:_MANY]:
        force = "beyond the range of doubles"
        if one["force"] is not None:
            trusted = float(f"{one['force']:.{found['trusted_digits'] - 1}e}")
            force = f"{trusted:.6g} N"
        when = "just before t" if one["just_before"] else "at t"
        when = "throughout" if one["steady"] else f"{when} = {one['t']:.6g} s"
        name = "largest reaction" if one["joint"] == 1 else ""
        yield name, f"joint {one['joint']}: {force} {when}"
    if len(largest) > _MANY:
        yield "", f"... {len(largest) - _MANY} more joints"
    if not kept["between_steps"]:
        times = kept["times"]
        yield "" if times else "largest reaction", f"among the {times} kept time{'s'[: times != 1]}"


def _state(at: dict[str, Any], in_degrees: bool = False) -> str:
    q = f"q = ({listed(at['q'])}) rad"
    if in_degrees:
        q += f" = ({listed([degrees(x) for x in at['q']])}) deg"
    return f"{q}, qd = ({listed(at['qd'])}) rad/s"


def _times(times: list[float]) -> str:
    if not times:
        return "not found"
    shown = [f"{t:.6g}" for t in times[:_MANY]] + ["..."] * (len(times) > _MANY)
    return f"{len(times)} found, t = {', '.join(shown)} s"


def _rows(pairs: Iterator[tuple[str, str]]) -> Iterator[str]:
    for name, value in pairs:
        yield from wrap(value, 96, initial_indent=f"  {name:16}  ", subsequent_indent=20 * " ")
