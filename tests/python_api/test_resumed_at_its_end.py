"""A run that goes on at the end it was cut for, or stays there: the same in every bit."""

from __future__ import annotations

import pendcore as pc
import pytest
from pendcore import effects as fx
from test_resumed_anywhere import RUBBED, differences


FREE = RUBBED.replace(effects=[])
# For each the scene, how it is run, and its end; the step that is cut at the end of the free runs
# is rejected.
LEGS = [
    *[
        (RUBBED, {"rtol": rtol, "ledger": ledger, "compensated": ledger}, 1.0)
        for rtol in (1e-3, 1e-8)
        for ledger in (False, True)
    ],
    (FREE, {"method": "dopri5", "rtol": 1e-3}, 3.4),
    (FREE, {"method": "dopri5", "rtol": 1e-6}, 4.1),
    (FREE, {"method": "dop853", "rtol": 1e-3}, 2.3),
    (FREE, {"method": "dop853", "rtol": 1e-3}, 3.1),
]


@pytest.mark.every_value("how")
@pytest.mark.parametrize(("scene", "how", "t_end"), LEGS)
def test_one_attempt_a_leg_is_the_same_run(scene, how, t_end):
    start, once = ([0.4, 1.0], [3.0, -2.0]), {"max_steps": 1, "on_failure": "ignore"}
    whole = pc.simulate(scene, (0, t_end), *start, **how)
    longer = pc.simulate(scene, (0, t_end + 1), *start, **how)
    assert whole.stats.limited_by_break > 2 or scene is FREE
    sol = pc.simulate(scene, (0, t_end), *start, **once, **how)
    legs = 1
    while sol.status == "max_steps":
        assert legs < 10_000
        if legs % 10 == 0 or scene is FREE:
            assert differences(longer, sol.resume(t_end + 1)) == []
        sol, legs = sol.resume(t_end, **once), legs + 1
    assert legs > 20 or scene is FREE
    assert scene is RUBBED or legs == whole.stats.accepted + whole.stats.rejected
    assert differences(whole, sol) == []


FAST = fx.Motor(1, sinusoid=fx.Sinusoid(amplitude=1e243, angular_frequency=1e154))


@pytest.mark.parametrize("store", ["steps", "dense"])
@pytest.mark.parametrize("steps", [1, 3, 7, 20])
@pytest.mark.parametrize(
    "effects",
    [[], [fx.Lock(1), FAST], [fx.DryJointFriction(2, coulomb=0.01)]],
    ids=["free", "fast motor on a locked joint", "friction"],
)
def test_to_go_on_to_where_a_run_stands_is_to_stay_there(effects, steps, store):
    """The time of the run has more digits than a double, and differs from `sol.t[-1]` by these."""
    scene = FREE.replace(effects=effects)
    start = ((1.0, 3.0), [1.0, 1.0], [0.0, 0.5])
    how = {"method": "dopri5", "store": store}
    whole = pc.simulate(scene, *start, **how)
    sol = pc.simulate(scene, *start, max_steps=steps, on_failure="ignore", **how)
    stays = sol.resume(sol.t[-1])
    assert stays.status == "finished"
    assert stays.t.tobytes() == sol.t.tobytes()
    assert stays.y.tobytes() == sol.y.tobytes()
    assert differences(whole, stays.resume(3.0)) == []


def test_a_run_whose_contact_had_no_solution_does_not_go_on():
    """A mass of 2e-308 leaves the torque that holds a joint without a finite value."""
    links = [
        pc.Link(mass=1.0, length=1.0),
        pc.Link(mass=0.5, length=4.950390459371252),
        pc.Link(mass=2.2250738585072014e-308, length=0.9054300677378225),
        pc.Link.point_mass(mass=0.5398889769668388, length=0.6640109902174399),
    ]
    effects = [fx.DryJointFriction(joint=1, coulomb=5.9951481635280395), fx.Lock(joint=4)]
    start = {
        "q0": [-1.0, -2.937960905417783, 1e-9, 0.0],
        "qd0": [0.5556183901582339, 0.0, 3.536705680691237, 3.536705680691237],
        "t_span": (-0.8563206000640616, 0.0),
        "on_failure": "ignore",
    }
    scene = pc.Scene(links=links, gravity=0.0, effects=effects)
    whole = pc.simulate(scene, **start)
    assert whole.status == "non_finite"
    stopped = pc.simulate(scene, **start, max_steps=whole.stats.accepted)
    assert stopped.status == "max_steps"
    resumed = stopped.resume(0.0, max_steps=300, on_failure="ignore")
    assert resumed.status == "non_finite"
    assert resumed._run.t_reached == whole._run.t_reached
