"""Where the state jumps or stays (impacts, bounces, stick), events tell both states, once each."""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import rod as unit_rod

J = 1 / 3


def rod(*effects: Any, gravity: float = 0.0) -> pc.Scene:
    return pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], gravity=gravity, effects=list(effects))


BOUNCING = rod(
    fx.Motor(joint=1, constant=-1.0), fx.JointStop(joint=1, range=(0.0, 3.0), restitution=0.5)
)
FIRST = np.sqrt(2 * 0.4 * J)  # the rod falls from 0.4 with -1/J
RATE = FIRST / J


@pytest.mark.parametrize("store", ["steps", "dense"])
def test_an_impact_turns_the_rate_at_once_and_both_states_are_told(store: str) -> None:
    turn = ev.RateZero(joint=1, direction=1)
    sol = pc.simulate(BOUNCING, q0=0.4, t_span=(0, 0.9), events=[turn], store=store)
    first = sol.events[0][0]
    assert first.t == pytest.approx(FIRST, rel=1e-12)
    np.testing.assert_allclose(first.y_before, [0.0, -RATE], atol=1e-12)
    np.testing.assert_allclose(first.y_after, [0.0, RATE / 2], atol=1e-12)
    np.testing.assert_array_equal(first.y, first.y_after)
    twice = np.flatnonzero(np.diff(sol.t) == 0.0)
    assert sol.t[twice[0]] == first.t
    np.testing.assert_array_equal(sol.y[:, twice[0]], first.y_before)
    np.testing.assert_array_equal(sol.y[:, twice[0] + 1], first.y_after)
    if store == "dense":
        np.testing.assert_array_equal(sol(first.t), first.y_after)


def test_the_angle_touches_its_stop_once_an_impact() -> None:
    touch = ev.JointAngle(joint=1, value=0.0)
    sol = pc.simulate(BOUNCING, q0=0.4, t_span=(0, 1.2), events=[touch])
    times = [found.t for found in sol.events[0]]
    flights = FIRST + 2 * FIRST * np.cumsum([0.0, 0.5, 0.25])
    assert times[:3] == pytest.approx(flights[flights < 1.2], rel=1e-11)
    assert len(times) == len(set(times))


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("joint", [2, 3])
def test_a_mark_at_the_very_angle_of_a_stop_is_met_once_an_impact(
    joint: int, e: float, method: str
) -> None:
    """The angle of such a joint is a difference, and its last bits are not the stop's."""
    impacts = 0
    for k in range(12):
        bound = 0.3 + 0.07 * k
        scene = pc.Scene(
            links=[pc.Link(mass=1.0, length=0.6)] * joint,
            effects=[fx.JointStop(joint=joint, range=(-bound, bound), restitution=e)],
        )
        marks = [ev.JointAngle(joint, side * bound, direction=side) for side in (1, -1)]
        rates = [0.0] * (joint - 1) + [3.0]
        sol = pc.simulate(
            scene,
            q0=[0.3] * joint,
            qd0=rates,
            t_span=(0, 2),
            events=marks,
            method=method,
            rtol=1e-8,
        )
        found = sorted((one.t, one.direction) for some in sol.events for one in some)
        struck = np.flatnonzero(np.diff(sol.t) == 0)
        turned = sol.q[struck, joint - 1] - sol.q[struck, joint - 2]
        assert found == [*zip(sol.t[struck], np.sign(turned), strict=True)], f"bound {bound}"
        for some in sol.events:
            for one in some:
                assert one.y_before is not None
                assert (one.y_before[joint:] != one.y_after[joint:]).any()
        impacts += len(struck)
    assert impacts > 12


def test_a_terminal_event_at_an_impact_ends_there_and_goes_on_after_it() -> None:
    end = ev.RateZero(joint=1, direction=1, terminal=True)
    sol = pc.simulate(BOUNCING, q0=0.4, t_span=(0, 1.2), events=[end])
    assert sol.status == "event"
    assert sol.t[-1] == pytest.approx(FIRST, rel=1e-12)
    whole = pc.simulate(BOUNCING, q0=0.4, t_span=(0, 1.2))
    longer = sol
    for _ in range(100):
        if longer.status != "event":
            break
        longer = longer.resume(1.2)
    assert longer.status == whole.status
    np.testing.assert_array_equal(longer.t, whole.t)
    np.testing.assert_array_equal(longer.y, whole.y)


