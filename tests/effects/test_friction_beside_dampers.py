"""Weak dry friction beside a damper of any strength: bounded work, and the motion that it leaves.

A strong damper leaves a joint the rate T/b that its torques T give. In the end this rate is less
than the errors of a step. The torques alone then tell which way the joint slides, and whether it
sticks.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from mpmath import findroot, mp, mpf  # type: ignore[import-untyped]
from pendcore import effects as fx
from unit_rods import rod

CASES = Path(__file__).parents[2] / "examples/measured"
RIG = pc.read_case(CASES / "double_validation_1.toml")
BEARINGS = {1: 2.8e-6, 2: 1.7e-4}  # N m
DAMPINGS = [10.0**k for k in range(14)]
METHODS = ["auto", "radau5", "dopri5-radau5", "dop853-radau5", "taylor-radau5"]
STRONG = [b for b in DAMPINGS if b >= 1e4]


def rig(*more: fx.Effect) -> pc.Scene:
    bearing = RIG.scene.effects[0]
    rub = [fx.DryJointFriction(joint, coulomb=torque) for joint, torque in BEARINGS.items()]
    return pc.Scene(
        links=RIG.scene.links, gravity=RIG.scene.gravity, effects=[bearing, *rub, *more]
    )


def run(scene: pc.Scene, qd0: object = RIG.qd0, **options: object) -> pc.Solution:
    times = np.linspace(0, RIG.t_span[1], 201)
    return pc.simulate(scene, q0=RIG.q0, qd0=qd0, t_span=RIG.t_span, t_eval=times, **options)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("damping", DAMPINGS)
def test_the_work_is_bounded_whatever_the_damping(damping: float, method: str) -> None:
    sol = run(rig(fx.ViscousJoint(2, damping)), method=method, max_steps=3000)
    assert sol.success, sol.message
    # Steps that are tried again at a guard count in nfev, but not as steps.
    assert sol.stats.nfev < 60_000


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("damping", STRONG)
def test_a_strong_damper_leaves_the_motion_of_a_locked_joint(damping: float, method: str) -> None:
    """The rates meet as in an inelastic impact, and the joint creeps at T/b from then on."""
    scene = rig(fx.ViscousJoint(2, damping))
    mass = scene.mass_matrix(RIG.q0)
    together = (mass @ RIG.qd0).sum() / mass.sum()
    locked = run(rig(fx.Lock(2)), qd0=[together, together], rtol=1e-12, atol=1e-14)
    sol = run(scene, method=method, rtol=1e-9, atol=1e-11, max_steps=9000)
    assert sol.success, sol.message
    off = np.abs(sol.q - locked.q)[1:].max()
    assert off <= 1e-8 + 1 / damping


@pytest.mark.parametrize("damping", [1.0, 1e2, 1e4])
def test_methods_agree_on_the_motion(damping: float) -> None:
    scene = rig(fx.ViscousJoint(2, damping))
    tight = run(scene, method="radau5", rtol=1e-11, atol=1e-13)
    for method in METHODS:
        sol = run(scene, method=method, rtol=1e-8, atol=1e-10, max_steps=9000)
        assert np.abs(sol.q - tight.q).max() < 1e-6


def angles_of_a_pushed_rod(damping: float, friction: float, times: list[float]) -> list[float]:
    """J = 1, torque sin t, from rest: w' = sin t - f sgn w - b w, w = 0 where abs(sin t) <= f.

    It returns b times the angles.
    """
    b, f = mpf(damping), mpf(friction)
    angles, angle, side = [mpf(0)] * len(times), mpf(0), 1
    begins = mp.asin(f)
    while begins < times[-1]:

        def particular(t: mpf, side: int = side) -> mpf:
            return (b * mp.sin(t) - mp.cos(t)) / (1 + b * b) - side * f / b

        left = -particular(begins)

        def rate(t: mpf, begins: mpf = begins, left: mpf = left) -> mpf:
            return particular(t) + left * mp.exp(-b * (t - begins))

        def turned(t: mpf, begins: mpf = begins, left: mpf = left, side: int = side) -> mpf:
            swung = (-b * (mp.cos(t) - mp.cos(begins)) - mp.sin(t) + mp.sin(begins)) / (1 + b * b)
            gone = left / b * (1 - mp.exp(-b * (t - begins)))
            return swung - side * f / b * (t - begins) + gone

        # The rate is zero a little after the torque is f again, by less than 1/b and less than pi.
        falls = begins + mp.pi - 2 * mp.asin(f)
        ends = findroot(rate, (falls, falls + min(3 / b, mpf(1))), solver="anderson", tol=1e-60)
        for k, time in enumerate(times):
            if time >= begins:
                angles[k] = angle + turned(min(mpf(time), ends))
        angle += turned(ends)
        begins += mp.pi
        side = -side
        assert ends < begins
    return [float(angle * b) for angle in angles]


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["auto", "radau5", "dopri5-radau5"])
@pytest.mark.parametrize("damping", [10.0**k for k in range(1, 13)])
def test_a_pushed_rod_slides_and_sticks_as_the_closed_form_has_it(
    damping: float, method: str
) -> None:
    mp.dps = 50
    push = fx.Motor(1, sinusoid=fx.Sinusoid(amplitude=1, angular_frequency=1))
    scene = rod(push, fx.DryJointFriction(1, coulomb=0.2), fx.ViscousJoint(1, damping))
    times = np.linspace(0, 12, 121)
    how: dict[str, Any] = {"rtol": 1e-9, "atol": 1e-9 / damping, "max_steps": 60_000}
    sol = pc.simulate(scene, q0=0.0, t_span=(0, 12), t_eval=times, method=method, **how)
    assert sol.success, sol.message
    exact = angles_of_a_pushed_rod(damping, 0.2, list(times))
    assert sol.q[:, 0] * damping == pytest.approx(exact, abs=1e-5)
    sticks = np.abs(np.sin(times)) < 0.19
    late = sticks & (times > 1)
    slid = np.abs(np.sin(times - 5 / damping)) < 0.19  # and has come to rest by then
    assert (sol.qd[late & slid] == 0.0).all()
