"""Scenes of one to nine links with every effect, and what a member has in common with its run."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import FORCES

E = pc.effects
BOOK = pc.Scene.textbook()
WAVE = E.Sinusoid(3.0, 6.0, 0.4)
DRAG = {"drag_coefficient": 1.2, "diameter": 0.2}


@FORCES
def damping_that_jumps(t, n, q, qd, forces, data):
    for i in range(n):
        forces[i] -= (0.1 if t < 0.5 else 0.4) * qd[i]


def pivot(x: tuple[float, ...] = (), y: tuple[float, ...] = ()) -> E.Effect:
    return E.DrivenPivot(x=E.Sinusoid(*x) if x else None, y=E.Sinusoid(*y) if y else None)


EFFECTS: dict[str, Callable[[int], list[E.Effect]]] = {  # of chains of n links
    "bare": lambda n: [],
    "payload and a rotor in joint 1": lambda n: [E.Payload(0.3), E.RotorInertia(1, 0.2)],
    "a rotor between links": lambda n: [E.RotorInertia(min(2, n), 0.2), E.ViscousJoint(1, 0.1)],
    "rotors and damping": lambda n: [
        *(E.RotorInertia(k + 1, 0.1 + 0.05 * k) for k in range(n)), E.ViscousJoint(n, 0.1),
    ],
    "damping": lambda n: [E.ViscousJoint(1, 0.1), E.ViscousJoint(n, 0.3)],
    "a spring and the cube of a rate": lambda n: [
        E.TorsionalSpring(n, 3.0, rest_angle=0.2), E.ViscousJoint(n, 0.1, damping3=0.05),
    ],
    "a constant": lambda n: [E.TorsionalSpring(1, 3.0), E.Motor(1, constant=2.0), E.Payload(0.3)],
    "a controller": lambda n: [E.Motor(n, pd=E.PD(4.0, 0.5, 0.3))],
    "one wave": lambda n: [E.Motor(1, sinusoid=WAVE)],
    "waves and damping": lambda n: [
        E.Motor(1, sinusoid=WAVE), E.Motor(n, sinusoid=E.Sinusoid(1.0, 11.0)),
        E.ViscousJoint(n, 0.1),
    ],
    "three waves": lambda n: [E.Motor(1, sinusoid=E.Sinusoid(1.0, 6.0 + k)) for k in range(3)],
    "five waves": lambda n: [
        E.Motor(1 + k % n, sinusoid=E.Sinusoid(1.0, 6.0 + k)) for k in range(5)
    ],
    "shaken along x": lambda n: [pivot(x=(0.05, 9.0)), E.ViscousJoint(1, 0.1)],
    "shaken along y": lambda n: [pivot(y=(0.05, 40.0))],
    "shaken both ways": lambda n: [
        pivot((0.05, 9.0), (0.1, 4.0, 1.0)), E.ViscousJoint(1, 0.2, damping3=0.03),
    ],
    "two shaken pivots and two motors": lambda n: [
        E.Motor(1, sinusoid=WAVE), pivot(y=(0.02, 20.0)),
        E.Motor(n, sinusoid=E.Sinusoid(1.0, 5.0)), pivot(x=(0.1, 3.0)),
    ],
    "all rows of joints": lambda n: [
        E.ViscousJoint(min(4, n), 0.1, damping3=0.05), E.ViscousJoint(n, 0.2, damping3=0.02),
        E.Motor(min(5, n), sinusoid=E.Sinusoid(1.0, 5.0)), E.TorsionalSpring(n, 2.0),
        E.RotorInertia(n, 0.05),
    ],
    "drag": lambda n: [E.RodDrag(n, **DRAG)],
    "drag twice": lambda n: [E.RodDrag(n, **DRAG)] * 2,
    "drag and wind, a motor and damping": lambda n: [
        E.RodDrag(1, **DRAG, wind=(4.0, -1.0)), E.Motor(n, sinusoid=E.Sinusoid(1.0, 5.0)),
        E.RodDrag(n, **DRAG), E.ViscousJoint(min(2, n), 0.1),
    ],
    "drag, motors and a shaken pivot": lambda n: [
        E.RodDrag(n, **DRAG, wind=(4.0, -1.0)), E.Motor(1, sinusoid=WAVE),
        pivot((0.05, 9.0), (0.03, 20.0, 1.0)), E.Motor(n, sinusoid=E.Sinusoid(1.0, 4.0)),
        E.RotorInertia(n, 0.1),
    ],
    "drag, rotors and damping": lambda n: [
        *(E.RotorInertia(k + 1, 0.1 + 0.05 * k) for k in range(n)), E.RodDrag(min(2, n), **DRAG),
        E.ViscousJoint(n, 0.1),
    ],
}  # fmt: skip
SWITCHING: dict[str, Callable[[int], list[E.Effect]]] = {
    "friction": lambda n: [E.DryJointFriction(n, 0.2, static=0.3)],
    "a stop": lambda n: [E.JointStop(n, range=(-1.9, 1.9), restitution=0.5)],
    "a lock": lambda n: [E.Lock(n)],
    "a motor at its limit": lambda n: [E.Motor(1, sinusoid=WAVE, limit=2.0)],
    "a table": lambda n: [E.Motor(1, table=E.Table([0.0, 1.0, 4.0], [0.0, 1.0, -1.0]))],
    "a table that holds": lambda n: [E.Motor(1, table=E.Table([0, 0.4, 4], [1, -2, 7], hold=True))],
    "a function": lambda n: [E.User(lambda t, q, qd: -0.1 * qd)],
    "a function that jumps": lambda n: [
        E.User(lambda t, q, qd: (-0.1 if t < 0.5 else -0.4) * qd, breaks=[0.5]),
    ],
    "a compiled function": lambda n: [E.CompiledUser(damping_that_jumps, breaks=[0.5])],
}
ALL = EFFECTS | SWITCHING


def chain(n: int, effects: str = "bare") -> pc.Scene:
    links = [pc.Link(mass=1.0 + 0.2 * i, length=1.0 - 0.1 * i) for i in range(n)]
    return pc.Scene(links=links, gravity=9.81, effects=ALL[effects](n))


def lanes_of(n: int, effects: str) -> tuple[str, ...]:
    """Return the methods whose members go in lanes, as the documents have it."""
    if effects in SWITCHING:
        return ()
    runge_kutta = ("dopri5", "dop853") if n <= 4 else ()
    series = ("taylor",) if 2 <= n <= 100 and "drag" not in effects else ()
    return (*runge_kutta, *series)


def has_lanes() -> bool:
    return pc._core.instruction_set() in ("x86-64-v3", "x86-64-v4")


def starts(count, n, seed, reach):
    return pc.sampling.uniform(-reach, reach, (count, n), seed=seed)


def assert_runs(
    scene, q0, qd0=0.0, t_span=(0, 3), *, vary=None, events=(), firsts=None, times=None, **options
):
    """Assert that every member is the run of `simulate`; return the ensemble.

    `firsts` are events of which the first is kept, `times` those at which states are. With one
    thread, lanes are full whatever the number of processors.
    """
    vary, firsts = vary or {}, firsts or {}
    keep = {name: pc.reducers.FirstEvent(event) for name, event in firsts.items()} or "end"
    workers, options = options.pop("workers", 1), {"on_failure": "ignore"} | options
    kept = {"keep": keep} if times is None else {"keep": "times", "t_eval": times}
    found = pc.ensemble(
        scene, q0=q0, qd0=qd0, t_span=t_span, vary=vary, events=[*events], workers=workers,
        **kept, **options,
    )  # fmt: skip
    stored = {"store": "end"} if times is None else {"t_eval": times}
    q, qd = (np.broadcast_to(x, (*found.shape, len(scene.links))) for x in (q0, qd0))
    evaluations = 0
    for i in np.ndindex(found.shape):
        values = {name: np.broadcast_to(x, found.shape)[i] for name, x in vary.items()}

        def alone(i=i, values=values):
            return pc.simulate(
                scene.with_parameters(values) if values else scene, q0=q[i], qd0=qd[i],
                t_span=t_span, events=[*events, *firsts.values()], **stored, **options,
            )  # fmt: skip

        if found.status[i] == "refused":
            with pytest.raises(ValueError, match="must be"):
                alone()
            continue
        run = alone()
        evaluations += run.stats.nfev
        assert found.status[i] == run.status, i
        reached = len(run.t)
        if times is None:
            assert found.t[i] == run.t[-1], i
            assert np.array_equal([*found.q[i], *found.qd[i]], run.y[:, -1], equal_nan=True), i
        else:
            assert np.array_equal(found.q[i][:reached], run.q), i
            assert np.array_equal(found.qd[i][:reached], run.qd), i
            assert np.isnan(found.q[i][reached:]).all(), i
        for name, crossings in zip(firsts, run.events[len(events) :], strict=True):
            first = [*crossings.t, np.nan][0]
            assert np.array_equal(found[name][i], first, equal_nan=True), (name, i)
    assert found.statistics["nfev"] == evaluations
    return found
