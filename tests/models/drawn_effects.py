"""Effects and scenes of any values that are allowed, for hypothesis; from the descriptions alone.

An effect that is added to the core is drawn here as soon as it is there.
"""

from __future__ import annotations

import warnings
from typing import Any

import pendcore as pc
from hypothesis import reject
from hypothesis import strategies as st
from pendcore._scene.effect_class import OwnEffect
from pendcore._scene.effect_description import Description, Parameter

KINDS = {kind: cls for kind, cls in pc.effects.kinds().items() if not issubclass(cls, OwnEffect)}
"""The kinds that can be written down."""

finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=0, allow_infinity=False, exclude_min=True)
RANGES: dict[str, st.SearchStrategy[float]] = {
    "finite": finite,
    "finite and >= 0": st.floats(min_value=0, allow_infinity=False),
    "finite and > 0": positive,
    "finite and >= 1": st.floats(min_value=1, allow_infinity=False),
    "> 0, inf for no limit": positive | st.just(float("inf")),
    "0 to 1": st.floats(0, 1),
    "a number; -inf or inf for none": st.floats(allow_nan=False),
}


def value(parameter: Parameter, n: int, points: int) -> st.SearchStrategy[Any]:
    """Draw a parameter of an effect in a chain of n links, or of a part with points."""
    if parameter.part:
        return st.integers(2, 5).flatmap(
            lambda k: made(getattr(pc.effects, str(parameter.part)), n, k)
        )
    if parameter.type == "bool":
        return st.booleans()
    if parameter.type == "int":
        return st.integers(1, n)
    numbers = RANGES[parameter.range]
    if parameter.type == "pair":
        return st.tuples(numbers, numbers)
    if parameter.type == "floats":
        increasing = parameter.name == "t"
        return st.lists(numbers, min_size=points, max_size=points, unique=increasing).map(
            lambda found: sorted(found) if increasing else found
        )
    return numbers


@st.composite
def made(draw: st.DrawFn, cls: type[Any], n: int, points: int = 2) -> Any:
    """Draw an object of a class; optional parameters are left out half of the time."""
    told: Description = cls.description
    values = {
        p.name: draw(value(p, n, points))
        for p in told.parameters
        if p.required or draw(st.booleans())
    }
    try:
        return cls(**values)
    except ValueError:  # values that are allowed, and not together
        reject()


def an_effect(n: int) -> st.SearchStrategy[Any]:
    """Any effect of a chain of n links."""
    return st.sampled_from(sorted(KINDS)).flatmap(lambda kind: made(KINDS[kind], n))


@st.composite
def effects(draw: st.DrawFn, n: int) -> list[Any]:
    """Any effects of a chain of n links."""
    found = draw(st.lists(an_effect(n), max_size=4))
    locked = [effect.joint for effect in found if effect.kind == "lock"]
    return [e for e in found if e.kind != "lock" or locked.count(e.joint) == 1]


@st.composite
def scenes(draw: st.DrawFn) -> pc.Scene:
    """A chain of one to four rods, and what acts on it; however implausible."""
    n = draw(st.integers(1, 4))
    mass_and_length = st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
    rods = draw(st.lists(mass_and_length, min_size=n, max_size=n))
    drawn = draw(effects(n))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        try:
            return pc.Scene(
                links=[pc.Link(mass=m, length=length) for m, length in rods],
                gravity=draw(st.floats(-1e3, 1e3)),
                effects=drawn,
            )
        except ValueError:  # such as a payload whose inertia overflows
            reject()
