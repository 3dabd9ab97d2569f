"""How the least and greatest angles and rates of a run change: exact answers, slopes of runs."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from derivatives.hybrid_runs import drawn

E, V = pc.effects, pc.events
G, LENGTH = 9.807, 0.8
ROD = pc.Scene(links=[pc.Link(mass=1.0, length=LENGTH)], gravity=G)
WEIGHTLESS = ROD.replace(gravity=0.0)
TEXTBOOK = pc.Scene.textbook()
EXACTLY: Any = {"rtol": 1e-13, "atol": 1e-16}
LEAST, GREATEST, ANGLE, RATE = 0, 1, 0, 1


def extremes(scene: pc.Scene, span: Any, q0: Any, qd0: Any, names: Any, **how: Any) -> Any:
    sol = pc.simulate(scene, span, q0, qd0, sensitivities=names, **EXACTLY | how)
    found, n = sol.extreme_sensitivities(), len(scene.links)
    assert found.values.shape == found.t.shape == (2, 2 * n)
    assert found.sensitivities.shape == (2, 2 * n, len(names))
    return found


def fall(q0: float, until: float) -> tuple[float, list[float]]:
    """Return the rate of a rod from rest, and its derivatives: by gravity, length, q0, until.

    Its square is 3 g (sin until - sin q0)/l.
    """
    height = np.sin(until) - np.sin(q0)
    rate = np.sqrt(3 * G * height / LENGTH)
    slope = 3 * G / (2 * LENGTH * rate)
    by = [rate / (2 * G), -rate / (2 * LENGTH), -slope * np.cos(q0), slope * np.cos(until)]
    return rate, by


# Exact answers ----------------------------------------------------------------------------------

NAMES = ["gravity", "link[1].length", "q0[1]"]


@pytest.mark.parametrize("end", [3.0, -3.0])
@pytest.mark.parametrize("store", ["dense", "end"])
def test_a_rod_let_go_at_rest(end: float, store: str) -> None:
    """From rest to as high on the other side, and fastest at the bottom, both ways."""
    q0 = 0.2
    found = extremes(ROD, (0, end), q0, 0.0, NAMES, store=store)
    rate, by = fall(q0, np.pi / 2)
    np.testing.assert_allclose(found.values, [[q0, -rate], [np.pi - q0, rate]], rtol=1e-12)
    right = [[[0, 0, 1], np.negative(by[:3])], [[0, 0, -1], by[:3]]]
    np.testing.assert_allclose(found.sensitivities, right, rtol=0, atol=1e-9)
    angle = pc.simulate(ROD, (0, end), q0, **EXACTLY)(found.t[:, RATE])[0]
    np.testing.assert_allclose(angle, np.pi / 2, atol=1e-10)


STOPPED: dict[str, tuple[float, float, float, list[Any]]] = {
    "it falls on the stop": (0.2, 0.6, 0.6, []),
    "it comes back from the stop in time": (0.2, 1.0, -0.6, []),
    "an event at the impact ends the run": (0.2, 0.6, 9.0, [V.LinkAngle(1, 1.1, terminal=True)]),
    **{f"it stays at the stop, from {q0}": (q0, 0.0, 2.0, []) for q0 in np.linspace(0.1, 0.9, 9)},
}
"""From where, with which restitution, up to which time, and with which events."""


@pytest.mark.parametrize("name", STOPPED)
def test_a_rod_is_fastest_just_before_and_just_after_it_strikes_its_stop(name: str) -> None:
    """And it is farthest at the stop, wherever that is."""
    q0, e, end, events = STOPPED[name]
    scene = ROD.replace(effects=[E.JointStop(joint=1, range=(-9, 1.1), restitution=e)])
    names = [*NAMES, "effect[1].range.upper"]
    if 0 < e < 1:
        names.append("effect[1].restitution")
    found = extremes(scene, (0, end), q0, 0.0, names, events=events)
    rate, by = fall(q0, 1.1)
    at_stop, before, after = [0, 0, 0, 1, 0], [*by, 0], [*np.multiply(by, -e), -rate]
    right = np.array([at_stop, before, after])[:, : len(names)]
    np.testing.assert_allclose(found.sensitivities[GREATEST], right[:2], rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.sensitivities[LEAST, RATE], right[2], rtol=0, atol=1e-9)
    at_start = [0, 0, 1, 0, 0][: len(names)]
    np.testing.assert_allclose(found.sensitivities[LEAST, ANGLE], at_start, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.values[:, RATE], [-e * rate, rate], rtol=1e-12)
    assert (found.t[LEAST, RATE] == found.t[GREATEST, RATE]) == (e > 0)


def test_a_step_of_few_bits_before_an_impact() -> None:
    """A table cuts a step just before the rod strikes the stop, where its rate is greatest."""
    stop = E.JointStop(joint=1, range=(-9, 1.1), restitution=0.6)
    hit = extremes(ROD.replace(effects=[stop]), (0, 0.6), 0.2, 0.0, NAMES).t[GREATEST, RATE]
    nothing = E.Motor(joint=1, table=E.Table(t=[0, hit - 2e-15, 2], torque=[0, 0, 0]))
    scene = ROD.replace(effects=[stop, nothing])
    steps = pc.simulate(scene, (0, 0.6), 0.2, **EXACTLY).step_starts
    assert 0 < np.diff(steps).min() < 1e-14
    with pytest.warns(pc.PendcoreWarning, match="two of its laws change at that time"):
        found = extremes(scene, (0, 0.6), 0.2, 0.0, NAMES)
    rate, _ = fall(0.2, 1.1)
    np.testing.assert_allclose(found.values[:, RATE], [-0.6 * rate, rate], rtol=1e-12)
    assert np.isnan(found.sensitivities[:, RATE]).all()


def test_a_rod_that_slides_to_rest() -> None:
    """It comes to q0 + I w^2 / (2 t_c), and its rate to 0."""
    q0, w, friction, inertia = 0.1, 3.0, 0.7, LENGTH**2 / 3
    scene = WEIGHTLESS.replace(effects=[E.DryJointFriction(joint=1, coulomb=friction)])
    found = extremes(scene, (0, 3), q0, w, ["q0[1]", "qd0[1]", "effect[1].coulomb"])
    far = [1, inertia * w / friction, -inertia * w**2 / (2 * friction**2)]
    np.testing.assert_allclose(found.sensitivities[GREATEST, ANGLE], far, rtol=1e-9)
    np.testing.assert_allclose(found.sensitivities[LEAST, ANGLE], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(found.sensitivities[LEAST, RATE], 0, atol=1e-9)
    np.testing.assert_allclose(found.sensitivities[GREATEST, RATE], [0, 1, 0], atol=1e-12)


def test_a_rate_that_turns_round_where_a_table_jumps() -> None:
    """It grows with a table's torque, and then falls; the time of the jump is fixed."""
    inertia = LENGTH**2 / 3
    push = E.Motor(joint=1, table=E.Table(t=[0, 0.5, 2], torque=[0.3, -0.2, -0.2], hold=True))
    scene = WEIGHTLESS.replace(effects=[push])
    found = extremes(scene, (0, 1), 0.0, 1.0, ["qd0[1]", "torque[1]", "q0[1]"])
    assert found.t[GREATEST, RATE] == 0.5
    np.testing.assert_allclose(found.values[GREATEST, RATE], 1 + 0.15 / inertia, rtol=1e-12)
    np.testing.assert_allclose(
        found.sensitivities[GREATEST, RATE], [1, 0.5 / inertia, 0], rtol=0, atol=1e-9
    )


