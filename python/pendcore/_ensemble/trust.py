"""Which members are resolved: a second, independent ensemble agrees with what they found.

`Ensemble.second` says how that is made. Where a motion amplifies a last bit to something that can
be seen, the two disagree. Where events are looked for, Taylor series are kept, as another method
would take several times as long.
"""

from __future__ import annotations

import reprlib
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore._accuracy.estimate import TIGHTER
from pendcore._accuracy.method_choice import second_methods
from pendcore._accuracy.rounding import LAST_BITS, moved
from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.members import Members
from pendcore._ensemble.request import Request
from pendcore._messages.arguments import Floats, in_unit, number
from pendcore._messages.progress import Progress
from pendcore._run.call import Choice, Start, run, tightened
from pendcore.methods import TIGHTEST
from pendcore.reducers import Reducer
from pendcore.sampling import uniform


def second(found: Ensemble) -> tuple[Members, Request]:
    """Return members and request of the second ensemble."""
    members, request = found.members, found.request
    some = np.argwhere(np.isfinite(found.t_reached))[:1]  # one that was run: its start is allowed
    if not len(some):
        return members, request  # there is nothing to confirm
    scene, place = members.scene, tuple(some[0].tolist())
    start = Start(members.scene_of(place), members.q0[place], members.qd0[place], *request.t_span)
    choice = Choice(request.options["method"], request.options["rtol"], request.options["atol"])
    method = run(start._replace(t_end=start.t_start), choice, store="end").method
    choice = tightened(choice, TIGHTER[0], TIGHTEST)
    is_tighter = bool(np.max(choice.rtol) <= 0.1 * np.min(request.options["rtol"]))
    is_series = method.partition("-")[0] == "taylor"
    keeps_method = is_tighter and is_series and bool(request.events)
    options = {
        "method": method if keeps_method else next(second_methods(start, method, stiff=False)),
        "rtol": choice.rtol,
        "atol": choice.atol,
        "max_steps": 10 * request.options["max_steps"],
    }
    bounded = any(effect.description.bounds_joint for effect in scene.effects)
    near = replace(
        members,
        scene=moved(start._replace(scene=scene), 0).scene,
        q0=members.q0 if bounded else _moved(members.q0, 1, np.maximum(1.0, np.abs(members.q0))),
        vary={
            name: _moved(values, 2 + k, np.abs(values))
            for k, (name, values) in enumerate(members.vary.items())
        },
    )
    return near, request.with_options(**options)


def _moved(values: Floats, seed: int, scale: Floats) -> Floats:
    """Return values moved by a few last bits of a scale."""
    shares = uniform(-1.0, 1.0, values.shape, seed=seed)
    return values + LAST_BITS * scale * shares


def resolved(
    found: Ensemble,
    other: Ensemble | None,
    name: str | None,
    within: float | None,
    progress: Progress,
) -> npt.NDArray[np.bool_]:
    """Return which members agree; see `Ensemble.resolved`."""
    reducers = found.request.reducers
    if name is None:
        name = next(iter(reducers), "q")
    if name not in reducers and name not in ("q", "qd"):
        known = ", ".join(map(repr, (*reducers, "q", "qd")))
        raise ValueError(f"name = {name!r}: must be one of {known}")
    if name in reducers and reducers[name].is_told_by_states:
        name = "q"
    kind = reducers.get(name, Reducer)
    if within is not None and not number("within", within, "") >= 0:
        unit = getattr(kind, "unit", "rad" if name == "q" else "rad/s")
        raise ValueError(f"within = {within}: must be >= 0{in_unit(unit)}")
    if other is None:
        other = found.second(on_failure="ignore", progress=progress)
    _require_same_request(found, other)
    one, two = (np.asarray(x.arrays[name][...]) for x in (found, other))
    limit = kind.largest_difference(one, two) if within is None else within
    with np.errstate(invalid="ignore"):
        agree = (np.abs(one - two) <= limit) | (np.isnan(one) & np.isnan(two))
    axes = tuple(range(len(found.shape), one.ndim))
    return np.asarray(agree.all(axis=axes) & found.success & other.success)


def _require_same_request(found: Ensemble, other: Ensemble) -> None:
    """Raise an error for a second ensemble that cannot confirm the first."""
    remedy = "found.second() makes such a one"
    if not isinstance(other, Ensemble):
        raise TypeError(f"other: is of type {type(other).__name__}: must be an ensemble: {remedy}")

    def asked(one: Ensemble) -> dict[str, Any]:
        times = one.request.t_eval
        return {
            "shape": one.shape,
            "number of links": len(one.members.scene.links),
            "t_span": one.request.t_span,
            "t_eval": None if times is None else times.tolist(),
            "reducers": one.request.reducers,
        }

    wanted = asked(found)
    for what, value in asked(other).items():
        if value != wanted[what]:
            given, must = (reprlib.repr(x) for x in (value, wanted[what]))
            raise ValueError(f"other: {what} = {given}: must be {must}: {remedy}")
