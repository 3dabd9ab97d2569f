"""Effects and scenes of any values that are allowed, for hypothesis; from the descriptions alone.

An effect that is added to the core is drawn here as soon as it is there.
"""

from __future__ import annotations

import warnings
from typing import Any

import pendcore as pc
from fuzz.choices import FromHypothesis
from fuzz.drawn_scene import KINDS_OF_NUMBERS, SceneMaker
from hypothesis import reject
from hypothesis import strategies as st

KINDS = {kind: pc.effects.kinds()[kind] for kind in KINDS_OF_NUMBERS}
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


class AnyNumbers(SceneMaker):
    """Draws any number that a description allows, however large or small."""

    def __init__(self, draw: st.DrawFn, n: int) -> None:
        super().__init__(FromHypothesis(draw), "any", n, 0.0, 1.0)
        self.draw = draw

    def number(self, p: Any) -> float:
        return self.draw(RANGES[p.range])

    def bound(self, open_end: float) -> float:
        return self.draw(RANGES["a number; -inf or inf for none"])

    def times(self, points: int) -> list[float]:
        knots = st.lists(finite, min_size=points, max_size=points, unique=True)
        return sorted(self.draw(knots))


@st.composite
def made(draw: st.DrawFn, cls: type[Any], n: int) -> Any:
    """Draw an effect of a class in a chain of n links; parameters may be left out if they can."""
    try:
        return AnyNumbers(draw, n).of(cls)
    except ValueError:  # values that are allowed, and not together
        reject()


@st.composite
def scenes(draw: st.DrawFn) -> pc.Scene:
    """A chain of one to four links, and what acts on it; however implausible."""
    n = draw(st.integers(1, 4))
    size = st.floats(1e-3, 1e3)
    link = st.builds(
        pc.Link, mass=size, length=size, center=st.none() | size, inertia=st.none() | size
    )
    an_effect = st.sampled_from(KINDS_OF_NUMBERS).flatmap(lambda kind: made(KINDS[kind], n))
    drawn = draw(st.lists(an_effect, max_size=4))
    locked = [effect.joint for effect in drawn if effect.kind == "lock"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        try:
            return pc.Scene(
                links=draw(st.lists(link, min_size=n, max_size=n)),
                gravity=draw(st.floats(-1e3, 1e3)),
                effects=[e for e in drawn if e.kind != "lock" or locked.count(e.joint) == 1],
            )
        except ValueError:  # such as a payload whose inertia overflows
            reject()
