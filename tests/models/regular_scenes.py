"""Random scenes whose motion is regular: neighbours part by less than a hundredfold over the span.

The motion of each scene is known from two methods as accurate as doubles allow, whose distance is
known too. So is what every method takes and reaches at every half decade of tolerance. An error to
ask for is drawn with the scene, between 1e-2 and 1e-10.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pendcore as pc
from pendcore._accuracy.position_error import time_grid
from pendcore._run.work import series_work

REGULAR = 100.0
NUDGE = 1e-9
TOLERANCES = 10.0 ** -np.arange(1, 14.01, 0.5)
METHODS = ("dopri5", "dop853", "taylor")
EXACT = {"rtol": 1e-14, "atol": 1e-17, "compensated": True}


@dataclass(frozen=True)
class Regular:
    """A scene, its start, its span, an error to ask for, and what is known of it all."""

    arguments: tuple[Any, ...]
    error: float
    known: dict[str, np.ndarray]
    sweep: list[tuple[str, float, float, float]]
    """Method, rtol, error, work in right-hand sides."""

    @property
    def times(self) -> np.ndarray:
        return time_grid(*self.arguments[1])

    def run(self, **options: Any) -> pc.Solution:
        return pc.simulate(*self.arguments, t_eval=self.times, **options)

    def error_of(self, solution: pc.Solution) -> float:
        """Measure against a method that is not the solution's."""
        other = "dop853" if solution.method.startswith("taylor") else "taylor"
        return self.distance(solution, other)

    def distance(self, solution: pc.Solution, method: str) -> float:
        return float(solution.scene.distances(solution.q, self.known[method]).max())

    def cheapest(self) -> tuple[str, float, float, float]:
        """Return the least work that keeps the error, of all that was swept."""
        return min((s for s in self.sweep if s[2] <= self.error), key=lambda s: s[3])


def regular(seed: int) -> Regular:
    """Draw until the motion is regular; measure what the tests need to know."""
    rng = np.random.default_rng(seed)
    while True:
        arguments = scene_and_start(rng)
        if growth(*arguments) < REGULAR:
            break
    draft = Regular(arguments, 1.0, {}, [])
    known = {method: draft.run(method=method, **EXACT).q for method in METHODS[1:]}
    limit = float(arguments[0].distances(known["dop853"], known["taylor"]).max())
    error = max(10 ** rng.uniform(-10, -2), 30 * limit)
    draft = Regular(arguments, error, known, [])
    for method in METHODS:
        for rtol in TOLERANCES:
            solution = draft.run(method=method, rtol=rtol, atol=rtol / 1000, on_failure="ignore")
            if solution.success:
                each = series_work(arguments[0], rtol) if method == "taylor" else 1.0
                work = each * solution.stats.nfev
                found = (method, float(rtol), draft.error_of(solution), work)
                draft.sweep.append(found)
    return draft


def growth(scene: pc.Scene, span: tuple[float, float], q0: np.ndarray, qd0: np.ndarray) -> float:
    """Return by how much neighbours part."""
    options = {"method": "dop853", "rtol": 1e-12, "atol": 1e-14, "t_eval": time_grid(*span)}
    one, other = (
        pc.simulate(scene, q0=q0 + d, qd0=qd0, t_span=span, **options).q for d in (0, NUDGE)
    )
    return float(scene.distances(one, other).max()) / NUDGE


def scene_and_start(rng: np.random.Generator) -> tuple[Any, ...]:
    """Draw one to four links with up to three smooth effects, a start, and one to thirty s."""
    n = int(rng.choice([1, 2, 2, 2, 3, 4]))
    links = [link(rng) for _ in range(n)]
    effects: dict[tuple[str, int], Any] = {}
    for _ in range(rng.choice([0, 0, 1, 1, 2, 3])):
        one = effect(rng, int(rng.integers(1, n + 1)))
        effects[one.kind, getattr(one, "joint", 0)] = one
    q0 = np.pi / 2 + rng.uniform(-1, 1, n) * rng.choice([0.5, 1.5, 3.1])
    qd0 = rng.uniform(-1, 1, n) * rng.choice([0, 1, 3])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        scene = pc.Scene(links=links, effects=effects.values())
    return scene, (0.0, float(np.exp(rng.uniform(0, np.log(30))))), q0, qd0


def link(rng: np.random.Generator) -> pc.Link:
    mass, length = np.exp(rng.uniform(np.log(0.2), np.log(3), 2)).tolist()
    shape = rng.integers(3)
    if shape == 0:
        return pc.Link(mass=mass, length=length)
    if shape == 1:
        return pc.Link.point_mass(mass=mass, length=length)
    inertia = mass * length**2 * rng.uniform(0.02, 0.2)
    return pc.Link(mass=mass, length=length, center=length * rng.uniform(0.2, 0.8), inertia=inertia)


def effect(rng: np.random.Generator, joint: int) -> Any:
    e = pc.effects
    hum = e.Sinusoid(rng.uniform(0, 5), angular_frequency=rng.uniform(1, 8))
    shake = e.Sinusoid(rng.uniform(0, 0.1), angular_frequency=rng.uniform(1, 8))
    kinds = [
        e.ViscousJoint(joint=joint, damping=rng.uniform(0, 0.5)),
        e.TorsionalSpring(joint=joint, stiffness=rng.uniform(0, 20), rest_angle=rng.uniform(-1, 1)),
        e.Motor(joint=joint, sinusoid=hum),
        e.RotorInertia(joint=joint, armature=rng.uniform(0, 0.2)),
        e.Payload(mass=rng.uniform(0, 1)),
        e.DrivenPivot(y=shake),
    ]
    return kinds[rng.integers(len(kinds))]
