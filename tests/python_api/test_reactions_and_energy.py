"""The largest joint force is that of the whole curve; a drift of the energy is called out."""

from __future__ import annotations

import re
import tracemalloc
from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pendcore as pc
import pytest
from pendcore._run import largest_reactions
from pendcore.cli.summary import facts, text

fx = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
G = 9.807
ROD_ALONE = pc.Scene(links=[ROD], gravity=G)
TWO = pc.Scene.textbook()
RUBBED = TWO.replace(
    effects=[
        *(fx.DryJointFriction(joint=j, coulomb=c) for j, c in ((1, 5.0), (2, 1.5))),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(10.0, angular_frequency=1.0)),
    ]
)
BOUNCING = TWO.replace(effects=[fx.JointStop(joint=2, range=(-0.3, 0.3), restitution=0.3)])


def forces_at(solution, t):
    """By the balance of forces of the links beyond each joint, with the scene's accelerations."""
    scene, states = solution.scene, solution(t).T
    n = len(scene.links)
    q, qd = states[:, :n], states[:, n:]
    qdd = scene.accelerations(t, q, qd)
    along = np.stack([np.cos(q), np.sin(q)], axis=-1)
    across = np.stack([-np.sin(q), np.cos(q)], axis=-1)
    turning = qdd[..., None] * across - (qd**2)[..., None] * along
    length, center, mass = (
        np.array([getattr(link, name) for link in scene.links])[:, None]
        for name in ("length", "center", "mass")
    )
    a = np.cumsum(length * turning, axis=1) - (length - center) * turning
    loads = mass * (a - np.array([0.0, scene.gravity]))
    return np.linalg.norm(np.cumsum(loads[:, ::-1], axis=1)[:, ::-1], axis=-1)


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["auto", "dopri5", "dop853"])
@pytest.mark.parametrize(
    ("scene", "q0", "t_span"),
    [
        (TWO, [pi / 4, pi / 3], (0, 5)),
        (TWO, [1.0, 2.0], (3, 0)),
        (RUBBED, pi / 2, (0, 9)),
        (BOUNCING, [0.1, 0.3], (0, 5)),
    ],
    ids=["textbook", "backward", "friction", "stop"],
)
def test_it_is_that_of_a_far_finer_evaluation(scene, q0, t_span, method):
    solution = pc.simulate(scene, q0=q0, t_span=t_span, method=method)
    at_kept_times = np.linalg.norm(solution.reactions(), axis=-1).max(axis=0)
    for one, kept in zip(solution.largest_reactions(), at_kept_times, strict=True):
        assert kept <= one.force
        t = np.linspace(*t_span, 100_001)
        k = int(forces_at(solution, t)[:, one.joint - 1].argmax())
        around = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 10_001)
        finest = forces_at(solution, around)[:, one.joint - 1].max()
        assert one.force == pytest.approx(finest, rel=1e-10)
        assert abs(one.t - t[k]) <= 2 * abs(t[1] - t[0])


# It is caught at the bottom, and from then on carries the weight alone.
CAUGHT = ROD_ALONE.replace(effects=[fx.JointStop(joint=1, range=(-1.0, pi / 2))])
SHAKEN = ROD_ALONE.replace(
    effects=[fx.DrivenPivot(x=fx.Sinusoid(0.5, 200.0)), fx.Lock(joint=1)]
)  # the drive is faster than the steps
FAST = sqrt((0.5 * 200.0**2) ** 2 + G**2)
NO_DOUBLE = {"q0": 0.0, "qd0": 1e160, "t_span": (0, 1e-170), "store": "end"}
# For each the scene, the run, the exact forces, and what the summary says.
EXACT = {
    "fall": (ROD_ALONE, {"q0": 0.0, "t_span": (0, 3)}, [2.5 * G], r"24\.5175 N at t ="),
    "caught": (CAUGHT, {"q0": 0.0, "t_span": (0, 1)}, [2.5 * G], r"24\.5175 N just before t ="),
    "shaken": (SHAKEN, {"q0": 0.3, "t_span": (0, 5)}, [FAST], r"20000 N at t ="),
    "rest": (TWO, {"q0": pi / 2, "t_span": (0, 1)}, [2 * G, G], r"19\.614 N throughout"),
    "beyond": (ROD_ALONE, NO_DOUBLE, [np.inf], "beyond the range of doubles at t = "),
}


