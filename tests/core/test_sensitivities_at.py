"""Derivatives at any time of a run: the bits of those it kept, however it was run and ended."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore.methods import known_methods

E, V = pc.effects, pc.events
ROD = pc.Link(mass=1.0, length=1.0)
TEXTBOOK = pc.Scene.textbook()
STOP = E.JointStop(joint=1, range=(-9, 1.2), restitution=0.5)
ROD_ALONE = pc.Scene(links=[ROD], gravity=0.0)
BOUNCING = pc.Scene(links=[ROD], effects=[STOP])
RUBBING = pc.Scene(links=[ROD], effects=[E.DryJointFriction(joint=1, coulomb=2.0)])
DRAGGED = TEXTBOOK.replace(
    effects=[E.RodDrag(link=1, drag_coefficient=1.2, diameter=0.05)]  # has no Taylor series
)
NAMES = ["q0[1]", "gravity", "link[1].length"]


def test_a_rod_that_turns_freely() -> None:
    """The angle is q0 + w t, at times in any order."""
    sol = pc.simulate(pc.Scene(links=[ROD], gravity=0.0), (1, 4), 0.2, 3.0,
                      sensitivities=["qd0[1]", "q0[1]"])  # fmt: skip
    times = np.array([2.5, 4.0, 1.0, 2.5, 1.7])
    found = sol.sensitivities_at(times)
    assert found.shape == (5, 2, 2)
    np.testing.assert_allclose(found[:, 0], np.stack([times - 1, np.ones(5)], axis=1), rtol=1e-13)
    np.testing.assert_array_equal(found[:, 1], np.tile([1.0, 0.0], (5, 1)))
    np.testing.assert_array_equal(found[0], found[3])
    np.testing.assert_array_equal(sol.sensitivities_at(1.7), found[4])
    assert sol.sensitivities_at([]).shape == (0, 2, 2)


@pytest.mark.parametrize("method", known_methods())
@pytest.mark.parametrize("scene", [TEXTBOOK, DRAGGED, BOUNCING], ids=["free", "drag", "stop"])
def test_kept_times_have_the_bits_that_were_kept(scene: pc.Scene, method: str) -> None:
    step = 1e-2 if method == "rk4" else None
    sol = pc.simulate(scene, (0, 2), 0.5, sensitivities=NAMES, method=method, step=step)
    before = sol.fingerprint
    after_jumps = np.append(np.diff(sol.t) > 0, True)
    assert after_jumps.all() == (scene is not BOUNCING)
    found = sol.sensitivities_at(sol.t)[after_jumps]
    np.testing.assert_array_equal(found, sol.sensitivities[after_jumps])
    assert sol.fingerprint == before


BOTTOM = V.LinkAngle(1, 1.1, terminal=True)
ENDS: dict[str, Any] = {
    "to the end": ("finished", TEXTBOOK, (0, 2), {}),
    "back in time": ("finished", TEXTBOOK, (3, 0), {}),
    "no length": ("finished", TEXTBOOK, (1, 1), {}),
    "to an event": ("event", TEXTBOOK, (0, 2), {"events": [BOTTOM]}),
    "back to an event": ("event", TEXTBOOK, (3, 0), {"events": [BOTTOM]}),
    "to an event at an impact": (
        "event", BOUNCING, (0, 3), {"events": [V.LinkAngle(1, 1.2, terminal=True)]},
    ),
    "to rest": ("at_rest", RUBBING, (0, 30), {}),
    "some steps": ("max_steps", BOUNCING, (0, 3), {"max_steps": 5}),
    "no step": ("max_steps", TEXTBOOK, (0, 3), {"max_steps": 1, "first_step": 1.0}),
    "some time": ("time_limit", TEXTBOOK, (0, 1e6), {"time_limit": 0.02, "rtol": 1e-3}),
    "verified": ("finished", TEXTBOOK, (0, 2), {"error": 1e-8}),
}  # fmt: skip


@pytest.mark.parametrize("store", ["dense", "steps", "end"])
@pytest.mark.parametrize("end", ENDS)
def test_however_a_run_ended_and_whatever_it_kept(end: str, store: str, tmp_path: Path) -> None:
    status, scene, span, how = ENDS[end]
    sol = pc.simulate(scene, span, 1.0, sensitivities=NAMES, store=store, on_failure="ignore",
                      **how)  # fmt: skip
    assert sol.status == status
    there = [sol.t_span[0], sol.t_reached]
    at_start, at_end = sol.sensitivities_at(there)
    np.testing.assert_array_equal(at_end, sol.sensitivities[-1])
    if store != "end":
        np.testing.assert_array_equal(at_start, sol.sensitivities[0])
    beyond = sol.t_reached + 1e-3 * (1 if span[1] >= span[0] else -1)
    with pytest.raises(ValueError, match="must be within the run"):
        sol.sensitivities_at(beyond)
    sol.save(tmp_path / "run.npz")
    again = pc.load(tmp_path / "run.npz").sensitivities_at(there)
    np.testing.assert_array_equal(again, [at_start, at_end])


@pytest.mark.parametrize("scene", [TEXTBOOK, BOUNCING, DRAGGED], ids=["free", "stop", "drag"])
@pytest.mark.parametrize("span", [(0, 2), (2, 0)], ids=["forward", "back"])
def test_between_the_steps_they_are_those_of_a_run_that_keeps_these_times(
    scene: pc.Scene, span: Any
) -> None:
    if span[0] > 0 and scene is BOUNCING:
        scene = BOUNCING.replace(effects=[STOP.replace(restitution=1.0)])
    times = np.linspace(*span, 37)
    kept = pc.simulate(scene, span, 0.5, sensitivities=NAMES, t_eval=times)
    sol = pc.simulate(scene, span, 0.5, sensitivities=NAMES)
    np.testing.assert_array_equal(sol.sensitivities_at(times[::-1])[::-1], kept.sensitivities)
    alone = kept.sensitivities_at(times[20])
    if scene is DRAGGED:  # by collocation, the times within a step cut it
        assert 0 < np.abs(alone - kept.sensitivities[20]).max() < 1e-12
    else:
        np.testing.assert_array_equal(alone, kept.sensitivities[20])


@pytest.mark.parametrize(
    ("method", "step", "within"),
    [("dop853", 1e-3, 1e-12), ("dopri5", 1e-3, 1e-12), ("dop853", 0.25, 1e-4)],
)
def test_short_and_long_steps_of_a_run_have_the_same(
    method: str, step: float, within: float
) -> None:
    """Series have steps of their own, which end between those of the run."""
    slow = pc.Scene(links=[pc.Link(mass=1.0, length=10.0)] * 2)
    how: Any = {"t_eval": [1.3, 6.0], "sensitivities": ["q0[1]", "qd0[2]", "gravity"]}
    found = pc.simulate(slow, (0, 6), [0.5, 1.0], method=method, step=step, **how)
    right = pc.simulate(slow, (0, 6), [0.5, 1.0], method="taylor", rtol=1e-14, atol=1e-16, **how)
    largest = np.abs(right.sensitivities).max()
    np.testing.assert_allclose(found.sensitivities, right.sensitivities, 0, within * largest)


@pytest.mark.parametrize("method", ["taylor", "dop853", "dopri5"])
def test_a_spring_has_those_of_its_cosine(method: str) -> None:
    """The equation is linear, so that they do not depend on how fast the rod turns."""
    spring = ROD_ALONE.replace(effects=[E.TorsionalSpring(joint=1, stiffness=1.0 / 3.0)])
    t = np.linspace(0, 20, 201)
    for rate in (0.06, 0.838, 5.9, 200.0):
        how: Any = {"rtol": 1e-12, "atol": 1e-15, "t_eval": t, "sensitivities": ["q0[1]"]}
        found = pc.simulate(spring, (0, 20), 0.0, rate, method=method, **how).sensitivities
        np.testing.assert_allclose(found[:, 0, 0], np.cos(t), rtol=0, atol=2e-12)


@pytest.mark.parametrize("step", [1e-4, 1e-3])
def test_after_a_release_they_go_on_from_rest(step: float) -> None:
    """The changes are zero there, and so are the rates: neither says how long a series may be."""
    shaken = E.DrivenPivot(x=E.Sinusoid(0.29, 2.75), y=E.Sinusoid(0.178, 11.7, 0.4))
    stop = E.JointStop(joint=1, range=(-1.2, 0.9), restitution=0.0)
    scene = pc.Scene(links=[pc.Link(mass=0.45, length=1.05)], effects=[stop, shaken])
    how: Any = {"sensitivities": ["link[1].length", "link[1].center"], "store": "end"}
    found = pc.simulate(scene, (0, 6), 0.3, 1.0, method="dop853", step=step, **how)
    right = pc.simulate(scene, (0, 6), 0.3, 1.0, method="taylor", rtol=1e-12, atol=1e-15, **how)
    np.testing.assert_allclose(found.sensitivities, right.sensitivities, rtol=1e-5)


def test_at_an_impact_they_are_those_after_it() -> None:
    sol = pc.simulate(BOUNCING, (0, 0.5), 0.5, sensitivities=NAMES)
    (at,) = np.flatnonzero(np.diff(sol.t) == 0)
    found = sol.sensitivities_at(np.nextafter(sol.t[at], [0, sol.t[at], 9]))
    size = np.abs(sol.sensitivities[at]).max()
    np.testing.assert_allclose(found[0], sol.sensitivities[at], rtol=0, atol=1e-12 * size)
    np.testing.assert_array_equal(found[1], sol.sensitivities[at + 1])
    assert np.abs(found[1] - found[0]).max() > 0.1


def test_what_has_no_derivative_later_has_none_there() -> None:
    grazing = E.JointStop(joint=1, range=(-9, np.pi - 0.5), restitution=0.5)
    scene = pc.Scene(links=[ROD], effects=[grazing])
    how: Any = {"rtol": 1e-12, "atol": 1e-14}
    with pytest.warns(pc.PendcoreWarning, match="sensitivities: none after"):
        sol = pc.simulate(scene, (0, 3), 0.5, sensitivities=["q0[1]"], **how)
    found = sol.sensitivities_at([0.5, 2.9])
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).all()
    with pytest.warns(pc.PendcoreWarning, match="sensitivities: none after"):
        sol = pc.simulate(scene, (0, 3), 0.5, sensitivities=["q0[1]"], t_eval=[0.5], **how)
    with pytest.warns(pc.PendcoreWarning, match="sensitivities: none after"):
        assert np.isnan(sol.sensitivities_at(2.9)).all()


def test_bad_times_are_refused_in_the_words_of_the_run() -> None:
    sol = pc.simulate(TEXTBOOK, (2, 0.5), 0.5, sensitivities=["gravity"])
    for bad in (0.4, 2.5, [1.0, -3.0], np.nan, [[1.0]], "1", [True]):
        with pytest.raises((ValueError, TypeError)) as said:
            sol(bad)
        with pytest.raises(type(said.value)) as told:
            sol.sensitivities_at(bad)
        assert str(told.value) == str(said.value)


@pytest.mark.parametrize("store", ["dense", "end"])
def test_a_run_that_cannot_be_had_again_has_no_more_than_it_kept(store: str) -> None:
    damping = [0.1]
    moody = E.User(function=lambda t, q, qd: -damping[0] * qd)
    scene = TEXTBOOK.replace(effects=[moody])
    sol = pc.simulate(scene, (0, 1), 0.5, sensitivities=["gravity"], store=store)
    assert np.isfinite(sol.sensitivities_at(0.5)).all()
    assert np.isfinite(sol.extreme_sensitivities().sensitivities).all()
    damping[0] = 0.2
    with pytest.raises(ValueError, match="simulated anew it takes another course"):
        sol.sensitivities_at(0.5)
    if store == "end":
        with pytest.raises(ValueError, match=r"keeps no dense output: .* takes another course"):
            sol.extreme_sensitivities()


@pytest.mark.parametrize(
    "options",
    [{}, {"store": "end"}, {"t_eval": [1.0, 2.0]}, {"method": "rk4", "step": 1e-3}, {"error": 1e-8},
     {"method": "radau5"}, {"method": "dop853"}, {"method": "dopri5"},
     {"max_steps": 9, "on_failure": "ignore", "rtol": 1e-3}],
    ids=str,
)  # fmt: skip
def test_events_and_extremes_have_theirs_whatever_is_kept(options: dict[str, Any]) -> None:
    how: Any = {"sensitivities": ["gravity", "q0[1]"], "events": [V.LinkAngle(1, np.pi / 2)]}
    sol = pc.simulate(TEXTBOOK, (0, 5), 0.5, **how, **options)
    before = sol.fingerprint
    (of_event,), of_extremes = sol.event_sensitivities(), sol.extreme_sensitivities()
    assert len(of_event.t) == len(sol.events[0]) > 0
    np.testing.assert_allclose(of_event.t[:, 0], -sol.events[0].t / (2 * 9.807), rtol=1e-2)
    if sol.success:
        best = pc.simulate(TEXTBOOK, (0, 5), 0.5, **how, rtol=1e-13, atol=1e-16)
        exact = best.extreme_sensitivities()
        np.testing.assert_allclose(of_extremes.values, exact.values, atol=1e-7)
        np.testing.assert_allclose(of_extremes.t, exact.t, atol=1e-6)
        np.testing.assert_allclose(of_extremes.sensitivities, exact.sensitivities, atol=1e-5)
    assert sol.fingerprint == before


@pytest.mark.parametrize("end", [1e-300, -1e-300])
def test_times_of_a_span_whose_products_vanish(end: float) -> None:
    sol = pc.simulate(pc.Scene.textbook(), (0, end), 0.3, t_eval=[end / 2], sensitivities=["q0[1]"])
    assert sol.t.tolist() == [end / 2]
    at_half, at_quarter = sol.sensitivities_at([end / 2, end / 4])
    np.testing.assert_array_equal(at_half, sol.sensitivities[0])
    np.testing.assert_allclose(2 * at_quarter[2:], at_half[2:], rtol=1e-12)  # of the rates
