"""A run as one file of HTML, with the core inside: it opens from disk and asks for nothing."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from pendcore import Case, Solution, build, effects, simulate
from pendcore.explanation.solution_text import LIMIT
from pendcore.messages import as_json, silence, text
from pendcore.methods import known_methods
from pendcore.options import OPTIONS
from pendcore.page.formulas import HTML, formula, formulas
from pendcore.plotting import css_variables
from pendcore.plotting.frames import moves_of

CORE_MODULES = ("engine.mjs", "pendcore.mjs")
"""They stand in cpp/wasm, and are installed beside the page."""
PAGE_MODULES = (
    "canvas.mjs", "angles.mjs", "simulate.mjs", "scene_view.mjs", "chart.mjs", "curves.mjs",
    "known_case.mjs", "case.mjs", "runs.mjs", "copy.mjs", "background.mjs", "controls.mjs",
    "touch.mjs", "main.mjs",
)  # fmt: skip
WORKER_MODULES = ("simulate.mjs", "worker.mjs")
CORE = "pendcore.wasm.gz"
LEFT_OUT = {"error", "events", "progress", "on_failure", "sensitivities"}
"""The options of a run that a page does without."""
WITHOUT_CORE = (
    "This page plays back what Python computed: the install that made it has no core for browsers "
    "(make page in a clone builds it; wheels have it)."
)
OWN_FUNCTIONS = "This page plays back what Python computed: functions of one's own stay in Python."
_PATIENCE = 10.0
"""s, for second runs of a page that cannot make them itself."""
_FRAME_RATE, _FRAME_TURN, _MOST_FRAMES = 60, 0.1, 3600
"""A page that plays back has so many frames a second, or one whenever a link has turned by so much,
rad: it draws straight lines from one to the next."""
_IMPORT_OR_EXPORT = re.compile(
    r"^import [^;]*?;\n|^export (?=(async )?(function|class|const))|^export [^;]*?;\n", re.MULTILINE
)


def page_of(solution: Solution, title: str | None = None) -> str:
    """Return the page; without a core for browsers in the install, it plays the run back.

    ``title`` is the headline; without one, the page has the name of the run.
    """
    case = solution.case()
    has_events = bool(solution.events_asked_for())
    told = why_it_plays_back(solution)
    core = None if told else core_for_browsers()
    known: dict[str, Any] = {**effects.kinds(), **effects.parts()}
    data = {
        "case": _plain_case(case, solution),
        "hash": "" if has_events else solution.fingerprint,
        "valid_until": _horizon(solution, may_take_long=core is None),
        "limit": LIMIT,
        "kinds": [_typeset(x) for x in known.values() if not x.description.is_function],
        "options": _options(),
        "defaults": _defaults(),
        "methods": ["auto", *(x for x, one in known_methods().items() if one["error_order"] > 0)],
        "recording": None if core is not None else _recording(solution),
    }
    parts = {
        "TITLE": escape(text("title", title or "") or solution.name or "A pendulum"),
        "ABOUT": f"Made by pendcore {build.version}.",
        "NOTICE": escape(told),
        "STYLE": css_variables() + _source("style.css"),
        "DATA": json.dumps(as_json(data, in_words=True), allow_nan=False).replace("<", "\\u003c"),
        "WASM": "" if core is None else b64encode(core).decode(),
        "CORE": "" if core is None else _bundle(CORE_MODULES),
        "WORKER": "" if core is None else _bundle(WORKER_MODULES),
        "SCRIPT": f"{{\n{_bundle(PAGE_MODULES)}\n}}",
    }
    return re.sub(r"@([A-Z]+)@", lambda found: parts[found[1]], _source("page.html"))


def why_it_plays_back(solution: Solution) -> str:
    """Return why the page of a run does not simulate; empty if it does."""
    if any(effect.description.is_function for effect in solution.scene.effects):
        return OWN_FUNCTIONS
    return WITHOUT_CORE if core_for_browsers() is None else ""


def _horizon(solution: Solution, *, may_take_long: bool) -> float | None:
    """Return until when the run is right, s; None leaves it to the page to find out."""
    estimate = solution.known_error
    if estimate is None and may_take_long:
        with suppress(ValueError):  # some runs have no second opinion
            estimate = solution.estimate_error(time_limit=_PATIENCE)
    return None if estimate is None else estimate.valid_until(LIMIT)


@cache
def core_for_browsers() -> bytes | None:
    """Return the packed module of the core, or None if this install has none."""
    packed = files("pendcore.page") / CORE
    return packed.read_bytes() if packed.is_file() else None


def _source(name: str) -> str:
    return (files("pendcore.page") / name).read_text(encoding="utf-8")


def _bundle(names: tuple[str, ...]) -> str:
    """Return modules one after the other, as one script: their names do not collide."""
    return "\n".join(_IMPORT_OR_EXPORT.sub("", _source(name)) for name in names)


def _plain_case(case: Case, solution: Solution) -> dict[str, Any]:
    """Return the case as plain data, named as in a case file, with every link in full."""
    # The page knows no events: its run ends where one ended this run, before some times to keep.
    ended = solution.status == "event"
    left_out = {*LEFT_OUT, "t_eval", "store"} if ended else LEFT_OUT
    options = {name: value for name, value in case.options.items() if name not in left_out}
    return {
        **({"name": solution.name} if solution.name else {}),
        "gravity": case.scene.gravity,
        "link": [asdict(one) for one in case.scene.links],
        "effect": [
            {"kind": one.kind, **_parameters(one)}
            for one in case.scene.effects
            if not one.description.is_function
        ],
        "start": {"q": case.q0, "qd": case.qd0},
        "run": {
            **options,
            "t_start": case.t_span[0],
            "t_end": solution.t_reached if ended else case.t_span[1],
            "method": _method(case, solution),
            "rtol": solution.options["rtol"],
        },
    }


def _method(case: Case, solution: Solution) -> str:
    """Return the method of a run, or "auto" where that takes the same: it goes on to do so."""
    asked, begin = solution.options, case.t_span[0]
    tolerances = {"rtol": asked["rtol"], "atol": asked["atol"]}
    usual = ""
    with silence(), suppress(ValueError):
        start = (case.scene, (begin, begin), case.q0, case.qd0)
        usual = simulate(*start, store="end", **tolerances).method
    is_adaptive = asked["step"] is None and not asked["compensated"]
    return "auto" if usual == solution.method and is_adaptive else solution.method


def _typeset(kind: Any) -> Any:
    """Return the description of an effect with its law and its symbols as formulas."""
    told = kind.description
    parameters = [one._replace(symbol=formula(one.symbol, HTML)) for one in told.parameters]
    return told._replace(law="<br>".join(formulas(told.law, HTML)), parameters=parameters)


def _options() -> list[dict[str, Any]]:
    """Return the options of a run that a page takes: their words, or their type."""
    stores = re.findall('"(.*?)"', OPTIONS["store"].type)
    words = {"method": ["auto", *known_methods()], "store": stores}
    types = {"npt.ArrayLike": "float or floats"} | {one: one for one in ("bool", "int", "float")}
    return [
        {"name": one.name, "words": words.get(one.name)}
        | {"type": "" if one.name in words else types[one.annotation.removesuffix(" | None")]}
        for one in OPTIONS.values()
        if one.name not in LEFT_OUT
    ]


@cache
def _defaults() -> dict[str, Any]:
    """Return parameters of each kind of effect to begin with: those of its first example."""
    return {
        kind: _parameters(eval(one.description.calls[0], dict(vars(effects))))
        for kind, one in effects.kinds().items()
        if not one.description.is_function
    }


def _parameters(value: Any) -> dict[str, Any]:
    """Return the parameters of an effect, or of a part, that are not what they are if left out."""
    given = value.particulars().items()
    return {name: _parameters(x) if isinstance(x, effects.Part) else x for name, x in given}


def _recording(solution: Solution) -> dict[str, Any]:
    """Return the run at equal steps of time, for a page that only plays back."""
    solution = solution.with_dense_output()
    begin, end = solution.t_span[0], solution.t_reached
    n = len(solution.scene.links)
    rates = solution(solution.step_starts)[n:]
    fastest = float(np.abs(rates[np.isfinite(rates)]).max(initial=0.0))
    frames = abs(end - begin) * max(_FRAME_RATE, fastest / _FRAME_TURN)
    t = np.linspace(begin, end, round(min(max(frames, 2), _MOST_FRAMES)))
    moves = moves_of(solution, t)
    energy, down = solution.energy(t), np.full(n, np.pi / 2)
    losses = energy.ledger.losses if energy.ledger else frozenset()
    entries = dict(energy.ledger or {})
    entries.pop("residual", None)
    q, qd = np.hsplit(moves.states, 2)
    columns = {
        "t": t, "q": q, "qd": qd, "booked": np.reshape([*entries.values()], (-1, len(t))).T,
        "places": moves.places, "forces": moves.reactions,
        "energies": np.stack([energy.kinetic, energy.potential], axis=1),
    }  # fmt: skip
    return {
        "moments": {name: _rounded(column) for name, column in columns.items()},
        "accounts": [f"-{name}" if name in losses else name for name in entries],
        "hanging": float(solution.scene.energy(begin, down, np.zeros(n))[1]),
        "message": solution.message,
        "success": solution.success,
    }


def _rounded(numbers: Any) -> Any:
    """Return numbers as a list with seven digits: nobody sees more, and the page stays small."""
    if np.ndim(numbers) > 1:
        return [_rounded(row) for row in numbers]
    return [float(f"{x:.7g}") for x in numbers]
