"""The comparison rests on these: the measure of error, the interpolation, the turns taken."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import chains
import effects
import forward_derivatives
from cases import one_step, read_case
from contenders.contender import Outcome, PythonRun, Unsupported
from dense_chain import DenseChain
from equal_error import SIDES, compare, envelope, time_at
from forward_dynamics import ChainScene, chain_scene
from measure import achieved, interleave
from trajectory_error import end_error, energy_error, position_error

LENGTHS = np.array([1.0, 3.0])
POWER_LAW = [(10.0**-k, 5.0 * 10 ** (0.2 * k)) for k in range(1, 13)]  # time = 5 error^-1/5


@pytest.mark.parametrize(
    ("off", "lengths", "worst", "last"),
    [  # by hand: a chord of 2 L sin(angle / 2), over the total length
        ([[0, 0], [0, 0.2]], (1, 3), 1.5 * math.sin(0.1), 1.5 * math.sin(0.1)),
        ([[0, 0], [0.2, 0.2], [0.1, 0.1]], (1, 3), 2 * math.sin(0.1), 2 * math.sin(0.05)),
        ([[1, -1]], (1, 1), math.sin(0.5), math.sin(0.5)),  # the tip is right, the joint not
    ],
    ids=["chord", "worst and last", "joint"],
)
def test_the_error_is_the_largest_distance_over_the_length(off, lengths, worst, last):
    q = np.full((len(off), 2), [-0.5, 0.5]) * (len(off) == 1)
    found, sizes = q + np.array(off, float), np.array(lengths, float)
    assert position_error(found, q, sizes) == pytest.approx(worst, rel=1e-12)
    assert end_error(found, q, sizes) == pytest.approx(last, rel=1e-12)


@pytest.mark.parametrize(
    "name", ["textbook", "textbook_long", "high_energy", "unequal", "no_gravity", "three_links"]
)
def test_reference_trajectories_have_no_energy_error(name):
    case = read_case(name)
    q, qd = case.reference[:, : case.n], case.reference[:, case.n :]
    masses, lengths = np.array(case.masses), np.array(case.lengths)
    assert energy_error(q, qd, masses, lengths, case.gravity) < 1e-14


def test_energy_error_of_a_lost_fall_is_the_height_over_the_length():
    q, qd = np.array([[0.0], [math.pi / 2]]), np.zeros((2, 1))
    assert energy_error(q, qd, np.array([2.0]), np.array([3.0]), 9.8) == pytest.approx(0.5)


def test_interpolation_is_exact_on_a_power_law_and_ends_where_the_points_do():
    for error in (1e-1, 3e-4, 1e-7, 1e-12):
        assert time_at(POWER_LAW[::-1], error) == pytest.approx(5.0 * error**-0.2, rel=1e-12)
    assert time_at(POWER_LAW, 0.5) == POWER_LAW[0][1]
    assert time_at(POWER_LAW, 1e-13) is None
    assert time_at([], 1e-3) is None


def test_points_that_another_beats_in_both_are_left_out():
    points = [(1e-1, 1.0), (2e-2, 9.0), (1e-2, 2.0), (3e-2, 2.0), (1e-3, 4.0)]
    assert envelope(points) == [(1e-1, 1.0), (1e-2, 2.0), (1e-3, 4.0)]


# ---- best against best


def entrant(name, times, *sides):
    """Make a contender; a peer's median is four minima, ours two."""
    ours = name.startswith("pendcore")
    points = [
        {"error": error, "minimum_us": time, "median_us": (2 if ours else 4) * time}
        for error, time in times.items()
    ]
    failed = [{"failure": "too stiff"}]
    return {"label": name, "ours": ours, "sides": sides, "points": points + failed}


WHO = [
    entrant("pendcore low", {1e-2: 1.0, 1e-4: 10.0, 1e-6: 100.0}, "compiled"),
    entrant("pendcore high", {1e-2: 4.0, 1e-4: 8.0, 1e-9: 20.0}, "compiled"),
    entrant("pendcore v3", {1e-2: 3.0, 1e-6: 300.0}, "compiled_v3"),
    entrant("pendcore python", {1e-2: 2.0, 1e-6: 100.0}, "python"),
    entrant("odeint", {1e-2: 2.0, 1e-4: 20.0, 1e-5: 60.0}, "compiled"),
    entrant("heyoka", {1e-3: 12.0, 1e-12: 12.0}, "compiled", "python"),
]


@pytest.mark.parametrize(
    ("side", "error", "own", "peer", "reached"),
    [
        (0, 1e-2, (1.0, "pendcore low"), (2.0, "odeint"), True),
        (0, 1e-4, (8.0, "pendcore high"), (12.0, "heyoka"), False),
        (0, 1e-9, (20.0, "pendcore high"), (12.0, "heyoka"), False),
        (0, 1e-12, None, (12.0, "heyoka"), False),
        (1, 1e-2, (3.0, "pendcore v3"), (2.0, "odeint"), False),
        (2, 1e-2, (2.0, "pendcore python"), (12.0, "heyoka"), True),
    ],
)
def test_the_best_of_each_side_is_the_quickest_at_that_error(side, error, own, peer, reached):
    (at,) = compare(WHO, SIDES[side], [error])
    assert (at.own, at.peer, at.reached) == (own, peer, reached)
    assert at.ratio == (own and pytest.approx(own[0] / peer[0]))
    assert at.of_medians == (own and pytest.approx(own[0] / peer[0] / 2))
    assert at.lost == (own is None or own[0] > peer[0])


