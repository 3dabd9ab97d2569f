"""An event that ended a run is not found again where a new run starts, and no other is lost.

The state that a run stored at an event lies on it to rounding only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pendcore as pc
import pytest
from numpy.typing import NDArray
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import rod

Array = NDArray[np.float64]
METHODS = ["dopri5", "dop853", "taylor", "radau5", "rk4"]
DOWN = np.pi / 2


def drawn_event(kind: str, n: int, dice: np.random.Generator) -> ev.Event:
    """Draw a terminal event of a kind that a swinging or turning chain of n links meets."""
    number, value = int(dice.integers(1, n + 1)), float(dice.uniform(-1, 3))
    normal = dice.normal(size=2)
    kinds: dict[str, Callable[[], ev.Event]] = {
        "joint angle": lambda: ev.JointAngle(number, value, every_turn=True, terminal=True),
        "joint angle 0": lambda: ev.JointAngle(number, 0.0, terminal=True),
        "link angle": lambda: ev.LinkAngle(number, value, terminal=True),
        "link angle 0": lambda: ev.LinkAngle(number, 0.0, every_turn=True, terminal=True),
        "rate of a joint": lambda: ev.RateZero(joint=number, terminal=True),
        "rate of a link": lambda: ev.RateZero(link=number, terminal=True),
        "tip": lambda: ev.TipLine(dice.uniform(-0.5, 0.5, size=2), normal, terminal=True),
        "function": lambda: ev.Function(
            lambda t, q, qd: float(np.sin(q[0]) * qd[-1] - 0.3 * np.sin(t)), terminal=True
        ),
    }
    return kinds[kind]()


KINDS = [
    "joint angle", "joint angle 0", "link angle", "link angle 0", "rate of a joint",
    "rate of a link", "tip", "function",
]  # fmt: skip


def restarts(
    kind: str, method: str, sense: int, seeds: int
) -> Iterator[tuple[pc.Solution, pc.Solution]]:
    """Yield runs that start on an event, each with the run that went on instead of ending."""
    options = {"method": method, "step": 0.002 if method == "rk4" else None}
    for seed in range(seeds):
        dice = np.random.default_rng(seed)
        n = int(dice.integers(1, 4))
        links = [pc.Link(mass=m, length=x) for m, x in dice.uniform(0.3, 1.5, size=(n, 2))]
        scene = pc.Scene(links=links, effects=[fx.ViscousJoint(1, 0.05)])
        event = drawn_event(kind, n, dice)
        t, end = float(dice.choice([0.0, 7.3])), 4.0
        q, qd = dice.uniform(-3, 3, size=n), dice.uniform(-4, 4, size=n)
        for _ in range(4):
            sol = pc.simulate(
                scene, q0=q, qd0=qd, t_span=(t, t + sense * end), events=[event], **options
            )
            if sol.status != "event":
                break
            t, y = float(sol.t[-1]), sol.y[:, -1]
            q, qd = y[:n], y[n:]
            goes_on = sol.resume(t + sense * 0.5)
            yield (
                pc.simulate(
                    scene, q0=q, qd0=qd, t_span=(t, t + sense * 0.5), events=[event], **options
                ),
                goes_on,
            )


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_run_from_an_event_finds_next_what_the_run_that_goes_on_finds(
    kind: str, method: str, sense: int
) -> None:
    count = 0
    for again, goes_on in restarts(kind, method, sense, seeds=18):
        (found,), (all_found,) = again.events, goes_on.events
        start = again.t[0]
        expected = [one.t for one in all_found if (one.t - start) * sense > 0]
        assert [one.t for one in found] == pytest.approx(expected, abs=2e-4)
        assert all(abs(one.t - start) > 1e-9 for one in found)
        count += 1
    assert count >= 10


def switched(
    scene_of: Callable[[float], pc.Scene],
    event: ev.Event,
    q: float,
    sign: float,
    sense: int,
    method: str,
) -> list[float]:
    """Return the times within 30 s at which a loop over runs changes the sign of a torque."""
    t, rate, times = 0.0, 0.0, []
    while True:
        sol = pc.simulate(
            scene_of(sign), q0=q, qd0=rate, t_span=(t, 30.0 * sense), events=[event], method=method,
            step=0.01 if method == "rk4" else None, rtol=1e-10, atol=1e-12,
        )  # fmt: skip
        if sol.status != "event" or len(times) > 100:
            return times
        t, (q, rate), sign = float(sol.t[-1]), sol.y[:, -1], -sign
        times.append(t)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "event",
    [
        ev.JointAngle(1, DOWN, terminal=True),
        ev.LinkAngle(1, DOWN, terminal=True),
        ev.TipLine((0.0, 0.3), (1.0, 0.0), terminal=True),
        ev.Function(lambda t, q, qd: np.cos(q[0]), max_step=0.1, terminal=True),
    ],
    ids=lambda event: event.kind,
)
def test_a_bang_bang_loop_over_angles_switches_as_often_as_its_exact_answer(
    event: ev.Event, method: str, sense: int
) -> None:
    """Phi'' = -sign(phi) from rest at 0.4: a quarter of a period is sqrt(0.8)."""
    times = switched(lambda u: rod(fx.Motor(1, constant=u)), event, DOWN + 0.4, -1.0, sense, method)
    exact = np.sqrt(0.8) * np.arange(1, 34, 2)
    assert exact[-1] < 30 < exact[-1] + 2 * exact[0]
    assert times == pytest.approx(sense * exact, abs=1e-7)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "event", [ev.RateZero(joint=1, terminal=True), ev.RateZero(link=1, terminal=True)], ids=str
)
def test_a_bang_bang_loop_over_rates_switches_as_often_as_its_exact_answer(
    event: ev.Event, method: str, sense: int
) -> None:
    """Phi'' = -9 phi + 0.1 sign(phi'): the rate is zero every half period, pi/3."""

    def scene(u: float) -> pc.Scene:
        return rod(fx.TorsionalSpring(1, stiffness=9.0), fx.Motor(1, constant=u))

    times = switched(scene, event, 0.4, -0.1 * sense, sense, method)
    assert times == pytest.approx(sense * np.pi / 3 * np.arange(1, 29), abs=1e-6)


CLOSE = [1e-3, 1e-6, 1e-9, 1e-12]


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("distance", CLOSE)
@pytest.mark.parametrize("method", METHODS)
def test_events_that_come_close_after_the_start_are_found(
    method: str, distance: float, sense: int
) -> None:
    """A free rod with the rate 2 is at each of them when it has turned by the distance."""
    q0 = 0.7
    value = q0 + sense * distance
    line = ev.TipLine((np.cos(value), np.sin(value)), (-np.sin(value), np.cos(value)))
    watched = [
        ev.JointAngle(1, value), ev.LinkAngle(1, value + 4 * np.pi, every_turn=True), line,
        ev.Function(lambda t, q, qd: q[0] - value),
    ]  # fmt: skip
    step = 0.01 if method == "rk4" else None
    sol = pc.simulate(
        rod(), q0=q0, qd0=2.0, t_span=(0, sense * 0.5), events=watched, method=method, step=step
    )
    for found in sol.events:
        (one,) = found
        assert one.t == pytest.approx(sense * distance / 2, abs=3e-15)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("distance", CLOSE)
@pytest.mark.parametrize("method", METHODS)
def test_a_rate_that_is_zero_close_after_the_start_is_found(
    method: str, distance: float, sense: int
) -> None:
    """Phi'' = -1 from the rate `distance`, which is zero after as many seconds."""
    step = 0.01 if method == "rk4" else None
    sol = pc.simulate(
        rod(fx.Motor(1, constant=-1.0)), q0=0.0, qd0=sense * distance, t_span=(0, sense * 0.5),
        method=method, events=[ev.RateZero(joint=1), ev.RateZero(link=1)], step=step,
    )  # fmt: skip
    for found in sol.events:
        (one,) = found
        assert one.t == pytest.approx(sense * distance, rel=1e-9, abs=3e-15)


@pytest.mark.parametrize("rate", [1.0, 1e-3, 1e-5])
@pytest.mark.parametrize("method", METHODS)
def test_a_run_that_starts_on_an_event_finds_the_way_back(method: str, rate: float) -> None:
    """Phi = w t - t^2/2 from an angle that rounding leaves beside the event: back after 2 w."""
    off = 0.7 + 1e-15  # on the side from which rounding would make the start a crossing
    back = rate + np.sqrt(rate**2 - 2 * (off - 0.7))
    scene = rod(fx.Motor(1, constant=-1.0))
    step = rate / 50 if method == "rk4" else None
    line = ev.TipLine((np.cos(off), np.sin(off)), (-np.sin(off), np.cos(off)))
    watched = [ev.JointAngle(1, off), line, ev.Function(lambda t, q, qd: q[0] - off)]
    sol = pc.simulate(
        scene, q0=0.7, qd0=rate, t_span=(0, 3 * rate), events=watched, method=method, step=step
    )
    for found in sol.events:
        (one,) = found
        assert one.t == pytest.approx(back, rel=1e-9, abs=2e-15 / rate)
        assert one.direction == -1


@pytest.mark.parametrize("kind", KINDS)
def test_members_find_the_events_of_the_run_alone_from_an_event(kind: str) -> None:
    for again, _ in restarts(kind, "dopri5", 1, seeds=4):
        n = len(again.scene.links)
        (event,) = again.case().options["events"]
        y, t = again.y[:, 0], float(again.t[0])
        starts = np.array([y] * 4)
        starts[1:, 0] += 1e-3
        many = pc.ensemble(
            again.scene, q0=starts[:, :n], qd0=starts[:, n:], t_span=(t, t + 0.5), method="dopri5",
            keep=pc.reducers.FirstEvent(event), workers=1,
        )  # fmt: skip
        (found,) = again.events
        first = found[0].t if found else np.nan
        assert np.array_equal(many["first_event"][0], first, equal_nan=True)