def test_the_end_of_a_run_is_fixed_unless_an_event_ended_it() -> None:
    q0, until = 0.2, 1.0
    event = V.LinkAngle(1, until, terminal=True)
    found = extremes(ROD, (0, 9), q0, 0.0, NAMES, events=[V.LinkAngle(1, 0.5), event])
    rate, by = fall(q0, until)
    np.testing.assert_allclose(found.values[GREATEST], [until, rate], rtol=1e-12)
    np.testing.assert_allclose(found.sensitivities[GREATEST], [[0] * 3, by[:3]], atol=1e-9)
    fixed = pc.simulate(ROD, (0, 0.3), q0, sensitivities=NAMES, **EXACTLY)
    np.testing.assert_array_equal(
        fixed.extreme_sensitivities().sensitivities[GREATEST], fixed.sensitivities[-1]
    )


# Several places ---------------------------------------------------------------------------------


def test_places_that_tie_have_a_derivative_where_all_have_the_same() -> None:
    """A rod goes back and forth at a constant rate, which each impact multiplies by e = 1."""
    stop = E.JointStop(joint=1, range=(0.0, 1.0), restitution=1.0)
    scene = WEIGHTLESS.replace(effects=[stop])
    names = ["qd0[1]", "effect[1].restitution", "effect[1].range.lower", "effect[1].range.upper"]
    found = extremes(scene, (0, 2), 0.5, 2.0, names)
    right = [[[0, 0, 1, 0], [-1, np.nan, 0, 0]], [[0, 0, 0, 1], [1, np.nan, 0, 0]]]
    np.testing.assert_allclose(found.sensitivities, right, rtol=0, atol=1e-9)


