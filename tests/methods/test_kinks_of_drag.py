"""Steps of dop853 end where an end of a rod turns into the wind: there, drag has a kink."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest

E = pc.effects
NEAR_AN_END = 0.02
"""The share of a step that may be left beside a kink. The core leaves a hundredth of a cubic's."""


def in_air(n: int, wind: tuple[float, float], *others: E.Effect) -> pc.Scene:
    rods = [pc.Link(mass=1.0, length=0.8), pc.Link(mass=0.5, length=0.5)]
    drag = {"drag_coefficient": 1.2, "diameter": 0.1, "air_density": 3.0, "wind": wind}
    effects = [*(E.RodDrag(link=k + 1, **drag) for k in range(n)), *others]
    return pc.Scene(links=rods[:n], effects=effects)


SHAKEN = E.DrivenPivot(x=E.Sinusoid(0.1, 5.0), y=E.Sinusoid(0.2, 7.0))
RUBBED = E.DryJointFriction(joint=1, coulomb=0.2)
SCENES = {
    "a rod": (in_air(1, (0.0, 0.0)), [0.4], [1.0]),
    "a rod in the wind": (in_air(1, (3.0, -1.0)), [0.4], [8.0]),
    "two rods": (in_air(2, (0.0, 0.0)), [0.3, 1.0], [4.0, -6.0]),
    "two rods in the wind, shaken": (in_air(2, (3.0, -1.0), SHAKEN), [0.3, 1.0], [4.0, -6.0]),
    "two rods in the wind that rub": (in_air(2, (3.0, -1.0), RUBBED), [0.3, 1.0], [4.0, -6.0]),
}


def speeds(scene: pc.Scene, t: Any, q: Any, qd: Any) -> Any:
    """The speeds of both ends of each rod across it, against the wind, (k, ends)."""
    ends = scene.velocities(t, q, qd)
    found = []
    for drag in (one for one in scene.effects if isinstance(one, E.RodDrag)):
        n = np.stack([-np.sin(q[:, drag.link - 1]), np.cos(q[:, drag.link - 1])], axis=1)
        found += [((ends[:, k] - drag.wind) * n).sum(axis=1) for k in (drag.link - 1, drag.link)]
    return np.stack(found, axis=1)


@pytest.mark.parametrize(
    ("case", "span"),
    [*((case, (0, 5)) for case in SCENES), ("a rod", (3, 0))],  # back in time, air drives it
)
def test_steps_end_where_drag_has_a_kink(case: str, span: Any) -> None:
    scene, q0, qd0 = SCENES[case]
    sol = pc.simulate(scene, span, q0, qd0)
    starts = np.append(sol.step_starts, sol.t_reached)
    shares = np.linspace(NEAR_AN_END, 1 - NEAR_AN_END, 9)
    t = (starts[:-1, None] + np.diff(starts)[:, None] * shares).ravel()
    y = sol(t).T
    n = len(scene.links)
    signs = np.sign(speeds(scene, t, y[:, :n], y[:, n:])).reshape(-1, len(shares), 2 * n)
    within = np.abs(np.diff(signs, axis=1)).max(axis=(1, 2)) > 1
    across = np.abs(signs[1:, 0] - signs[:-1, -1]).max(axis=1) > 1
    assert across.any()
    assert not within.any()


@pytest.mark.parametrize(
    ("case", "allowed"),
    [("a rod", 1), ("two rods in the wind, shaken", 100), ("two rods in the wind that rub", 100)],
)
def test_runs_in_air_are_as_accurate_as_others(case: str, allowed: float) -> None:
    """Across kinks, errors of dop853 would be 11, 3100 and 2800 times rtol."""
    scene, q0, qd0 = SCENES[case]
    how: Any = {"method": "dopri5", "rtol": 1e-14, "atol": 1e-17, "max_step": 5e-4}
    for t_end in (0.5, 1.0, 1.5, 2.0):
        right = pc.simulate(scene, (0, t_end), q0, qd0, store="end", **how)
        found = pc.simulate(scene, (0, t_end), q0, qd0, store="end", rtol=1e-11, atol=1e-14)
        assert np.abs(found.y - right.y).max() < allowed * 1e-11


@pytest.mark.parametrize("share", [0.001, 0.003, 0.3, 0.97, 0.991, 0.995, 0.999])
@pytest.mark.parametrize("rtol", [1e-7, 1e-9])
def test_wherever_in_the_first_step_the_kink_lies(share: float, rtol: float) -> None:
    """The step would also lead to the end of the run, which the loop stretches a step to reach."""
    h = 0.03
    drag = E.RodDrag(link=1, drag_coefficient=1.2, diameter=0.1, air_density=3.0)
    pushed = pc.Scene(
        links=[pc.Link(mass=1.0, length=0.8)], gravity=0.0,
        effects=[drag, E.Motor(joint=1, constant=-60.0)],
    )  # fmt: skip
    rate = -float(pushed.accelerations(0.0, [0.0], [0.0])[0]) * share * h
    tight: Any = {"method": "dopri5", "rtol": 1e-14, "atol": 1e-18, "max_step": h / 400}
    right = pc.simulate(pushed, (0, h), 0.0, rate, **tight).y[:, -1]
    found = pc.simulate(pushed, (0, h), 0.0, rate, rtol=rtol, first_step=h)
    allowed = 1e-12 + rtol * np.maximum(np.abs(right), [0.0, abs(rate)])
    assert (np.abs(found.y[:, -1] - right) < allowed).all()


def test_a_run_that_is_resumed_beside_a_jump_of_a_law_in_air() -> None:
    """The state is the same on both sides of the jump, but its derivative is not."""
    scene, q0, qd0 = SCENES["a rod"]
    turn = pc.simulate(scene, (0, 2), q0, qd0, events=[pc.events.RateZero(link=1)]).events[0].t[0]
    jumps = E.Table(t=[0, turn - 0.01, 5], torque=[0.0, 3.0, 3.0], hold=True)
    scene = scene.replace(effects=[*scene.effects, E.Motor(joint=1, table=jumps)])
    whole = pc.simulate(scene, (0, 1.5), q0, qd0)
    for steps in range(1, whole.stats.accepted + whole.stats.rejected):
        part = pc.simulate(scene, (0, 1.5), q0, qd0, max_steps=steps, on_failure="ignore")
        assert part.resume(1.5).fingerprint == whole.fingerprint


def test_drag_that_is_zero_changes_no_bit() -> None:
    bare = pc.Scene(links=SCENES["two rods"][0].links)
    still = bare.replace(effects=[E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.0)])
    damped = bare.replace(effects=[E.ViscousJoint(joint=2, damping=0.0)])
    runs = [pc.simulate(one, (0, 2), 0.3, 4.0, method="dop853") for one in (still, damped)]
    np.testing.assert_array_equal(runs[0].y, runs[1].y)


def test_rods_at_rest_in_air_take_long_steps() -> None:
    """There, rounding changes the sign of their speeds."""
    scene = SCENES["two rods"][0]
    sol = pc.simulate(scene, (0, 300), np.pi / 2, store="end")
    assert sol.stats.min_step > 0.1
    assert sol.stats.rejected < sol.stats.accepted / 10


def test_far_from_time_zero_runs_in_air_go_on() -> None:
    """A step to a kink may be too short for the time to resolve."""
    rng = np.random.default_rng(5)
    starts = rng.uniform(-2, 2, (40, 2)), rng.uniform(-6, 6, (40, 2))
    found = pc.ensemble(SCENES["two rods"][0], (1e11, 1e11 + 5), *starts, on_failure="ignore")
    assert (found.status == "finished").all()
