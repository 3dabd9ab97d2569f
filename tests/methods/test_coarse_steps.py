"""Steps that are accepted although they are nowhere near the motion: nothing in them overflows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)


def between(sol: pc.Solution) -> np.ndarray:
    """The dense output at 4000 times of the part that the run has reached."""
    return sol(np.linspace(sol.t[0], sol.t[-1], 4000))


@pytest.mark.parametrize(
    ("links", "law", "qd0", "t_end", "options"),
    [
        (
            1, fx.ViscousJoint(joint=1, damping=2.993828540288064, damping2=6.6839541870275205),
            0.0, -1.2361087799335069,
            {"method": "dop853", "rtol": 1.0, "first_step": 9.972919077549067},
        ),
        (
            2, fx.ViscousJoint(joint=2, damping=0.28, damping2=0.131, damping3=0.715),
            0.0, 3.796775471128963, {"method": "dop853-radau5", "rtol": 1.0},
        ),
    ],
)  # fmt: skip
def test_a_step_of_coarse_tolerances_overflows_nowhere(
    links: int, law: pc.effects.ViscousJoint, qd0: float, t_end: float, options: dict[str, Any]
) -> None:
    """The new state is finite, but the stages of the dense output overflow, so it is a line."""
    scene = pc.Scene(links=[ROD] * links, gravity=9.807, effects=[law])
    sol = pc.simulate(
        scene, q0=0.0, qd0=qd0, t_span=(0.0, t_end), max_steps=1000, on_failure="ignore", **options
    )
    assert sol.stats.accepted > 0
    assert np.isfinite(between(sol)).all()


def test_dense_output_is_finite_under_a_law_of_1e145() -> None:
    """A rate far below atol has a torque whose cube overflows in the stages of dense output."""
    law = fx.ViscousJoint(joint=1, damping=10.0, damping3=4.376330066954931e145)
    scene = pc.Scene(links=[ROD], gravity=9.807, effects=[law])
    sol = pc.simulate(
        scene, q0=0.0, t_span=(0.0, 0.19498208047693533), max_steps=3000, on_failure="ignore"
    )
    assert sol.stats.accepted > 0
    assert np.isfinite(between(sol)).all()
    assert (sol(sol.t) == sol.y).all()


def test_a_ledger_that_overflows_leaves_the_dense_output_as_it_is() -> None:
    """Angles of 1e288 are finite, and the powers of their rates are not."""
    links = [
        {"mass": 1.0, "length": 1.0},
        {
            "mass": 1.6179701046668573e-07,
            "length": 0.17089083689803455,
            "center": 0.012296665718749484,
            "inertia": 7.509261032973153e-10,
        },
        {"mass": 0.0020113465436223618, "length": 4.7132208388078395e-05},
        {"mass": 0.019354970919150415, "length": 99705967843.58824},
        {"mass": 0.002352647835956727, "length": 1.1134270253527419e-11},
        {"mass": 6611532493.41551, "length": 0.723111407588497},
    ]
    law = fx.ViscousJoint(joint=4, damping=0.0, damping3=3.4400311607073915e-07)
    with pytest.warns(pc.PendcoreWarning):  # about the masses
        scene = pc.Scene(links=[pc.Link(**link) for link in links], effects=[law])
    q0 = [0.0, -4.999833471907522e-09, 0.0, 0.0, -100.67072600291924, 0.0]
    plain, booked = (
        pc.simulate(
            scene, q0=q0, t_span=(0.0, 2.690715162498401), step=1e4, method="rk4", ledger=ledger,
            on_failure="ignore",
        )
        for ledger in (False, True)
    )  # fmt: skip
    assert plain.stats.accepted == booked.stats.accepted == 1
    assert (between(plain) == between(booked)).all()


@pytest.mark.parametrize("step", [0.1, 0.5, 0.9, 1.843])
def test_a_fixed_step_beyond_stability_is_not_said_to_chatter(step: float) -> None:
    """Its dense output has slopes of its own where the joint begins at rest."""
    law = fx.ViscousJoint(
        joint=3,
        damping=3.4900740828110077,
        damping2=0.10508575631518155,
        damping3=0.16826288691444558,
    )
    scene = pc.Scene(links=[ROD] * 3, gravity=9.807, effects=[law])
    sol = pc.simulate(
        scene,
        q0=[0.0, 0.0, 0.5],
        t_span=(-2.5, -1.578),
        step=step,
        method="rk4",
        on_failure="ignore",
    )
    assert sol.stats.accepted > 0
    assert "back and forth" not in sol.message


def test_a_coarse_fixed_step_from_the_limit_of_a_motor_is_not_said_to_chatter() -> None:
    """The slope of the torque leads away from the limit; the dense output crosses it at once."""
    links = [
        pc.Link(mass=10.0, length=0.12047458140905794, center=0.12047458140905794, inertia=0.0),
        ROD,
        ROD,
        pc.Link(mass=1.0, length=0.1337159761505461),
    ]
    gains = fx.PD(kp=-0.8028859052645209, kd=-5.0898496951303835, reference=-2.5487245229637043)
    scene = pc.Scene(
        links=links,
        gravity=9.807,
        effects=[
            fx.Motor(joint=1, pd=gains, limit=0.1),
            fx.ViscousJoint(joint=4, damping=5.9206929377593775),
        ],
    )
    q0 = [0.4982294823897364, 0.0, 1.4740807834029885, 0.0]
    sol = pc.simulate(scene, q0=q0, t_span=(0.0, -0.281), step=0.02, on_failure="ignore")
    assert sol.stats.accepted > 0
    assert "back and forth" not in sol.message


def test_a_coarse_fixed_step_from_next_to_rest_is_not_said_to_chatter() -> None:
    """A rate of 1e-190 becomes zero so soon that only t = 0 lets doubles resolve the time."""
    law = fx.ViscousJoint(joint=4, damping=1.1095105527664928, damping2=9.704511218801674)
    scene = pc.Scene(links=[ROD] * 4, gravity=0.0, effects=[law])
    sol = pc.simulate(
        scene,
        q0=[0.0, 0.0, -0.7, 0.0],
        qd0=[0.0, -4.763463850557999, 0.0, 1.8869389483316333e-190],
        t_span=(0.0, 3.49),
        step=35.0,
        max_steps=10,
        on_failure="ignore",
    )
    assert sol.stats.accepted > 0
    assert "back and forth" not in sol.message


def test_a_coarse_fixed_step_from_a_stop_is_not_said_to_chatter() -> None:
    """The dense output of so long a step does not say how a joint leaves its stop."""
    stops = [
        fx.JointStop(joint=2, range=(-1.985532635591384, 1.8189509256194043), restitution=1.0),
        fx.JointStop(joint=1, range=(-1.5707963267948966, 0.040172632809008846)),
    ]
    scene = pc.Scene(links=[ROD] * 4, gravity=9.807, effects=stops)
    sol = pc.simulate(
        scene,
        q0=[-0.7653118469929439, 0.0, 1.040044893883345, -3.96349286902832],
        qd0=[0.24456355560734552, -10.0, 1.8644822435241977, -10.0],
        t_span=(0.0, 4.291248774290121),
        method="rk4",
        step=6.847012340570351,
        on_failure="ignore",
    )
    assert sol.stats.accepted > 0
    assert "back and forth" not in sol.message