def test_what_has_no_derivative_is_not_a_number() -> None:
    """After a stop is grazed there is none: a rate was extreme before that, or after it."""
    grazed = E.JointStop(joint=1, range=(-9, np.pi - 0.5), restitution=0.5)
    scene = ROD.replace(effects=[grazed])
    with pytest.warns(pc.PendcoreWarning, match="sensitivities: none after"):
        found = extremes(scene, (0, 1.5), 0.5, 0.0, ["q0[1]"])
    assert np.isfinite(found.sensitivities[GREATEST, RATE]).all()
    assert np.isnan(found.sensitivities[LEAST, RATE]).all()


# Slopes of runs ---------------------------------------------------------------------------------


def slopes_of_runs(seed: int) -> Any:
    """Return the derivatives of the extremes along all changes of a drawn case, and slopes."""
    case = drawn(seed)
    n, names = len(case.q0), list(case.changes)
    known = case.scene.parameters()
    found = extremes(case.scene, (0, case.t_end), case.q0, case.qd0, names)

    def changed(by: float) -> Any:
        y, values = [*case.q0, *case.qd0], {}
        for name, change in case.changes.items():
            if name in known:
                values[name] = known[name] + by * change
            else:
                y[int(name[-2]) - 1 + n * name.startswith("qd")] += by * change
        scene = case.scene.with_parameters(values)
        how: Any = {"keep": pc.reducers.Extremes(), **EXACTLY}
        members = pc.ensemble(scene, (0, case.t_end), [y[:n]], [y[n:]], **how)
        return members["extremes"][0]

    np.testing.assert_allclose(found.values, changed(0.0), rtol=1e-11, atol=1e-11)
    coarse, fine = ((changed(h) - changed(-h)) / (2 * h) for h in (4e-5, 2e-5))
    return found.sensitivities @ [*case.changes.values()], (4 * fine - coarse) / 3


CORNERS = (52, 68, 87, 195)
"""Rates that are extreme where a joint comes to stick."""
IMPACTS = (1, 5, 8, 40)


@pytest.mark.parametrize("seed", [*CORNERS, *IMPACTS])
def test_derivatives_are_the_slopes_of_random_runs(seed: int) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        found, slopes = slopes_of_runs(seed)
    assert np.isfinite(found).all()
    size = max(1.0, np.abs(slopes).max())
    np.testing.assert_allclose(found, slopes, rtol=0, atol=1e-7 * size)


# Where they are asked for -----------------------------------------------------------------------


@pytest.mark.parametrize("how", [{"t_span": (1, 1)}, {"max_steps": 1, "first_step": 1.0}], ids=str)
def test_a_run_of_one_state(how: dict[str, Any]) -> None:
    how = {"t_span": (1, 3), **how}
    sol = pc.simulate(
        TEXTBOOK, q0=[0.5, 1], qd0=2.0, sensitivities=["q0[2]"], on_failure="ignore", **how
    )
    found = sol.extreme_sensitivities()
    np.testing.assert_array_equal(found.values, [[0.5, 1, 2, 2]] * 2)
    np.testing.assert_array_equal(found.t, 1.0)
    np.testing.assert_array_equal(found.sensitivities[..., 0], [[0, 1, 0, 0]] * 2)