@pytest.mark.parametrize("case", EXACT)
def test_it_is_the_exact_one_where_that_is_known(case):
    scene, run, forces, words = EXACT[case]
    solution = pc.simulate(scene, **run)
    found = solution.largest_reactions()
    within = 1e-12 if case in ("shaken", "rest") else 1e-9
    assert [one.force for one in found] == pytest.approx(forces, rel=within)
    # The pivot shakes faster than the steps are long.
    assert case != "shaken" or solution.stats.accepted < 5 * 200 / (2 * pi)
    assert all(one.steady == (case == "rest") for one in found)
    assert all(one.just_before == (case == "caught") for one in found)
    assert re.search(f"joint 1: {words}", text(facts(solution)))
    if case == "fall":
        assert abs(np.cos(solution(found[0].t)[0])) < 1e-6  # at the bottom
    if case == "caught":
        assert found[0].t in solution.t
        after = forces_at(solution, np.array([found[0].t]))[0, 0]
        assert after == pytest.approx(G, rel=1e-12)


def test_the_side_after_an_impact_counts_as_that_before_it_does():
    """An elastic impact backward in time is one as well, its two sides the other way round."""
    stop = fx.JointStop(joint=2, range=(-1.0, 0.0), restitution=1.0)
    scene = TWO.replace(gravity=0.0, effects=[stop])
    how = {"t_span": (0, 0.3), "method": "dop853"}
    there = pc.simulate(scene, q0=[0.0, -0.2], qd0=[-1.0, 2.0], **how)
    back = pc.simulate(scene, q0=there.q[-1], qd0=-there.qd[-1], **how)
    before, after = there.largest_reactions()[0], back.largest_reactions()[0]
    assert (before.just_before, after.just_before) == (True, False)
    assert after.force == pytest.approx(before.force, rel=1e-9)
    assert after.t == pytest.approx(0.3 - before.t, rel=1e-9)


def test_a_joint_that_is_held_is_held_between_the_steps_of_an_implicit_method_too():
    """The interpolant turns the joint by a last bit, with which it would slide."""
    runs = (
        pc.simulate(RUBBED, q0=pi / 2, t_span=(0, 9), method=method)
        for method in ("radau5", "dop853")
    )
    one, other = ([x.force for x in run.largest_reactions()] for run in runs)
    assert one == pytest.approx(other, rel=1e-8)


@pytest.mark.parametrize(
    "kept", [{"store": "steps"}, {"store": "end"}, {"t_eval": [1, 2]}, {"t_span": (5, 5)}], ids=str
)
def test_without_interpolants_it_is_the_largest_of_the_kept_times(kept):
    solution = pc.simulate(TWO, **{"q0": [pi / 4, pi / 3], "t_span": (0, 5)} | kept)
    sizes = np.linalg.norm(solution.reactions(), axis=-1)
    found = solution.largest_reactions()
    assert [one.force for one in found] == pytest.approx(sizes.max(axis=0), rel=1e-15)
    told = text(facts(solution))
    assert ("t_span" in kept) == (f"among the {len(solution.t)} kept time" not in told)
    assert {one.t for one in found} <= {*solution.t}
    if "store" in kept:  # what is known at one time is not told to be steady
        assert not any(one.steady for one in found)


def test_times_asked_for_beside_the_interpolants_take_nothing_away():
    asked = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5), t_eval=[1.0], store="dense")
    whole = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5))
    assert asked.largest_reactions() == whole.largest_reactions()
    assert "kept time" not in text(facts(asked))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6, 1e-9])
def test_as_many_digits_are_printed_as_are_right(tolerance):
    asked = {"q0": [pi / 4, pi / 3], "t_span": (0, 5)}
    coarse = pc.simulate(TWO, **asked, method="ode45", rtol=tolerance, atol=tolerance)
    printed = re.search("joint 1: (.*) N", text(facts(coarse)))[1]
    right = pc.simulate(TWO, **asked, method="taylor", rtol=1e-14).largest_reactions()[0].force
    decimals = len(printed.partition(".")[2])
    assert float(printed) == pytest.approx(right, abs=0.6 * 10.0**-decimals)
    assert tolerance > 1e-9 or printed == "31.9307"


