"""Bounces of chains that accumulate, contact after infinitely many of them, and its end.

Against the solution bounce by bounce of bouncing_chain.py. A capture speed c leaves out the bounces
after the first impact slower than c, at w: time 2 e w/(a (1 - e)), where a presses the joint to its
stop. What they do to the chain and to its energy is done by the contact instead, but for a part of
second order in c: less than c^2/a in the states here, in SI units.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pendcore as pc
import pytest
from bouncing_chain import BouncingChain
from dense_chain import DenseChain, joints
from pendcore import effects as fx
from unit_rods import links


@dataclass(frozen=True, kw_only=True)
class Bounces:
    """Where a joint (from 1) has its stop, above (1) or below (-1); a motor in joint 1; the start.

    The motor's torque is amplitude cos(angular_frequency t).
    """

    masses: tuple[float, ...]
    lengths: tuple[float, ...]
    joint: int
    bound: float
    side: int
    restitution: float
    start: tuple[float, ...]
    t_end: float
    amplitude: float = 0.0
    angular_frequency: float = 0.0

    @property
    def chain(self):
        masses, lengths = np.array(self.masses), np.array(self.lengths)
        return DenseChain(masses=masses, lengths=lengths, gravity=9.807)

    def simulate(self, capture_speed, **options):
        ends = (self.bound, np.inf) if self.side < 0 else (-np.inf, self.bound)
        how = {"restitution": self.restitution, "capture_speed": capture_speed}
        hum = fx.Sinusoid(self.amplitude, self.angular_frequency, phase=np.pi / 2)
        effects = [fx.JointStop(joint=self.joint, range=ends, **how)]
        effects += [fx.Motor(joint=1, sinusoid=hum)] if self.amplitude else []
        scene = pc.Scene(links=links(self.chain), gravity=9.807, effects=effects)
        return pc.simulate(scene, (0, self.t_end), self.start, ledger=True, **options)


RUNS = {
    # The elbow gives way by 0.02 rad; past the bottom the lower rod swings ahead.
    "two rods dropped": Bounces(
        masses=(1.0, 1.0), lengths=(1.0, 1.0), joint=2, bound=-0.02, side=-1, restitution=0.5,
        start=(0.0, 0.0), t_end=0.8,
    ),
    "two rods driven to and off a stop of the first": Bounces(
        masses=(1.5, 0.4), lengths=(0.8, 0.5), joint=1, bound=np.pi / 2 - 0.3, side=1,
        restitution=0.7, start=(np.pi / 2 - 0.35, np.pi / 2 - 0.1), t_end=1.0,
        amplitude=6.0, angular_frequency=3.0,
    ),
    "three rods dropped": Bounces(
        masses=(1.0, 1.0, 1.0), lengths=(1.0, 1.0, 1.0), joint=2, bound=-0.05, side=-1,
        restitution=0.5, start=(0.0, 0.3, -0.3), t_end=0.8,
    ),
}  # fmt: skip


@functools.cache
def bounce_by_bounce(name):
    run = RUNS[name]
    motor = np.eye(len(run.masses))[0] * run.amplitude
    exact = BouncingChain(
        chain=run.chain, joint=run.joint - 1, bound=run.bound, side=run.side,
        restitution=run.restitution,
        torques=lambda t: motor * np.cos(run.angular_frequency * t),
    )  # fmt: skip
    times = np.linspace(0, run.t_end, 41)[1:]
    return exact, times, exact.run(np.array(run.start), times)


@pytest.mark.few_cases
@pytest.mark.parametrize("capture", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("name", RUNS)
def test_bounces_of_chains_are_all_there_down_to_the_capture_speed(name, capture, fine):
    """How many, when, how fast, and what each takes; the first that is slower is the last."""
    exact, _, _ = bounce_by_bounce(name)
    faster = [strike for strike in exact.strikes if strike.speed >= capture]
    captured = exact.strikes[len(faster)]
    sol = RUNS[name].simulate(capture, **fine)
    rows = np.flatnonzero(np.diff(sol.t) == 0)
    assert len(rows) == len(faster) + 1
    struck = [*faster, captured]
    np.testing.assert_allclose(sol.t[rows], [one.t for one in struck], rtol=0, atol=1e-10)
    closing = np.abs(joints(exact.chain.n)[exact.joint] @ sol.qd[rows].T)
    np.testing.assert_allclose(closing, [one.speed for one in struck], rtol=0, atol=1e-10)
    impact = sol.energy().ledger.impact
    losses = [one.loss for one in faster]
    np.testing.assert_allclose((impact[rows + 1] - impact[rows])[:-1], losses, rtol=0, atol=1e-10)
    end = sol.t[rows[-1]]
    assert exact.held_from - end == pytest.approx(captured.to_go, rel=capture, abs=1e-10)


@pytest.mark.parametrize("name", RUNS)
def test_bounces_of_chains_end_when_the_series_says(name, fine):
    """With the capture speed of the core: 1e-9 of sqrt(torque / inertia) of the joint."""
    exact, _, _ = bounce_by_bounce(name)
    chain, j, e = exact.chain, exact.joint, exact.restitution
    torque = chain.moments[j] * chain.gravity + (RUNS[name].amplitude if j == 0 else 0)
    natural = np.sqrt(torque / chain.couplings[j, j])
    left_out = 2e-9 * natural * e / (exact.strikes[-1].pressed * (1 - e))
    sol = RUNS[name].simulate(None, **fine)
    end = sol.t[np.flatnonzero(np.diff(sol.t) == 0)[-1]]
    assert exact.held_from - left_out - 1e-10 < end < exact.held_from - e * left_out + 1e-10


@pytest.mark.parametrize("capture", [1e-3, 1e-5, None])
@pytest.mark.parametrize("name", RUNS)
def test_chains_that_have_bounced_lean_and_are_let_go_as_bounce_by_bounce(name, capture, fine):
    exact, times, states = bounce_by_bounce(name)
    sol = RUNS[name].simulate(capture, **fine)
    assert sol.status == "finished"
    left_out = (capture or 0.0) ** 2 / exact.strikes[-1].pressed
    np.testing.assert_allclose(sol(times).T, states, rtol=0, atol=1e-9 + left_out)
    assert np.abs(sol.t - exact.held_to).min() < 1e-9 + left_out
    opening = joints(exact.chain.n)[exact.joint]
    leaning = (times > exact.held_from) & (times < exact.held_to)
    assert leaning.sum() >= 4
    assert not (opening @ sol(times[leaning])[exact.chain.n :]).any()  # not small: nothing
    ledger = sol.energy().ledger
    lost = sum(strike.loss for strike in exact.strikes)
    assert ledger.impact[-1] == pytest.approx(lost, abs=1e-10 + left_out)
    assert np.abs(ledger.residual).max() < 1e-10
