"""What an ensemble asked for, as texts and numbers that files can hold, and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pendcore import _core
from pendcore.cases.case import CaseData
from pendcore.cases.case_file import case_from_text
from pendcore.ensemble import keep
from pendcore.ensemble.keep import FirstEvent, Reducer
from pendcore.ensemble.request import Request
from pendcore.messages.arguments import Floats
from pendcore.messages.warning import silence
from pendcore.run.events import Function
from pendcore.scene.effect_class import OwnEffect
from pendcore.scene.scene import SceneData

VERSION, CASE, KEEP, VARY = "pendcore", "case", "keep", "vary"
"""The names of what is told."""
REDUCERS: dict[str, Callable[..., Reducer]] = {
    kind.__name__: kind
    for kind in (keep.FirstEvent, keep.Extremes, keep.EnergyDrift, keep.LargestExponent)
}


def about(scene: SceneData, vary: list[str], request: Request) -> dict[str, Any]:
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
    case = CaseData(
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


def read_about(told: Mapping[str, Any], t_eval: Floats | None) -> tuple[SceneData, Request]:
    """Return scene and request of what `about` told."""
    with silence():  # what is implausible was said when the scene was made
        case = case_from_text(told[CASE], "case")
    options = dict(case.options)
    events = tuple(options.get("events", ()))
    reducers: dict[str, Reducer] = {}
    for name, (kind, *number) in told[KEEP].items():
        if kind not in REDUCERS:
            raise ValueError(f"no reducer is called {kind!r}")
        reducers[name] = REDUCERS[kind](*(events[k] for k in number))
    own = sum(isinstance(one, FirstEvent) for one in reducers.values())
    options["events"] = events[: len(events) - own]
    return case.scene, Request(case.t_span, t_eval, reducers, options)
