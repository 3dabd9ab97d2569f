"""Runs of ordinary scenes for hypothesis, short enough that rounding stays rounding.

Chaos multiplies a difference of rounding by e every Lyapunov time; over a second of chains of about
a metre that is a factor of a thousand or so. `fuzz.drawn_run` has the wild runs.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
import pendcore as pc
from fuzz.choices import Choices, FromHypothesis, FromSeed
from fuzz.drawn_run import Drawn
from fuzz.drawn_scene import SceneMaker
from hypothesis import reject
from hypothesis import strategies as st
from pendcore.effects import KINDS
from symmetries import with_effects

SMOOTH = ("viscous_joint", "rod_drag", "torsional_spring", "motor", "rotor_inertia", "payload",
          "lock", "driven_pivot")  # fmt: skip
UNDAMPED = ("torsional_spring", "motor", "rotor_inertia", "payload", "lock", "driven_pivot")
"""Smooth effects under which a difference does not grow backward, as it does under damping."""
LOSSLESS = ("torsional_spring", "rotor_inertia", "payload", "lock")
"""Effects that are the same in reversed time."""


INTERVALS = {
    "exponent": (1, 3),
    **dict.fromkeys(("angular_frequency", "stribeck_velocity"), (0.1, 3)),
    **dict.fromkeys(("mass", "armature", "limit", "static"), (0.5, 2)),
    **dict.fromkeys(("amplitude", "x", "y"), (-0.3, 0.3)),
    **dict.fromkeys(("torque", "constant"), (-2, 2)),
    **dict.fromkeys(("inertia", "kd"), (0, 0.1)),
}
"""The intervals of parameters that are no angles and not from 0 to 0.5."""


class Rounded:
    """Numbers of six decimals: none is so small that a product with others vanishes."""

    def __init__(self, choices: Choices) -> None:
        self._choices = choices
        self.integer = choices.integer
        self.one_of = choices.one_of

    def real(self, low: float, high: float) -> float:
        return round(self._choices.real(low, high), 6)


class Gentle(SceneMaker):
    """Draws links of about a kilogram and a metre, and effects about as strong as their weight."""

    def link(self) -> pc.Link:
        real = self.choices.real
        mass, length = real(0.5, 2), real(0.5, 2)
        center = length * real(0.25, 0.75)
        inertia = mass * center * (length - center) * real(0.25, 0.875)
        return pc.Link(mass=mass, length=length, center=center, inertia=inertia)

    def of(self, cls: Any) -> Any:
        """Return one with every parameter, or with one of those that exclude each other."""
        parameters = cls.description.parameters
        points = self.choices.integer(2, 6)
        either = [p for p in parameters if p.optional]
        one = self.choices.one_of(either) if either else None
        values = {p.name: self.value(p, points) for p in parameters if p is one or not p.optional}
        return cls(**values)

    def bound(self, open_end: float) -> float:
        return open_end if self.choices.integer(0, 3) == 3 else self.choices.real(-3, 3)

    def times(self, points: int) -> list[float]:
        """Return knots that enclose the run."""
        gaps = [self.choices.real(0.25, 1) for _ in range(points - 1)]
        scale = (self.last - self.first + 0.5) / sum(gaps)
        return [self.first - 0.25 + scale * sum(gaps[:k]) for k in range(points)]

    def number(self, p: Any) -> float:
        return self.choices.real(*((-2, 2) if p.unit == "rad" else INTERVALS.get(p.name, (0, 0.5))))


def motion(choices: Choices, kinds: Collection[str], links: int = 4) -> Drawn:
    """Return a run of an ordinary chain under effects of some kinds, one of each at most.

    Raises ValueError where its parts do not agree.
    """
    n = choices.integer(1, links)
    times = (0.0, choices.real(0.1, 1.0))
    maker = Gentle(choices, "ordinary", n, *times)
    known = [kind for kind in sorted(kinds) if kind in KINDS]
    chosen = [known.pop(choices.integer(0, len(known) - 1)) for _ in range(_count(choices, known))]
    effects = [effect for kind in sorted(chosen) if (effect := maker.effect(kind)) is not None]
    bare = pc.Scene(links=[maker.link() for _ in range(n)], gravity=choices.real(0, 10))
    scene = with_effects(bare, effects)
    q0 = [choices.real(-3, 3) for _ in range(n)]
    qd0 = [choices.real(-2, 2) for _ in range(n)]
    for effect in effects:
        joint = getattr(effect, "joint", 1)
        before = q0[joint - 2] if joint > 1 else 0.0
        if effect.kind == "lock":
            qd0[joint - 1] = qd0[joint - 2] if joint > 1 else 0.0
            q0[joint - 1] = before + (effect.angle or 0.0)
        elif hasattr(effect, "range"):
            low, high = (max(-4.0, min(4.0, bound)) for bound in effect.range)
            q0[joint - 1] = before + 0.5 * (low + high)
    angles = np.diff(q0, prepend=0.0)
    for effect in effects:  # a lock may have moved a joint that has a stop
        low, high = getattr(effect, "range", (-np.inf, np.inf))
        if not low <= angles[getattr(effect, "joint", 1) - 1] <= high:
            raise ValueError("the start is beyond a stop")
    return Drawn(scene, q0, qd0, times, {"rtol": 1e-10, "atol": 1e-12, "max_steps": 20_000})


def _count(choices: Choices, known: list[str]) -> int:
    return choices.integer(1, min(4, len(known))) if known else 0


def stopped_motion(
    choices: Choices, kinds: Collection[str] = SMOOTH, restitutions: tuple[float, ...] = (0.0, 0.5)
) -> Drawn:
    """Return one of these motions with stops about the start, most of which are soon reached."""
    run = motion(choices, sorted({*kinds} - {"lock"}))
    stops = []
    for joint, phi in enumerate(np.diff(run.q0, prepend=0.0), start=1):
        if joint == 1 or choices.integer(0, 1):
            ends = (phi - choices.real(0.05, 1), phi + choices.real(0.05, 1))
            e = choices.one_of(restitutions)
            stops.append(pc.effects.JointStop(joint=joint, range=ends, restitution=e))
    return replace(run, scene=with_effects(run.scene, [*run.scene.effects, *stops]))


@st.composite
def _drawn(draw: st.DrawFn, make: Callable[..., Drawn], *given: Any) -> Drawn:
    try:
        return make(Rounded(FromHypothesis(draw)), *given)
    except ValueError:
        reject()


def motions(kinds: Collection[str] = SMOOTH) -> st.SearchStrategy[Drawn]:
    """Return any of these motions."""
    return _drawn(motion, kinds)


def stopped_motions(
    kinds: Collection[str] = SMOOTH, restitutions: tuple[float, ...] = (0.0, 0.5)
) -> st.SearchStrategy[Drawn]:
    """Return any of these motions with stops."""
    return _drawn(stopped_motion, kinds, restitutions)


def _of_seed(seed: str, make: Callable[..., Drawn], *given: Any) -> Drawn:
    """Return the motion of a seed; the next seed's where its parts do not agree."""
    try:
        return make(Rounded(FromSeed(seed)), *given)
    except ValueError:
        return _of_seed(f"{seed}, once more", make, *given)


def motion_of_seed(seed: str, kind: str) -> Drawn:
    """Return a motion under an effect of a kind."""
    return _of_seed(seed, motion, [kind])


def stopped_motion_of_seed(seed: str) -> Drawn:
    """Return a motion with stops."""
    return _of_seed(seed, stopped_motion)


def at_fifths(run: Drawn, **changes: Any) -> np.ndarray:
    """Return the states at fifths of the span; the run must get there."""
    sol = run.simulate(**changes)
    assert sol.success, sol.message
    return sol(np.linspace(*run.t_span, 6))
