"""A run that goes on at the end it was cut for, or stays there: the same in every bit."""

from __future__ import annotations

from typing import Any

import pendcore as pc
import pytest
from pendcore import effects as fx
from test_resumed_anywhere import differences


# Ends at which the step that is cut there is rejected.
@pytest.mark.parametrize(
    ("method", "rtol", "t_end"),
    [("dopri5", 1e-3, 3.4), ("dopri5", 1e-6, 4.1), ("dop853", 1e-3, 2.3), ("dop853", 1e-3, 3.1)],
)
def test_one_attempt_a_leg_gets_past_a_last_step_that_is_rejected(
    method: str, rtol: float, t_end: float
) -> None:
    free = pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * 2)
    how = {"method": method, "rtol": rtol}
    whole = pc.simulate(free, q0=[0.4, 1.0], qd0=[3.0, -2.0], t_span=(0, t_end), **how)
    longer = pc.simulate(free, q0=[0.4, 1.0], qd0=[3.0, -2.0], t_span=(0, t_end + 1), **how)
    sol = pc.simulate(
        free,
        q0=[0.4, 1.0],
        qd0=[3.0, -2.0],
        t_span=(0, t_end),
        max_steps=1,
        on_failure="ignore",
        **how,
    )
    attempts = whole.stats.accepted + whole.stats.rejected
    for _ in range(attempts - 1):
        assert sol.status == "max_steps"
        assert differences(longer, sol.resume(t_end + 1)) == []
        sol = sol.resume(t_end, max_steps=1, on_failure="ignore")
    assert differences(whole, sol) == []


FAST = fx.Motor(1, sinusoid=fx.Sinusoid(amplitude=1e243, angular_frequency=1e154))


@pytest.mark.parametrize("store", ["steps", "dense"])
@pytest.mark.parametrize("steps", [1, 3, 7, 20])
@pytest.mark.parametrize(
    "effects",
    [[], [fx.Lock(1), FAST], [fx.DryJointFriction(2, coulomb=0.01)]],
    ids=["free", "fast motor on a locked joint", "friction"],
)
def test_to_go_on_to_where_a_run_stands_is_to_stay_there(
    effects: list[fx.Effect], steps: int, store: str
) -> None:
    """The time of the run has more digits than a double, and differs from `sol.t[-1]` by these."""
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * 2, effects=effects)
    start = ((1.0, 3.0), [1.0, 1.0], [0.0, 0.5])
    how = {"method": "dopri5", "store": store}
    whole = pc.simulate(scene, *start, **how)
    sol = pc.simulate(scene, *start, max_steps=steps, on_failure="ignore", **how)
    stays = sol.resume(sol.t[-1])
    assert stays.status == "finished"
    assert stays.t.tobytes() == sol.t.tobytes()
    assert stays.y.tobytes() == sol.y.tobytes()
    assert differences(whole, stays.resume(3.0)) == []


def test_a_run_whose_contact_had_no_solution_does_not_go_on() -> None:
    """A mass of 2e-308 leaves the torque that holds a joint without a finite value."""
    links = [
        pc.Link(mass=1.0, length=1.0),
        pc.Link(mass=0.5, length=4.950390459371252),
        pc.Link(mass=2.2250738585072014e-308, length=0.9054300677378225),
        pc.Link(
            mass=0.5398889769668388,
            length=0.6640109902174399,
            center=0.6640109902174399,
            inertia=0.0,
        ),
    ]
    effects = [fx.DryJointFriction(joint=1, coulomb=5.9951481635280395), fx.Lock(joint=4)]
    start: dict[str, Any] = {
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