# ---- turns


class Turn:
    """A run that notes its turns and takes as long as it is told."""

    def __init__(self, name, turns, seconds):
        self.name, self.turns, self.seconds = name, turns, seconds

    def burst(self, seconds):
        self.turns.append(self.name)
        return [self.seconds.pop(0)]

    def outcome(self):
        raise RuntimeError("no states")


def test_every_run_has_one_turn_a_round_in_an_order_drawn_anew():
    turns = []
    interleave({name: Turn(name, turns, [1.0] * 8) for name in "abcde"}, 8, 0.0)
    rounds = ["".join(turns[k : k + 5]) for k in range(0, 40, 5)]
    assert all(sorted(order) == list("abcde") for order in rounds)
    assert len(set(rounds)) > 1


def test_timing_keeps_the_least_and_the_median_of_all_rounds():
    timing = interleave({"a": Turn("a", [], [3.0, 1.0, 2.0, 9.0, 8.0])}, 5, 0.0)["a"]
    assert (timing.minimum, timing.median, timing.calls) == (1.0, 3.0, 5)


def test_a_run_that_ends_early_or_in_nan_is_a_failure_not_an_error_of_zero():
    case = read_case("textbook")
    broken = case.reference.copy()
    broken[50, 1] = np.nan
    for states, fails in ((broken, True), (case.reference[:-1], True), (case.reference, False)):
        run = PythonRun(solve=lambda states=states: states, read=lambda s: Outcome(s, 7))
        assert ("failure" in achieved(run, case)) == fails
    assert "failure" in achieved(Turn("a", [], []), case)
    short = one_step(case)  # the same start over a ten-thousandth of a second
    assert [*short.times, *short.start] == [0.0, 1e-4, *case.start]


# ---- right-hand sides


@pytest.mark.parametrize(
    ("q", "qd", "gravity", "expected"),
    [  # by hand: two rods of 1 kg and 1 m
        ((0.0, 0.0), (0.0, 0.0), 9.8, (9 * 9.8 / 7, -3 * 9.8 / 7)),
        ((np.pi / 2, 0.0), (2.0, 3.0), 0.0, (-0.5 * 9 / (4 / 3), 0.5 * 4 / (1 / 3))),
    ],
    ids=["fall", "turning links pull"],
)
def test_dense_equations_of_chains_are_right(q, qd, gravity, expected):
    rods = {"masses": np.ones(2), "lengths": np.ones(2), "gravity": gravity, "effect": "none"}
    scene = ChainScene(**rods, q=np.array([q]), qd=np.array([qd]))
    np.testing.assert_allclose(chains.accelerations(scene), expected, rtol=1e-14)


def test_dense_equations_of_chains_have_these_derivatives():
    scene, by = chain_scene(3), 1e-5
    found = forward_derivatives.derivatives(scene, at_joints=False)
    for name, known in zip(("q", "qd"), found, strict=False):
        here = getattr(scene, name)
        ends = [
            [chains.accelerations(replace(scene, **{name: here + move})) for move in by * np.eye(3)]
            for by in (by, -by)
        ]
        differences = np.subtract(*ends).T / (2 * by)
        np.testing.assert_allclose(known, differences, rtol=0, atol=1e-8 * np.abs(known).max())
    chain = DenseChain(masses=scene.masses, lengths=scene.lengths, gravity=scene.gravity)
    mass = chain.mass_matrix(scene.q[0])
    np.testing.assert_allclose(mass @ found[2], [[1, -1, 0], [0, 1, -1], [0, 0, 1]], atol=1e-14)
    at_joints = forward_derivatives.derivatives(scene, at_joints=True)
    np.testing.assert_allclose(at_joints.cumsum(axis=1)[:2], found[:2] @ np.tri(3), atol=1e-12)
    np.testing.assert_allclose(at_joints.cumsum(axis=1)[2], found[2], atol=1e-14)


class Side:
    """A contender that answers with given accelerations."""

    def __init__(self, name, **answers):
        self.name, self.answers = name, {"none": [1.0, 2.0], **answers}

    def prepare(self, scene):
        if scene.effect not in self.answers:
            raise Unsupported(scene.effect)
        answer = np.array(self.answers[scene.effect])
        return type("Calls", (), {"outcome": lambda _: answer})()


def test_sides_that_disagree_or_do_not_feel_an_effect_are_not_compared():
    ours = Side("pendcore", viscous_joint=[1.5, 2.0])
    theirs = Side("mujoco_forward", viscous_joint=[1.5, 2.0 + 1e-8])
    assert effects.prepare([ours, theirs])[1]["viscous_joint"] == pytest.approx(5e-9)
    theirs.answers["viscous_joint"] = [1.5, 2.1]
    with pytest.raises(RuntimeError, match="not one scene"):
        effects.prepare([ours, theirs])
    theirs.answers["viscous_joint"] = [1.0, 2.0]
    with pytest.raises(RuntimeError, match="mujoco_forward does not feel it"):
        effects.prepare([theirs])
    effects.prepare([Side("mujoco_forward", joint_limit=[1.0, 2.0])])
