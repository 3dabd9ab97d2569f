"""What an ensemble asked for, as texts and numbers that files can hold, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pendcore import _core
from pendcore._cases.case import Case, refuse_functions
from pendcore._cases.case_file import case_from_text
from pendcore._ensemble.request import OPTIONS, Request
from pendcore._messages.arguments import Floats
from pendcore._messages.warning import silence
from pendcore._scene.scene import Scene, check_parameter_names
from pendcore.reducers import REDUCERS, FirstEvent, Reducer, Sensitivities

VERSION, CASE, KEEP, VARY = "pendcore", "case", "keep", "vary"
SHAPE, BLOCK = "shape", "block_shape"
"""The names of what is told."""
_KINDS: dict[str, Any] = {kind.__name__: kind for kind in REDUCERS}


def about(scene: Scene, vary: list[str], request: Request) -> dict[str, Any]:
    """Return version, scene, options, reducers and the names of varied parameters.

    Scene, options and events are a case, in TOML; its start stands for none of the members.
    """
    remedy = ": run the ensemble without a store, and keep its arrays"
    refuse_functions(scene, request.events, "saved", remedy)
    options = request.of_simulate()
    case = Case(scene=scene, q0=0.0, t_span=request.t_span, name="ensemble", options=options)
    return {VERSION: _core.__version__, CASE: case.to_toml(), KEEP: _kept(request), VARY: vary}


def _kept(request: Request) -> dict[str, list[Any]]:
    """Return the kind of each reducer, and the number of its event, or its names, if it has any."""

    def own(name: str, one: Reducer) -> list[Any]:
        if isinstance(one, FirstEvent):
            return [request.event_number(name)]
        return [[*one.names]] if isinstance(one, Sensitivities) else []

    return {name: [type(x).__name__, *own(name, x)] for name, x in request.reducers.items()}


def read_about(told: Mapping[str, Any], t_eval: Floats | None) -> tuple[Scene, Request]:
    """Return scene and request of what `about` told; a ValueError names what it cannot have told.

    It may come from a file that anyone may have changed.
    """
    require(told, VERSION, isinstance(told.get(VERSION), str), "a version")
    require(told, CASE, isinstance(told.get(CASE), str), "a case in TOML")
    with silence():  # what is implausible was said when the scene was made
        case = case_from_text(told[CASE], CASE)
    options = dict(case.options)
    events = options.pop("events", ())
    if options.keys() | {"events"} != OPTIONS:
        known = ", ".join(sorted(OPTIONS - {"events"}))
        raise ValueError(f"{CASE}: [run] must have {known}, and no others")
    try:
        kinds = {name: (_KINDS[one[0]], one[1:]) for name, one in told[KEEP].items()}
        first = len(events) - [kind for kind, _ in kinds.values()].count(FirstEvent)
        own = iter(events[max(first, 0) :])  # the last events are those of reducers, in their order
        made = {
            name: kind(next(own)) if kind is FirstEvent else kind(*given)
            for name, (kind, given) in kinds.items()
        }
    except (AttributeError, IndexError, KeyError, StopIteration, TypeError, ValueError):
        first, made = -1, {}
    request = Request(case.t_span, t_eval, made, options | {"events": events[: max(first, 0)]})
    require(told, KEEP, first >= 0 and _kept(request) == told[KEEP], "reducers and events")
    try:
        request.check_reducers(case.scene)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{KEEP}: {error}") from None
    require(told, VARY, isinstance(told.get(VARY), list), "a list of parameters")
    try:
        check_parameter_names(case.scene._compiled, told[VARY])
    except (TypeError, ValueError) as error:
        raise ValueError(f"{VARY}: {error}") from None
    require(told, VARY, len({*told[VARY]}) == len(told[VARY]), "a list of parameters")
    if t_eval is not None and not (t_eval.ndim == 1 and np.isfinite(t_eval).all()):
        raise ValueError(f"time: shape {t_eval.shape}: must be finite times, (n_t,) (s)")
    return case.scene, request


def read_sizes(told: Mapping[str, Any], name: str, least: int) -> tuple[int, ...]:
    """Return one of the shapes that are told."""
    sizes = told.get(name)
    is_list = isinstance(sizes, list) and all(type(one) is int and one >= least for one in sizes)
    require(told, name, is_list, f"a list of whole numbers from {least}")
    return tuple(told[name])


def require(told: Mapping[str, Any], name: str, is_right: bool, wanted: str) -> None:
    """Raise a ValueError for what a file tells, unless it is right."""
    if not is_right:
        raise ValueError(f"{name} = {str(told.get(name))[:60]}: must be {wanted}")
