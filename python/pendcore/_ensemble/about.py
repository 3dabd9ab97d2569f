"""What an ensemble asked for, as texts and numbers that files can hold, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pendcore import _core
from pendcore._cases.case import Case
from pendcore._cases.case_file import case_from_text
from pendcore._ensemble.request import Request
from pendcore._messages.arguments import Floats
from pendcore._messages.warning import silence
from pendcore._scene.effect_class import OwnEffect
from pendcore._scene.scene import Scene, check_parameter_names
from pendcore.events import Event, Function
from pendcore.reducers import REDUCERS, FirstEvent, Reducer

VERSION, CASE, KEEP, VARY = "pendcore", "case", "keep", "vary"
SHAPE, BLOCK = "shape", "block_shape"
"""The names of what is told."""
_OPTIONS = ("method", "rtol", "atol", "max_steps", "max_step")
"""Those that every request has."""
_KINDS: dict[str, Any] = {kind.__name__: kind for kind in REDUCERS}


def about(scene: Scene, vary: list[str], request: Request) -> dict[str, Any]:
    """Return version, scene, options, reducers and the names of varied parameters.

    Scene, options and events are a case, in TOML; its start stands for none of the members.
    """
    remedy = ": run the ensemble without a store, and keep its arrays"
    for effect in scene.effects:
        if isinstance(effect, OwnEffect):
            raise effect.cannot_be("saved", remedy)
    for event in request.events:
        if isinstance(event, Function):
            raise event.cannot_be("saved", remedy)
    case = Case(
        scene=scene,
        q0=0.0,
        t_span=request.t_span,
        name="ensemble",
        options=request.of_simulate(),
    )
    kept = {
        name: [type(one).__name__, *([request.event_number(name)] * isinstance(one, FirstEvent))]
        for name, one in request.reducers.items()
    }
    return {VERSION: _core.__version__, CASE: case.to_toml(), KEEP: kept, VARY: vary}


def read_about(told: Mapping[str, Any], t_eval: Floats | None) -> tuple[Scene, Request]:
    """Return scene and request of what `about` told; a ValueError names what it cannot have told.

    It may come from a file that anyone may have changed.
    """
    _require(told, VERSION, isinstance(told.get(VERSION), str), "a version")
    _require(told, CASE, isinstance(told.get(CASE), str), "a case in TOML")
    with silence():  # what is implausible was said when the scene was made
        case = case_from_text(told[CASE], CASE)
    options = dict(case.options)
    for name in _OPTIONS:
        if name not in options:
            raise ValueError(f"{CASE}: [run] has no {name}, which every ensemble has")
    if not set(options) <= {*_OPTIONS, "events"}:
        raise ValueError(f"{CASE}: [run] has more than {', '.join(_OPTIONS)}")
    events: tuple[Event, ...] = tuple(options.get("events", ()))
    reducers = _reducers(told, events)
    own = sum(isinstance(one, FirstEvent) for one in reducers.values())
    options["events"] = events[: len(events) - own]
    vary = told.get(VARY)
    is_list = isinstance(vary, list) and all(isinstance(one, str) for one in vary)
    _require(told, VARY, is_list and len({*told[VARY]}) == len(told[VARY]), "a list of parameters")
    try:
        check_parameter_names(case.scene._compiled, told[VARY])
    except ValueError as error:
        raise ValueError(f"{VARY}: {error}") from None
    if t_eval is not None and not (t_eval.ndim == 1 and np.isfinite(t_eval).all()):
        raise ValueError(f"time: shape {t_eval.shape}: must be finite times, (n_t,) (s)")
    return case.scene, Request(case.t_span, t_eval, reducers, options)


def read_sizes(told: Mapping[str, Any], name: str, least: int) -> tuple[int, ...]:
    """Return one of the shapes that are told."""
    sizes = told.get(name)
    is_list = isinstance(sizes, list) and all(type(one) is int and one >= least for one in sizes)
    _require(told, name, is_list, f"a list of whole numbers from {least}")
    return tuple(told[name])


def _reducers(told: Mapping[str, Any], events: tuple[Event, ...]) -> dict[str, Reducer]:
    """Return the reducers; the last events are those of the reducers that have one, in order."""
    keep = told.get(KEEP)
    _require(told, KEEP, isinstance(keep, dict), "a table of names and reducers")
    own = [x for x in told[KEEP].values() if isinstance(x, list) and x[:1] == [FirstEvent.__name__]]
    numbers = iter(range(len(events) - len(own), len(events)))
    reducers: dict[str, Reducer] = {}
    for name, one in told[KEEP].items():
        kind = one[0] if isinstance(one, list) and one and isinstance(one[0], str) else None
        number = [next(numbers)] if kind == FirstEvent.__name__ else []
        _require(told, KEEP, kind in _KINDS and one == [kind, *number], "reducers and events")
        _require(told, KEEP, not any(k < 0 for k in number), "reducers of events of the case")
        reducers[name] = _KINDS[str(kind)](*(events[k] for k in number))
    return reducers


def _require(told: Mapping[str, Any], name: str, is_right: bool, wanted: str) -> None:
    if not is_right:
        raise ValueError(f"{name} = {str(told.get(name))[:60]}: must be {wanted}")