@pytest.mark.parametrize("apart", [1e-10, -1e-10])
def test_a_run_cut_between_two_impacts_at_one_time_finds_what_the_whole_one_does(
    apart: float, fine: Any
) -> None:
    """Both stops are reached within the last bits of t = 1e6 s, so at one time, blow by blow."""
    t0, start, rates = 1e6, [0.3, 0.9], [1.0, 4.0]
    free = unit_rod(links=2)
    (q1, q2), _ = np.split(
        pc.simulate(free, q0=start, qd0=rates, t_span=(0, 0.05), **fine).y[:, -1], 2
    )
    bounds = [q1, q2 - q1 + apart]
    stops = [
        fx.JointStop(joint=j, range=(-np.inf, bound), restitution=0.5)
        for j, bound in enumerate(bounds, start=1)
    ]
    watched = [
        *(ev.JointAngle(joint=j, value=bound) for j, bound in enumerate(bounds, start=1)),
        *(ev.RateZero(joint=j) for j in (1, 2)),
        ev.Function(lambda t, q, qd: float(q1 + 1e-3 * qd[0] - q[0] - 1e-3)),
    ]

    def run(t_end: float = t0 + 0.1, **how: Any) -> pc.Solution:
        scene = free.replace(effects=stops)
        return pc.simulate(
            scene, q0=start, qd0=rates, t_span=(t0, t_end), events=watched, **fine, **how
        )

    def told(sol: pc.Solution) -> list[Any]:
        return [
            (k, one.t, one.direction, *(y.tolist() for y in (one.y_before, one.y_after)))
            for k, some in enumerate(sol.events)
            for one in some
            if one.y_before is not None
        ]

    whole = run()
    struck = whole.t[:-1][np.diff(whole.t) == 0]
    assert len(struck) > len(set(struck)) == 1
    cut = [run(float(struck[0]))]
    while not cut[1:] or cut[-1].status == "max_steps":
        cut.append(run(max_steps=len(cut), on_failure="ignore"))
    between = [sol for sol in cut if np.count_nonzero(sol.t == struck[0]) == 2]
    assert between
    for sol in cut:
        longer = sol.resume(t0 + 0.1, max_steps=10_000)
        np.testing.assert_array_equal(longer.y, whole.y)
        assert told(longer) == told(whole)


@pytest.mark.parametrize("rtol", [1e-5, 1e-8, 1e-11, 1e-12])
def test_entering_stick_is_one_rate_zero_in_a_run_that_goes_on(rtol: float, method: str) -> None:
    """Under sin(t), with friction 0.5, the rod slides up from asin 0.5, sticks, slides down ..."""
    scene = rod(
        fx.DryJointFriction(joint=1, coulomb=0.5),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=1.0, angular_frequency=1.0)),
    )
    zero = ev.RateZero(joint=1)
    sol = pc.simulate(scene, q0=0.0, t_span=(0, 20), events=[zero], method=method, rtol=rtol)
    stops = sol.t[1:][(sol.qd[1:, 0] == 0.0) & (sol.qd[:-1, 0] != 0.0)]
    assert len(stops) >= 5
    assert [found.t for found in sol.events[0]] == [*stops]
    for found in sol.events[0]:
        assert found.qd[0] == 0.0


def test_leaving_a_contact_is_no_rate_zero_and_coming_into_it_is_one(fine: Any) -> None:
    """A rod of inertia 1 under -(sin t + 0.2) leaves a plastic stop where sin t = -0.2."""
    push = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=-1.0, angular_frequency=1.0))
    stop = fx.JointStop(joint=1, range=(0.0, np.inf))
    scene = unit_rod(push, fx.Motor(joint=1, constant=-0.2), stop)
    watched = [ev.RateZero(joint=1), ev.JointAngle(joint=1, value=0.0)]
    off = np.pi + np.arcsin(0.2)

    def rate(t: Any) -> Any:
        return mpmath.cos(t) - mpmath.cos(off) - 0.2 * (t - off)

    turns = [float(mpmath.findroot(rate, near)) for near in (7.9, 11.8, 12.9)]
    back = float(mpmath.findroot(lambda t: mpmath.quad(rate, [off, t]), 14.2))
    sol = pc.simulate(scene, q0=0.0, t_span=(0, 20), events=watched, **fine)
    assert sol.qd[-1, 0] > 0.1  # the rod left again, one turn of the push after the first time
    rests, touches = sol.events
    assert [found.t for found in rests] == pytest.approx([*turns, back], abs=1e-10)
    assert [found.direction for found in rests] == [-1, 1, -1, 1]
    assert [found.t for found in touches] == [rests[-1].t]
    assert touches[0].y_after.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("held_by", ["a stop", "friction"])