def test_a_long_run_takes_no_more_memory_than_a_short_one():
    peaks = []
    for t_end in (2.0, 20.0):
        solution = pc.simulate(TWO, q0=[1, 2], t_span=(0, t_end), method="rk4", step=2e-4)
        tracemalloc.start()
        solution.largest_reactions()
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    short, long = peaks
    assert long < 1.2 * short


def test_progress_goes_up_to_the_end(monkeypatch):
    monkeypatch.setattr(largest_reactions, "AT_ONCE", 1)
    solution = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5), method="dopri5")
    told = []
    solution.largest_reactions(progress=told.append)
    assert len(told) > 10
    assert all(a < b for a, b in pairwise(told))
    assert told[-1] == 1.0


class Told(list):
    """A list that is called: it is false until it has heard of anything."""

    __call__ = list.append


def test_progress_is_told_to_what_is_false_as_well(tmp_path):
    solution = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5))
    for call in (solution.largest_reactions, solution.defect):
        told = Told()
        call(progress=told)
        assert told[-1] == 1.0
    told = Told()
    solution.save(tmp_path / "run.npz", progress=told)
    assert told[-1] == 1.0


# The drift of the energy -----------------------------------------------------------------------

SAID = "too large to trust this run: tighten rtol and atol (or the step)"
COARSE = {"q0": 1, "t_span": (0, 5), "rtol": 1e-1, "atol": 1e-1}
LOOSE = {"q0": 1, "t_span": (0, 5), "method": "dopri5", "step": 0.3, "on_failure": "ignore"}
RUNS = {
    "coarse": (True, COARSE),
    "only the start was kept": (True, COARSE | {"t_eval": [0.0]}),  # the end that was reached tells
    "some of many times": (True, LOOSE | {"t_eval": np.linspace(0, 5, 10_001)}),
    "textbook": (False, {"q0": [pi / 4, pi / 3], "t_span": (0, 5)}),
    "rest": (False, {"q0": pi / 2, "t_span": (0, 1)}),
    "rest, upright": (False, {"q0": -pi / 2, "t_span": (0, 1)}),
    "rest, folded": (False, {"q0": [pi / 2, -pi / 2], "t_span": (0, 1)}),
    "next to rest": (False, {"q0": pi / 2 + 1e-7, "t_span": (0, 1)}),
}


@pytest.mark.parametrize("case", RUNS)
def test_a_drift_of_the_energy_that_is_too_large_is_called_out_and_no_other(case):
    too_large, how = RUNS[case]
    run = pc.simulate(TWO, **how)
    assert (SAID in repr(run)) == (SAID in run._repr_html_()) == too_large
    assert ("(of one time in 2)" in repr(run)) == (case == "some of many times")


def test_a_run_of_which_only_moments_of_rest_were_kept_is_not_blamed():
    swing = pc.simulate(ROD_ALONE, q0=0.3, t_span=(0, 5))
    t = np.linspace(1, 5, 200_001)
    back = t[np.abs(swing(t)[1]).argmin()]
    end = pc.simulate(ROD_ALONE, q0=0.3, t_span=(0, back), store="end")
    assert abs(end.qd[-1, 0]) < 1e-4
    assert "too large" not in repr(end)


@pytest.mark.parametrize("gravity", [9.807, -9.807, 0.0])
def test_where_only_the_end_was_kept_the_total_energy_bounds_the_motion(gravity):
    scene = TWO.replace(gravity=gravity)
    start = {"q0": [1, 2], "qd0": [3, 4], "t_span": (0, 50)}
    every = pc.simulate(scene, **start).energy_drift()
    bound = pc.simulate(scene, **start, store="end").energy_drift().largest_kinetic
    assert every.largest_kinetic <= bound * (1 + 1e-6)
    assert bound < 2 * every.largest_kinetic
