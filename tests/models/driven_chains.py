"""Hanging rods under a motor, with friction and stops: as scenes, and mode by mode.

The assertions of what a run must share with the solution in hybrid_chain.py are here, for all tests
of it.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pendcore as pc
from dense_chain import Array, DenseChain, joints
from hybrid_chain import HybridChain
from pendcore import effects as fx
from unit_rods import links

FREE = (-np.inf, np.inf)


class Motor(NamedTuple):
    """amplitude sin(angular_frequency t) in a joint."""

    joint: int
    amplitude: float
    angular_frequency: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenChain:
    """As many rods of 1 kg and 1 m as `friction` has entries; every joint has `stops`, or none.

    They are at rest at first. `h` is the step of the solution mode by mode.
    """

    friction: tuple[float, ...]
    motor: Motor
    t_end: float
    stops: tuple[tuple[float, float], ...] = ()
    h: float = 0.04

    @property
    def n(self) -> int:
        return len(self.friction)

    @property
    def ranges(self) -> Array:
        """The least and the largest angle of each joint, (n, 2)."""
        return np.array(self.stops or (FREE,) * self.n)

    @property
    def chain(self) -> DenseChain:
        return DenseChain(masses=np.ones(self.n), lengths=np.ones(self.n), gravity=9.807)

    def simulate(self, **options: Any) -> pc.Solution:
        joint, amplitude, w = self.motor
        hum = fx.Sinusoid(amplitude=amplitude, angular_frequency=w)
        effects: list[Any] = [fx.Motor(joint=joint, sinusoid=hum)]
        for j in range(self.n):
            if self.friction[j]:
                effects.append(fx.DryJointFriction(joint=j + 1, coulomb=self.friction[j]))
            if self.stops and self.stops[j] != FREE:
                effects.append(fx.JointStop(joint=j + 1, range=self.stops[j]))
        chain = self.chain
        scene = pc.Scene(links=links(chain), gravity=chain.gravity, effects=effects)
        return pc.simulate(scene, q0=np.pi / 2, t_span=(0, self.t_end), **options)


class ModeByMode(NamedTuple):
    """The solution, and its states at some times."""

    exact: HybridChain
    times: Array
    states: Array


@functools.cache
def mode_by_mode(run: DrivenChain) -> ModeByMode:
    joint, amplitude, w = run.motor
    motor = np.eye(run.n)[joint - 1] * amplitude
    exact = HybridChain(
        chain=run.chain,
        friction=np.array(run.friction, float),
        torques=lambda t: motor * np.sin(w * t),
        stops=run.ranges if run.stops else None,
    )
    times = np.linspace(0, run.t_end, 12)[1:]
    return ModeByMode(exact, times, exact.run(np.full(run.n, np.pi / 2), times, h=run.h))


def assert_follows_mode_by_mode(sol: pc.Solution, run: DrivenChain) -> None:
    """The states, every switch, and between switches what is held and which way the rest slides."""
    exact, times, states = mode_by_mode(run)
    assert sol.status == "finished"
    np.testing.assert_allclose(sol(times).T, states, rtol=0, atol=1e-9)
    for time, _, _ in exact.switches:
        assert np.abs(sol.t - time).min() < 1e-9
    slides = np.array(run.friction) > 0  # a joint without friction turns back in the same mode
    for (begin, _, mode), (end, _, _) in itertools.pairwise(exact.switches):
        phid = joints(run.n) @ sol((begin + end) / 2)[run.n :]
        np.testing.assert_array_equal(phid == 0, np.array(mode) == 0)  # not small: nothing
        np.testing.assert_array_equal(np.sign(phid)[slides], np.array(mode)[slides])
