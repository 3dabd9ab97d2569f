"""Which members are resolved: a second, independent ensemble agrees with what they found.

`Ensemble.second` says how that is made. Where a motion amplifies a last bit to something that can
be seen, the two disagree. Where events are looked for, Taylor series are kept, as another method
would take several times as long.
"""

from __future__ import annotations

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
from pendcore._messages.arguments import Floats
from pendcore._run.call import Choice, Start, run, tightened
from pendcore.methods import TIGHTEST
from pendcore.reducers import EnergyDrift, FirstEvent, LargestExponent
from pendcore.sampling import uniform

ANGLE = 0.1
"""rad and rad/s: states that are farther apart are not the same."""
TIME = 0.01
"""The share of its time by which an event may differ."""
EXPONENT = 0.1
"""The share of the largest exponent by which exponents may differ."""


def second(members: Members, request: Request) -> tuple[Members, Request]:
    """Return members and request of the second ensemble."""
    scene, (t_start, t_end) = members.scene, request.t_span
    start = Start(scene, 0.0, 0.0, t_start, t_end)
    choice = Choice(request.options["method"], request.options["rtol"], request.options["atol"])
    method = run(start._replace(t_end=t_start), choice, store="end").method
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
        scene=moved(start, 0).scene,
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
    found: Ensemble, other: Ensemble, name: str | None, within: float | None
) -> npt.NDArray[np.bool_]:
    """Return which members agree; see `Ensemble.resolved`."""
    reducers = found.request.reducers
    if name is None:
        name = next(iter(reducers), "q")
    if name not in reducers and name not in ("q", "qd"):
        known = ", ".join(map(repr, (*reducers, "q", "qd")))
        raise ValueError(f"name = {name!r}: must be one of {known}")
    kind = type(reducers[name]) if name in reducers else None
    if kind is EnergyDrift:  # that of another run is another one: the states tell
        name, kind = "q", None
    one, two = (np.asarray(x.arrays[name][...]) for x in (found, other))
    limit: Any = within
    if within is None and kind is FirstEvent:
        limit = TIME * np.maximum(np.abs(one), np.abs(two))
    elif within is None and kind is LargestExponent:
        limit = EXPONENT * np.nanmax(np.abs(one), initial=0.0)
    elif within is None:
        limit = ANGLE
    with np.errstate(invalid="ignore"):
        agree = (np.abs(one - two) <= limit) | (np.isnan(one) & np.isnan(two))
    axes = tuple(range(len(found.shape), one.ndim))
    told: npt.NDArray[np.bool_] = agree.all(axis=axes) & found.success & other.success
    return told