@pytest.mark.parametrize("joint", [1, 2])
def test_what_is_let_go_sets_out_one_way_at_ordinary_tolerances_too(
    joint: int, held_by: str, method: str
) -> None:
    """A fine run says how often the joint turns; a mark at its stop is met once per impact."""
    middle = np.pi / 2 if joint == 1 else 0.0
    for bound in np.linspace(0.1, 0.9, 9):
        ends = (middle - bound, middle + bound)
        hold: Any = fx.JointStop(joint=joint, range=ends)
        if held_by == "friction":
            hold = fx.DryJointFriction(joint=joint, coulomb=4.0 + 2.0 * bound)
        hum = fx.Sinusoid(amplitude=20.0, angular_frequency=2.0)
        scene = unit_rod(hold, fx.Motor(joint=1, sinusoid=hum), gravity=9.81, links=2)
        watched = [ev.RateZero(joint=joint), *(ev.JointAngle(joint=joint, value=x) for x in ends)]

        def run(rtol: float, scene: Any = scene, watched: Any = watched) -> pc.Solution:
            return pc.simulate(
                scene, q0=np.pi / 2, t_span=(0, 2), events=watched, method=method, rtol=rtol
            )

        exact = [one.t for one in run(1e-12).events[0]]
        for rtol in (1e-5, 1e-6, 1e-8):
            sol = run(rtol)
            assert len(sol.events[0]) == len(exact), f"bound {bound}, rtol {rtol}"
            if held_by == "a stop":
                struck = sol.t[:-1][np.diff(sol.t) == 0]
                met = sorted(one.t for some in sol.events[1:] for one in some)
                assert met == [*struck], f"bound {bound}, rtol {rtol}"


def test_watching_changes_no_bit_of_a_run_with_impacts_and_stick() -> None:
    scene = pc.Scene(
        links=[pc.Link(mass=1.0, length=1.0)] * 2,
        effects=[
            fx.JointStop(joint=2, range=(-0.4, 0.5), restitution=0.7),
            fx.DryJointFriction(joint=1, coulomb=0.4, static=0.7),
        ],
    )
    watched = pc.simulate(
        scene, q0=[0.3, 0.2], t_span=(0, 6),
        events=[
            ev.RateZero(joint=2),
            ev.LinkAngle(link=2, value=1.2),
            ev.TipLine(point=(0.3, 1.0), normal=(1.0, 0.2)),
            ev.Function(lambda t, q, qd: float(qd[0] - 0.1)),
        ],
    )  # fmt: skip
    alone = pc.simulate(scene, q0=[0.3, 0.2], t_span=(0, 6))
    np.testing.assert_array_equal(watched.t, alone.t)
    np.testing.assert_array_equal(watched.y, alone.y)
    assert watched.stats == alone.stats
    assert all(len(found) > 0 for found in watched.events)


def test_an_impact_that_changes_no_rate_is_no_jump() -> None:
    """The pivot's accelerations are beyond doubles, so no impulse is found and the rate stays."""
    shaken = fx.DrivenPivot(y=fx.Sinusoid(amplitude=1e200, angular_frequency=1e120))
    scene = rod(fx.JointStop(joint=1, range=(0.7, 2.5)), shaken)
    sol = pc.simulate(scene, q0=0.7, qd0=-4.0, t_span=(0, 1), max_steps=1, on_failure="ignore")
    assert [*sol.t] == [0.0]
    np.testing.assert_array_equal(sol.y[:, 0], [0.7, -4.0])


class Broken(Exception):
    pass


def test_a_function_that_raises_at_an_impact_at_the_start_leaves_a_run_that_goes_on() -> None:
    is_broken = True

    def f(t: float, q: Any, qd: Any) -> float:
        if is_broken:
            raise Broken
        return float(qd[0])

    watched = {"t_span": (0, 0.9), "events": [ev.RateZero(joint=1), ev.Function(f)]}
    with pytest.raises(Broken) as caught:
        pc.simulate(BOUNCING, q0=0.0, qd0=-1.0, **watched)
    sol = caught.value.solution  # type: ignore[attr-defined]
    assert sol.status == "callback_error"
    np.testing.assert_array_equal(sol.y, [[0.0], [-1.0]])
    is_broken = False
    longer, whole = sol.resume(0.9), pc.simulate(BOUNCING, q0=0.0, qd0=-1.0, **watched)
    np.testing.assert_array_equal(longer.t, whole.t)
    np.testing.assert_array_equal(longer.y, whole.y)
    for one, other in zip(longer.events, whole.events, strict=True):
        assert [found.t for found in one] == [found.t for found in other]
        assert one[0].t == 0.0


def test_a_jump_over_more_turns_than_an_int_holds_ends_the_run_in_words() -> None:
    """A lock may move its joint by 1e-9 of its angle at the start: here by 1.4e10 turns."""
    scene = pc.Scene(
        links=[pc.Link(mass=1.0, length=1.0)] * 3,
        effects=[fx.Lock(joint=1, angle=1e20), fx.JointStop(joint=3, range=(0.0, 1.0))],
    )
    turns = ev.JointAngle(joint=1, value=0.0, every_turn=True)
    start = [1.0000000009e20, 0.0, 0.0]
    sol = pc.simulate(
        scene, q0=start, qd0=[0.0, 0.0, -1.0], t_span=(0, 1), events=[turns], on_failure="ignore"
    )
    assert sol.status == "max_turns"
    assert not sol.events[0]
