"""The error that the core finds from the defect of a run is the distance from the true motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore._accuracy.defect_correction import FromDefect
from pendcore._accuracy.strategies import FROM_DEFECT, strategies
from pendcore._run.call import Choice, Start, run
from pendcore.options import atol_beside

CHAIN = pc.Scene(
    links=[pc.Link(mass=m, length=x) for m, x in ((1.0, 0.5), (2.0, 0.3), (0.5, 1.0))],
    effects=[pc.effects.ViscousJoint(joint=2, damping=0.1)],
)
DRIVEN = pc.Scene(
    links=[pc.Link(mass=1.0, length=1.0)],
    effects=[pc.effects.DrivenPivot(y=pc.effects.Sinusoid(0.05, angular_frequency=7.0))],
)
LONG = pc.Scene(
    links=[pc.Link(mass=1.0 + 0.1 * i, length=0.3 + 0.05 * i) for i in range(6)],
    effects=[pc.effects.ViscousJoint(joint=i, damping=0.05) for i in range(1, 7)],
)
SCENES = {
    "textbook": Start(pc.Scene.textbook(), [0.8, 1.0], 0.0, 0.0, 5.0),
    "backward": Start(pc.Scene.textbook(), [0.8, 1.0], [1.0, -1.0], 2.0, -1.0),
    "three links": Start(CHAIN, [2.0, 1.0, 1.5], 0.0, 0.0, 4.0),
    "driven": Start(DRIVEN, [0.3], 0.0, 12.5, 20.0),
    "four links": Start(pc.Scene(links=LONG.links[:4]), [0.8, 1.0, 1.3, 1.5], 0.0, 0.0, 2.0),
    "six links": Start(LONG, [0.8, 1.0, 1.3, 1.5, 1.6, 1.4], 0.0, 0.0, 2.0),
}
RUNGE_KUTTA, SERIES_6_5, SERIES_7_6, SERIES_8_7 = FROM_DEFECT
each_strategy = pytest.mark.parametrize(
    "way", FROM_DEFECT, ids=lambda one: f"{one.method} {one.points}"
)
with_few_points = pytest.mark.parametrize("way", [SERIES_6_5, SERIES_7_6], ids=["6", "7"])
KEPT: dict[str, dict[str, Any]] = {
    "dense": {},
    "steps": {"store": "steps"},
    "end": {"store": "end"},
    "times": {"t_eval": 7},
}


def corrected(
    start: Start, scene: pc.Scene, way: FromDefect, rtol: float = 1e-6, **kept: Any
) -> tuple[pc.Solution, _core.DefectCorrection]:
    """Run, and integrate the distance from the motion of a scene with the same start."""
    correction = _core.DefectCorrection([(scene._compiled, start.q0, way.points)])
    if "t_eval" in kept:
        kept["t_eval"] = np.linspace(start.t_start, start.t_end, kept["t_eval"])
    solution = run(start, Choice(way.method, rtol, atol_beside(rtol)), watch=correction, **kept)
    return solution, correction


def angles(start: Start, t: np.ndarray) -> np.ndarray:
    """Return the angles of the motion, (n_t, n) rad."""
    exact = Choice("dop853", 1e-13, 1e-16, compensated=True)
    return run(start, exact)(t)[: len(start.scene.links)].T


@each_strategy
@pytest.mark.parametrize("name", SCENES)
def test_correction_is_the_error_of_the_run(name: str, way: FromDefect) -> None:
    start = SCENES[name]
    solution, correction = corrected(start, start.scene, way)
    t = correction.t
    assert (t[0], t[-1]) == (start.t_start, start.t_end)
    assert len(t) >= 6 * solution.stats.accepted
    steps = solution.stats.accepted
    assert correction.nfev == sum(1 + steps * (points - 1) for points in way.points)
    alone = run(start, Choice(way.method, 1e-6, 1e-9))
    assert solution.y.tobytes() == alone.y.tobytes()
    error = angles(start, t) - solution(t)[: len(start.scene.links)].T
    assert np.abs(error).max() > 1e-9
    for one in np.moveaxis(correction.errors, 1, 0):
        assert np.abs(one - error).max() <= 0.15 * np.abs(error).max()


@pytest.mark.parametrize("kept", KEPT)
@pytest.mark.parametrize("name", ["textbook", "backward"])
@with_few_points
def test_errors_are_kept_where_states_are(name: str, way: FromDefect, kept: str) -> None:
    start = SCENES[name]
    solution, correction = corrected(start, start.scene, way, **KEPT[kept])
    t = correction.t if kept == "dense" else solution.t
    assert correction.t.tolist() == t.tolist()
    q = solution(t)[:2].T if kept == "dense" else solution.q
    error = angles(start, t) - q
    assert np.abs(correction.errors[:, 0] - error).max() <= 0.1 * np.abs(error).max()
    assert correction.errors_at_end[:, 0].tolist() == correction.errors[-1].tolist()


def test_errors_at_ends_of_steps_are_those_within_them() -> None:
    start = SCENES["textbook"]
    dense, whole = corrected(start, start.scene, SERIES_6_5)
    times = np.sort(np.append(dense.step_starts, whole.t[3::6]))[1:]
    correction = _core.DefectCorrection([(start.scene._compiled, start.q0, SERIES_6_5.points)])
    run(start, Choice("taylor", 1e-6, atol_beside(1e-6)), times, watch=correction)
    at = np.searchsorted(whole.t, times)
    assert correction.errors == pytest.approx(whole.errors[at], rel=1e-9, abs=1e-22)


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_first_step_has_the_error_of_its_dense_output_inside(method: str) -> None:
    """There is none at its start: by how much the curve is off the dense output weighs most."""
    start, way = SCENES["textbook"], replace(SERIES_8_7, method=method)
    solution, correction = corrected(start, start.scene, way, rtol=1e-5, first_step=0.1)
    inside = slice(1, 6)
    t = correction.t[inside]
    assert t[-1] > 0.05
    error = angles(start, t) - solution(t)[:2].T
    assert np.abs(error).max() > 1e-9
    assert np.abs(correction.errors[inside, 0] - error).max() <= 0.05 * np.abs(error).max()


@pytest.mark.parametrize("kept", KEPT)
def test_nothing_is_known_after_the_run_is_lost(kept: str) -> None:
    start = Start(pc.Scene.textbook(), [-1.5, -1.4], 0.0, 0.0, 60.0)
    way = SERIES_8_7
    _, correction = corrected(start, start.scene, way, rtol=1e-7, **KEPT[kept])
    _, _, at_loss, t_known = correction.agreement
    assert 0.2 <= at_loss < 10
    after = correction.t > t_known + 1.0
    assert np.isnan(correction.errors[after]).all()
    assert not np.isnan(correction.errors[correction.t <= t_known]).any()
    assert np.isnan(correction.errors_at_end).all()


def test_neighbour_that_is_another_scene_gives_the_distance_from_its_motion() -> None:
    start = SCENES["textbook"]
    first, second = start.scene.links
    heavier = pc.Scene(links=[first, pc.Link(mass=second.mass * (1 + 1e-6), length=second.length)])
    correction = _core.DefectCorrection(
        [(one._compiled, start.q0, [8]) for one in (start.scene, heavier)]
    )
    solution = run(start, Choice("taylor", 1e-11, 1e-14), watch=correction)
    t = correction.t
    distance = angles(start._replace(scene=heavier), t) - solution(t)[:2].T
    assert np.abs(distance).max() > 1e-7
    assert np.abs(correction.errors[:, 1] - distance).max() <= 1e-3 * np.abs(distance).max()
    assert np.abs(correction.errors[:, 0]).max() < 1e-9


def test_unstable_correction_is_not_trusted_and_second_runs_take_its_place() -> None:
    damped = CHAIN.replace(effects=[pc.effects.ViscousJoint(joint=1, damping=300.0)])
    start = Start(damped, [2.0, 1.0, 1.5], 0.0, 0.0, 1.0)
    solution, correction = corrected(start, damped, SERIES_6_5, rtol=1e-8)
    assert SERIES_6_5.error(solution, correction, "") is None
    sol = pc.simulate(damped, (0, 1), start.q0, error=1e-7)
    told = sol.accuracy
    assert told.outcome == "kept"
    assert not told.verified_by.startswith("the defect")
    verified = [paid.method for paid in told.paid if paid.purpose == "verify"]
    assert verified
    assert not any(method.startswith("defect of") for method in verified)
    assert told.runs < len(told.paid)
    t = np.linspace(0, 1, 101)
    assert np.abs(angles(start, t) - sol(t)[:3].T).max() <= 1e-6


def test_chaotic_motion_is_lost_and_its_early_part_known() -> None:
    scene = pc.Scene.textbook()
    start = Start(scene, [-1.5, -1.4], 0.0, 0.0, 60.0)
    correction = SERIES_8_7.correction(start, 1e-10)
    solution = run(start, Choice("taylor", 1e-10, 1e-13), watch=correction)
    error = SERIES_8_7.error(solution, correction, "its defect")
    assert error.is_lost
    assert 5.0 < error.t[-1] < 60.0
    early = error.t[error.position < 1e-4]
    apart = np.abs(angles(start._replace(t_end=early[-1]), early) - solution(early)[:2].T)
    assert (apart.max(axis=1) <= error.angle[: len(early)]).all()


def test_scene_that_switches_or_has_no_series_is_left_to_second_runs() -> None:
    stopped = CHAIN.replace(effects=[pc.effects.JointStop(joint=2, range=(-1.0, 1.0))])
    drag = pc.effects.RodDrag(link=1, drag_coefficient=1.2, diameter=0.01)
    dragged = CHAIN.replace(effects=[drag])
    for scene in (stopped, dragged):
        (only,) = strategies(Start(scene, [1.5] * 3, 0.0, 0.0, 1.0), 1e-6)
        assert not only.method
    with pytest.raises(ValueError, match="a law switches"):
        _core.DefectCorrection([(stopped._compiled, [1.5] * 3, [6])])


def test_run_of_no_length_and_one_with_a_ledger_are_corrected_too() -> None:
    still = SCENES["textbook"]._replace(t_end=0.0)
    _, correction = corrected(still, still.scene, SERIES_6_5)
    assert correction.errors.tolist() == [[[0.0, 0.0], [0.0, 0.0]]]
    start = SCENES["three links"]
    _, alone = corrected(start, start.scene, SERIES_6_5)
    _, with_ledger = corrected(start, start.scene, SERIES_6_5, ledger=True)
    assert with_ledger.errors[-1] == pytest.approx(alone.errors[-1], rel=0.2)


@with_few_points
@pytest.mark.parametrize("kept", [{}, {"t_eval": 2001}], ids=["dense", "times"])
def test_correction_ends_at_an_event_within_a_step(way: FromDefect, kept: dict[str, Any]) -> None:
    start = SCENES["textbook"]._replace(t_end=50.0)
    event = pc.events.JointAngle(joint=1, value=1.2, terminal=True)._as_pair()
    solution, correction = corrected(start, start.scene, way, events=[event], **kept)
    assert solution.status == "event"
    t = correction.t
    if kept:
        assert 3 < len(solution.t) < 2001
        assert t.tolist() == solution.t.tolist()
    else:
        assert t[-1] == solution.t[-1] < 50.0
    q = solution.q if kept else solution(t)[:2].T
    error = angles(start._replace(t_end=5.0), t) - q
    assert np.abs(correction.errors[:, 0] - error).max() <= 0.15 * np.abs(error).max()


def test_correction_looks_on_one_run_only_and_wants_neighbours_alike() -> None:
    start, tight = SCENES["textbook"], Choice("taylor", 1e-6, 1e-9)
    correction = SERIES_6_5.correction(start, 1e-6)
    run(start, tight, watch=correction)
    with pytest.raises(ValueError, match="a run already"):
        run(start, tight, watch=correction)
    book, chain = start.scene._compiled, CHAIN._compiled
    for neighbours, message in (
        ([(book, [1.0] * 3, [6])], "as many links"),
        ([(book, [1.0] * 2, [6]), (chain, [1.0] * 3, [5])], "as many links"),
        ([(chain, [1.5] * 3, [4])], "points = 4: must be from 5 to 9"),
        ([(chain, [1.5] * 3, [10])], "points = 10: must be from 5 to 9"),
    ):
        with pytest.raises(ValueError, match=message):
            _core.DefectCorrection(neighbours)
    with pytest.raises(ValueError, match="more links than the run"):
        run(start, tight, watch=_core.DefectCorrection([(chain, [1.0] * 3, [6])]))


def test_rounding_of_the_states_is_part_of_the_error() -> None:
    # From other starts the error is smaller, and the rounding of the reference is as large.
    start = Start(pc.Scene.textbook(), [0.9, 1.2], 0.0, 0.0, 60.0)
    solution, correction = corrected(start, start.scene, SERIES_8_7, rtol=1e-14, store="steps")
    exact = Choice("dop853", 1e-15, 1e-18, compensated=True)
    error = run(start, exact, solution.t).q - solution.q
    assert np.abs(error).max() > 1e-13
    assert np.abs(correction.errors[:, 0] - error).max() <= 0.5 * np.abs(error).max()
