"""How times and states of events change: exact answers, differences of runs, and what has none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from slopes_of_runs import assert_slopes

E, V = pc.effects, pc.events
ROD = pc.Link(mass=1.0, length=1.0)
TEXTBOOK = pc.Scene.textbook()
BOTTOM = V.LinkAngle(1, np.pi / 2)
EXACTLY: Any = {"rtol": 1e-13, "atol": 1e-16}


def moved(
    scene: pc.Scene, span: Any, q0: Any, qd0: Any, names: Any, event: V.Event, **how: Any
) -> Any:
    """Return the times at which an event is found, and their derivatives."""
    how |= {"sensitivities": names, "events": [event]}
    sol = pc.simulate(scene, span, q0, qd0, **EXACTLY | how)
    (found,) = sol.event_sensitivities()
    times = sol.events[0].t
    assert found.t.shape == (len(times), len(names))
    assert found.y.shape == (len(times), 2 * len(scene.links), len(names))
    return times, found


# Exact answers ----------------------------------------------------------------------------------


@pytest.mark.parametrize("end", [3.0, -3.0])
def test_a_rod_let_go_at_rest(end: float) -> None:
    """Times go as (l/g)^(1/2), and at the bottom the rate is (3 g (1 - sin q0)/l)^(1/2)."""
    g, length, q0 = 9.807, 0.8, 0.2
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=length)], gravity=g)
    t, by = moved(scene, (0, end), q0, 0.0, ["gravity", "link[1].length", "q0[1]"], BOTTOM)
    assert len(t) > 1
    np.testing.assert_allclose(by.t[:, 0], -t / (2 * g), rtol=1e-10)
    np.testing.assert_allclose(by.t[:, 1], t / (2 * length), rtol=1e-10)
    rate = np.sign(end) * (-1.0) ** np.arange(len(t)) * np.sqrt(3 * g * (1 - np.sin(q0)) / length)
    right = [rate / (2 * g), -rate / (2 * length), -3 * g * np.cos(q0) / (2 * length * rate)]
    np.testing.assert_allclose(by.y[:, 1], np.transpose(right), rtol=1e-10)
    np.testing.assert_allclose(by.y[:, 0], 0, atol=1e-10)


def test_a_rod_turns_back_as_high_as_it_began() -> None:
    t, by = moved(pc.Scene(links=[ROD]), (0, 3), 0.3, 0.0, ["q0[1]", "gravity"], V.RateZero(link=1))
    assert len(t) > 2
    there_and_back = (-1.0) ** np.arange(1, len(t) + 1)
    np.testing.assert_allclose(by.y[:, 0, 0], there_and_back, rtol=1e-9)
    np.testing.assert_allclose(by.y[:, 0, 1], 0, atol=1e-10)
    np.testing.assert_allclose(by.y[:, 1], 0, atol=1e-10)
    np.testing.assert_allclose(by.t[:, 0], np.arange(1, len(t) + 1) * by.t[0, 0], rtol=1e-9)


def test_after_a_bounce() -> None:
    """At a constant rate w up to s, and then with -e w: t = (s - q0)/w + (s - a)/(e w)."""
    q0, w, s, e, a = 0.2, 3.0, 0.8, 0.6, 0.1
    stop = E.JointStop(joint=1, range=(-9, s), restitution=e)
    scene = pc.Scene(links=[ROD], gravity=0.0, effects=[stop])
    names = ["q0[1]", "qd0[1]", "effect[1].range.upper", "effect[1].restitution"]
    t, by = moved(scene, (0, 2), q0, w, names, V.JointAngle(1, a, direction=-1))
    assert t == pytest.approx([(s - q0) / w + (s - a) / (e * w)])
    right = [
        -1 / w,
        -(s - q0) / w**2 - (s - a) / (e * w**2),
        (1 + 1 / e) / w,
        -(s - a) / (e**2 * w),
    ]
    np.testing.assert_allclose(by.t, [right], rtol=1e-11)
    np.testing.assert_allclose(by.y, [[[0] * 4, [0, -e, 0, -w]]], rtol=0, atol=1e-11)


def test_a_tip_whose_pivot_moves_crosses_a_line() -> None:
    """A link that turns about its mass centre, at the pivot, keeps its rate whatever moves that."""
    A, omega, phase, length, q0, w, c = 0.3, 4.0, 0.7, 1.2, 0.1, 1.5, 0.9
    shaken = E.DrivenPivot(y=E.Sinusoid(amplitude=A, angular_frequency=omega, phase=phase))
    wheel = pc.Link(mass=1.0, length=length, center=0.0, inertia=0.0)
    scene = pc.Scene(links=[wheel], effects=[E.RotorInertia(joint=1, armature=0.2), shaken])
    names = ["q0[1]", "qd0[1]", "link[1].length", "gravity", "effect[1].armature"]
    names += [f"effect[2].y.{one}" for one in ("amplitude", "angular_frequency", "phase")]
    t, by = moved(scene, (0, 4), q0, w, names, V.TipLine(point=(5.0, c), normal=(0.0, -2.0)))
    assert len(t) > 1
    # 0 = A sin(omega t + phase) + l sin(q0 + w t) - c
    drive, q = omega * t + phase, q0 + w * t
    slope = A * omega * np.cos(drive) + length * w * np.cos(q)
    none = 0 * t
    by_names = [length * np.cos(q), length * t * np.cos(q), np.sin(q), none, none, np.sin(drive),
                A * t * np.cos(drive), A * np.cos(drive)]  # fmt: skip
    dt = -np.transpose(by_names) / slope[:, None]
    np.testing.assert_allclose(by.t, dt, rtol=1e-10, atol=1e-12)


# Differences of runs ----------------------------------------------------------------------------

FRICTION = E.DryJointFriction(joint=2, coulomb=8.0)
STICKING = E.DryJointFriction(joint=1, coulomb=4.0)
WEAK = E.DryJointFriction(joint=1, coulomb=0.5)
JUMPING = E.Motor(joint=1, table=E.Table(t=[0, 0.5, 3], torque=[0.0, 6.0, 6.0], hold=True))
STOP_OF_ROD = E.JointStop(joint=1, range=(-9, 1.2))
STOP = E.JointStop(joint=2, range=(-0.5, 0.8), restitution=0.4)
BACK_STOP = E.JointStop(joint=2, range=(-0.5, 0.8), restitution=1.0)
DRIVEN = [
    E.DrivenPivot(
        x=E.Sinusoid(amplitude=0.1, angular_frequency=3.0),
        y=E.Sinusoid(amplitude=0.2, angular_frequency=5.0),
    ),
    E.Motor(joint=1, sinusoid=E.Sinusoid(amplitude=2.0, angular_frequency=3.0)),
]
LINE = V.TipLine(point=(0.2, 0.4), normal=(1.0, 0.3))
OWN = V.Function(lambda t, q, qd: np.sin(3 * t) * qd[0] + q[1] - 0.5)
NAMES = ["q0[1]", "qd0[2]", "gravity", "link[2].length", "torque[1]"]
OF_THE_PIVOT = ["effect[1].x.amplitude", "effect[1].y.angular_frequency", "link[1].length"]
FORWARD, BACK = (0, 2.5), (2.5, 0)
COMPARED: dict[str, tuple[list[Any], Any, V.Event, list[str]]] = {
    "an angle of a joint": ([], FORWARD, V.JointAngle(2, 0.1), NAMES),
    "every turn of a link": ([], FORWARD, V.LinkAngle(2, 2.5 * np.pi, every_turn=True), NAMES),
    "a rate of a joint": ([], FORWARD, V.RateZero(joint=2), NAMES),
    "a rate of a link": ([], FORWARD, V.RateZero(link=2, direction=1), NAMES),
    "the tip": ([], FORWARD, LINE, NAMES),
    "a function": ([], FORWARD, OWN, NAMES),
    "the tip below a driven pivot": (DRIVEN, FORWARD, LINE, NAMES + OF_THE_PIVOT),
    "a rate below a driven pivot": (DRIVEN, FORWARD, V.RateZero(joint=2), NAMES + OF_THE_PIVOT),
    "the tip, back in time": (DRIVEN, BACK, LINE, NAMES + OF_THE_PIVOT),
    "a function, back in time": (DRIVEN, BACK, OWN, NAMES),
    "an angle between impacts": ([STOP], FORWARD, BOTTOM, [*NAMES, "effect[1].restitution"]),
    "the tip between impacts": ([STOP], FORWARD, LINE, [*NAMES, "effect[1].range.upper"]),
    "a turn while the other joint sticks": (
        [FRICTION], FORWARD, V.RateZero(link=1), ["q0[1]", "gravity", "effect[1].coulomb"],
    ),
    "the tip while the other joint sticks": (
        [FRICTION], FORWARD, LINE, ["q0[1]", "gravity", "link[1].length"],
    ),
    "a rate that impacts turn round, among others": (
        [STOP], FORWARD, V.RateZero(joint=2),
        [*NAMES, "effect[1].restitution", "effect[1].range.upper"],
    ),
    "a rate that impacts turn round, back in time": ([BACK_STOP], BACK, V.RateZero(joint=2), NAMES),
    "a function that impacts take beyond zero": (
        [STOP], FORWARD, V.Function(lambda t, q, qd: qd[1] - qd[0] + 0.2 * q[0]), NAMES,
    ),
    "the angle of a stop": (
        [STOP], (0, 5), V.JointAngle(2, -0.5), [*NAMES, "effect[1].restitution"],
    ),
    "a joint that comes to stick": (
        [STICKING], FORWARD, V.RateZero(joint=1), ["q0[1]", "gravity", "effect[1].coulomb"],
    ),
    "friction that turns round": (
        [WEAK], FORWARD, V.RateZero(joint=1), ["q0[1]", "qd0[2]", "effect[1].coulomb"],
    ),
    "the clock where a table jumps": (
        [JUMPING], FORWARD, V.Function(lambda t, q, qd: np.sin(2 * np.pi * t)), NAMES,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", COMPARED)
def test_derivatives_are_the_slopes_of_runs(case: str) -> None:
    effects, span, event, names = COMPARED[case]
    scene, start = TEXTBOOK.replace(effects=effects), [0.3, 0.6, 0.5, 0.0]
    t, by = moved(scene, span, start[:2], start[2:], names, event)
    assert len(t) > 1
    assert np.isfinite(by.t).all()

    def found(there: pc.Scene, y: list[float]) -> Any:
        run = pc.simulate(there, span, y[:2], y[2:], events=[event], **EXACTLY)
        return np.column_stack([run.events[0].t, run.events[0].y])

    told = np.concatenate([by.t[:, np.newaxis], by.y], axis=1)
    assert_slopes(told, found, scene, start, names)


# Where they are asked for -----------------------------------------------------------------------


def test_an_event_that_ends_the_run_and_one_that_does_not_come(tmp_path: Path) -> None:
    last = V.RateZero(link=1, terminal=2)
    events = [V.LinkAngle(1, 9.0), last, BOTTOM]
    sol = pc.simulate(TEXTBOOK, (0, 1e6), 0.5, sensitivities=["gravity", "q0[1]"], events=events)
    never, turns, bottom = sol.event_sensitivities()
    assert sol.status == "event"
    assert never.t.shape == (0, 2)
    assert never.y.shape == (0, 4, 2)
    np.testing.assert_allclose(turns.t[:, 0], -sol.events[1].t / (2 * 9.807), rtol=1e-6)
    assert bottom.t.shape == (len(sol.events[2]), 2)
    sol.save(tmp_path / "run.npz")
    again = pc.load(tmp_path / "run.npz").event_sensitivities()
    np.testing.assert_array_equal(again[1].y, turns.y)


# Where there is none ----------------------------------------------------------------------------

BENT = E.Motor(joint=1, table=E.Table(t=[0, 0.5, 3], torque=[0.0, 6.0, 0.0]))


@pytest.mark.parametrize("span", [(0, 1), (1, 0)], ids=["forward", "back"])
@pytest.mark.parametrize("terminal", [False, True])
@pytest.mark.parametrize("effect", [JUMPING, BENT], ids=["jump", "bend"])
def test_a_time_at_which_a_law_changes_stays(effect: E.Motor, terminal: bool, span: Any) -> None:
    clock = V.Function(lambda t, q, qd: t - 0.5, terminal=terminal)
    scene = pc.Scene(links=[ROD], effects=[effect])
    t, by = moved(scene, span, 0.3, 0.0, ["q0[1]"], clock)
    assert t == pytest.approx([0.5], abs=1e-14)
    there = pc.simulate(scene, (span[0], 0.5), 0.3, sensitivities=["q0[1]"], store="end", **EXACTLY)
    np.testing.assert_allclose(by.t, 0, atol=1e-10)
    np.testing.assert_allclose(by.y[0], there.sensitivities[-1], rtol=1e-9)


@pytest.mark.parametrize("terminal", [False, True])
def test_an_impact_turns_a_rod_round(terminal: bool) -> None:
    """At a constant rate w to the stop s: t = (s - q0)/w."""
    q0, w, s, restitution = 0.2, 3.0, 0.8, 0.5
    stop = E.JointStop(joint=1, range=(-9, s), restitution=restitution)
    scene = pc.Scene(links=[ROD], gravity=0.0, effects=[stop])
    names = ["q0[1]", "qd0[1]", "effect[1].range.upper", "effect[1].restitution"]
    t, by = moved(scene, (0, 1), q0, w, names, V.RateZero(link=1, terminal=terminal))
    assert t == pytest.approx([(s - q0) / w])
    np.testing.assert_allclose(by.t, [[-1 / w, -(s - q0) / w**2, 1 / w, 0]], rtol=1e-9, atol=1e-9)
    after = [[0, 0, 1, 0], [0, -restitution, 0, -w]]
    np.testing.assert_allclose(by.y, [after], rtol=0, atol=1e-9)


def test_an_angle_that_is_reached_just_when_a_table_jumps_or_at_a_stop() -> None:
    """Its time has a derivative, except by a name that moves it away from the stop."""
    (t,), alone = moved(pc.Scene(links=[ROD]), (0, 1), 0.5, 0.0, ["gravity"], BOTTOM)
    table = E.Table(t=[0, t, 3], torque=[0.0, 6.0, 6.0], hold=True)
    scene = pc.Scene(links=[ROD], effects=[E.Motor(joint=1, table=table)])
    _, by = moved(scene, (0, 1), 0.5, 0.0, ["gravity", "q0[1]"], BOTTOM)
    np.testing.assert_allclose(by.t[:, :1], alone.t, rtol=1e-9)
    np.testing.assert_allclose(by.y[0, 0], 0, atol=1e-9)
    assert np.isnan(by.y[0, 1]).all()
    scene = pc.Scene(links=[ROD], effects=[STOP_OF_ROD])
    names = ["q0[1]", "effect[1].range.upper", "gravity"]
    _, by = moved(scene, (0, 1), 0.5, 0.0, names, V.LinkAngle(1, 1.2))
    np.testing.assert_array_equal(np.isnan(by.t[0]), [False, True, False])
    np.testing.assert_array_equal(np.isnan(by.y[0, 0]), [False, True, False])


def test_an_angle_that_is_reached_just_when_a_joint_comes_to_stick() -> None:
    """Rates are the same on both sides, so that its time has a derivative."""
    rubs = E.DryJointFriction(joint=2, coulomb=1.2, static=2.0)
    scene, start = TEXTBOOK.replace(effects=[rubs]), ([0.3, 0.5], [0.0, 4.0])
    sticks = pc.simulate(scene, (0, 1), *start, events=[V.RateZero(joint=2)], **EXACTLY).events[0]
    event = V.LinkAngle(1, float(sticks[0].q[0]))
    _, by = moved(scene, (0, 1), *start, ["q0[1]", "effect[1].coulomb"], event)
    assert by.t[0, 0] == pytest.approx(-0.50006, rel=1e-4)
    np.testing.assert_allclose(by.y[0, :2, 0], [0, -0.9754], rtol=0, atol=1e-4)
    assert np.isfinite(by.t[0]).all()
    assert np.isnan(by.y[0, 2:]).all()


@pytest.mark.parametrize("rtol", [1e-9, 1e-10, 1e-11, 1e-12])
def test_an_impact_that_ends_a_run_after_which_steps_are_rejected(rtol: float) -> None:
    drag = E.RodDrag(2, 1.2, 1.97, air_density=3.0, wind=(0.2, 2.4))
    stop = E.JointStop(joint=1, range=(-0.5, 1.9), restitution=0.9)
    links = [pc.Link(mass=0.73, length=0.77), pc.Link(mass=0.47, length=0.19)]
    scene = pc.Scene(links=links, effects=[stop, drag])
    found = []
    for terminal in (False, True):
        how: Any = {"rtol": rtol, "sensitivities": ["q0[1]"]}
        turn = V.RateZero(joint=1, terminal=terminal)
        sol = pc.simulate(scene, (0, 2), [-0.08, -0.29], [2.28, -0.27], events=[turn], **how)
        found.append(sol.event_sensitivities()[0].t[0, 0])
    np.testing.assert_allclose(found, -0.10362814, rtol=1e-6)


@pytest.mark.parametrize("coulomb", [1e-6, 4e-6, 1e-5, 1e-4])
def test_a_joint_that_hardly_rubs_turns_as_if_it_did_not(coulomb: float) -> None:
    free = pc.simulate(TEXTBOOK, (0, 3), [0.3, 0.6], [0.5, 0.0], sensitivities=["q0[1]"],
                       events=[V.RateZero(joint=1)], **EXACTLY).event_sensitivities()  # fmt: skip
    scene = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=1, coulomb=coulomb)])
    how: Any = EXACTLY | {"sensitivities": ["q0[1]"], "events": [V.RateZero(joint=1)]}
    rubbed = pc.simulate(scene, (0, 3), [0.3, 0.6], [0.5, 0.0], **how).event_sensitivities()
    np.testing.assert_allclose(rubbed[0].t, free[0].t, rtol=2 * coulomb)


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_rod_that_comes_to_rest_at_its_stop_turns_at_each_impact(restitution: float) -> None:
    """All times go as g^(-1/2). What is 1e-7 s before the last bounce may be at rest already."""
    stop = E.JointStop(joint=1, range=(-9, 1.2), restitution=restitution)
    turn = V.RateZero(link=1)
    t, by = moved(pc.Scene(links=[ROD], effects=[stop]), (0, 3), 0.5, 0.0, ["gravity"], turn)
    assert len(t) > (10 if restitution else 0)
    early = t < t[-1] - 1e-7 if restitution else t > 0
    np.testing.assert_allclose(by.t[early, 0], -t[early] / (2 * 9.807), rtol=1e-6)
    np.testing.assert_allclose(by.y[early, 0], 0, atol=1e-6)


def test_a_touch_has_none() -> None:
    """The angle is (t - 1)^2; above it, a line is crossed once on each side."""
    push = E.Motor(joint=1, constant=2 / 3)
    scene = pc.Scene(links=[ROD], gravity=0.0, effects=[push])
    at_zero, loose = V.LinkAngle(1, 0.0), {"method": "dop853", "rtol": 1e-9, "atol": 1e-12}
    t, by = moved(scene, (0, 2), 1.0, -2.0, ["q0[1]"], at_zero, **loose)
    assert t == pytest.approx([1])
    assert np.isnan(by.t).all()
    assert np.isnan(by.y).all()
    t, by = moved(scene, (0, 2), 1.0, -2.0, ["q0[1]"], V.LinkAngle(1, 0.25))
    assert t == pytest.approx([0.5, 1.5])
    np.testing.assert_allclose(by.t[:, 0], [1, -1], rtol=1e-10)


def test_only_a_run_with_events_has_their_derivatives() -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), 0.5, sensitivities=["q0[1]"])
    with pytest.raises(ValueError, match="the run looked for no events: simulate"):
        sol.event_sensitivities()
