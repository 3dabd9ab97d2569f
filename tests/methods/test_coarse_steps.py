"""Steps that are accepted although they are nowhere near the motion: nothing in them overflows."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)


def damper(joint, damping, *powers):
    return fx.ViscousJoint(
        joint, damping, **dict(zip(("damping2", "damping3"), powers, strict=False))
    )


FROM_A_LIMIT = [
    pc.Link(mass=10.0, length=0.12047458140905794, center=0.12047458140905794, inertia=0.0),
    ROD, ROD, pc.Link(mass=1.0, length=0.1337159761505461),
]  # fmt: skip
GAINS = fx.PD(kp=-0.8028859052645209, kd=-5.0898496951303835, reference=-2.5487245229637043)
FIXED = [damper(3, 3.4900740828110077, 0.10508575631518155, 0.16826288691444558)]
COARSE = {  # links, effects, angles, rates, span, options
    # The new state is finite, but the stages of the dense output overflow, so it is a line.
    "long first step": (
        [ROD], [damper(1, 2.993828540288064, 6.6839541870275205)], 0, 0, (0, -1.2361087799335069),
        {"method": "dop853", "rtol": 1.0, "first_step": 9.972919077549067, "max_steps": 1000},
    ),
    "coarse tolerance": (
        [ROD] * 2, [damper(2, 0.28, 0.131, 0.715)], 0, 0, (0, 3.796775471128963),
        {"method": "dop853-radau5", "rtol": 1.0, "max_steps": 1000},
    ),
    # A rate far below atol has a torque whose cube overflows in the stages of dense output.
    "law of 1e145": (
        [ROD], [damper(1, 10.0, 0.0, 4.376330066954931e145)], 0, 0, (0, 0.19498208047693533),
        {"max_steps": 3000},
    ),
    # The dense output has slopes of its own where the joint begins at rest.
    **{
        f"beyond stability, {step} s": (
            [ROD] * 3, FIXED, [0, 0, 0.5], 0, (-2.5, -1.578), {"step": step, "method": "rk4"}
        )
        for step in (0.1, 0.5, 0.9, 1.843)
    },
    # The slope of the torque leads away from the limit; the dense output crosses it at once.
    "from the limit of a motor": (
        FROM_A_LIMIT, [fx.Motor(joint=1, pd=GAINS, limit=0.1), damper(4, 5.9206929377593775)],
        [0.4982294823897364, 0, 1.4740807834029885, 0], 0, (0, -0.281), {"step": 0.02},
    ),
    # A rate of 1e-190 becomes zero so soon that only t = 0 lets doubles resolve the time.
    "from next to rest": (
        [ROD] * 4, [damper(4, 1.1095105527664928, 9.704511218801674)], [0, 0, -0.7, 0],
        [0, -4.763463850557999, 0, 1.8869389483316333e-190], (0, 3.49),
        {"step": 35.0, "max_steps": 10, "gravity": 0.0},
    ),
    # The dense output of so long a step does not say how a joint leaves its stop.
    "from a stop": (
        [ROD] * 4,
        [
            fx.JointStop(2, (-1.985532635591384, 1.8189509256194043), restitution=1.0),
            fx.JointStop(1, (-1.5707963267948966, 0.040172632809008846)),
        ],
        [-0.7653118469929439, 0, 1.040044893883345, -3.96349286902832],
        [0.24456355560734552, -10, 1.8644822435241977, -10], (0, 4.291248774290121),
        {"method": "rk4", "step": 6.847012340570351},
    ),
}  # fmt: skip


def between(sol):
    """The dense output at 4000 times of the part that the run has reached."""
    return sol(np.linspace(sol.t[0], sol.t[-1], 4000))


@pytest.mark.parametrize("scene", COARSE)
def test_a_coarse_step_is_finite_all_along_and_not_said_to_chatter(scene):
    links, effects, q0, qd0, span, options = COARSE[scene]
    gravity = {"gravity": options.get("gravity", 9.807)}
    options = {name: value for name, value in options.items() if name != "gravity"}
    made = pc.Scene(links=links, effects=effects, **gravity)
    sol = pc.simulate(made, span, q0, qd0, on_failure="ignore", **options)
    assert sol.stats.accepted > 0
    assert "back and forth" not in sol.message
    assert np.isfinite(between(sol)).all()
    once = np.append(np.diff(sol.t) != 0, True)  # no impact
    assert (sol(sol.t) == sol.y)[:, once].all()


def test_a_ledger_that_overflows_leaves_the_dense_output_as_it_is():
    """Angles of 1e288 are finite, and the powers of their rates are not."""
    rods = [
        (0.0020113465436223618, 4.7132208388078395e-05),
        (0.019354970919150415, 99705967843.58824),
        (0.002352647835956727, 1.1134270253527419e-11),
        (6611532493.41551, 0.723111407588497),
    ]
    heavy_end = pc.Link(
        mass=1.6179701046668573e-07, length=0.17089083689803455, center=0.012296665718749484,
        inertia=7.509261032973153e-10,
    )  # fmt: skip
    law = fx.ViscousJoint(joint=4, damping=0.0, damping3=3.4400311607073915e-07)
    links = [ROD, heavy_end, *(pc.Link(mass=m, length=length) for m, length in rods)]
    with pytest.warns(pc.PendcoreWarning):  # about the masses
        scene = pc.Scene(links=links, effects=[law])
    q0 = [0.0, -4.999833471907522e-09, 0.0, 0.0, -100.67072600291924, 0.0]
    how = {"step": 1e4, "method": "rk4", "on_failure": "ignore"}
    plain, booked = (
        pc.simulate(scene, (0.0, 2.690715162498401), q0, ledger=ledger, **how)
        for ledger in (False, True)
    )
    assert plain.stats.accepted == booked.stats.accepted == 1
    assert (between(plain) == between(booked)).all()
