"""The comparison rests on these: the measure of error, the interpolation, the turns taken."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import tables
from cases import Case, one_step, read_case
from contenders.contender import Outcome, PythonRun, fixed_steps, tolerances
from measure import achieved, interleave
from trajectory_error import end_error, energy_error, position_error
from work_precision import envelope, reached_at, time_at

LENGTHS = np.array([1.0, 3.0])
POWER_LAW = [(10.0**-k, 5.0 * 10 ** (0.2 * k)) for k in range(1, 13)]  # time = 5 error^-1/5


def test_position_error_of_a_turned_link_is_its_chord_over_the_total_length() -> None:
    q = np.array([[0.3, 0.7], [0.4, 0.8]])
    turned = q + np.array([[0.0, 0.0], [0.0, 0.2]])
    chord = 2 * 3.0 * math.sin(0.1)
    assert position_error(turned, q, LENGTHS) == pytest.approx(chord / 4.0, rel=1e-12)


def test_position_error_sees_a_joint_that_is_off_while_the_tip_is_right() -> None:
    q, mirrored = np.array([[0.5, -0.5]]), np.array([[-0.5, 0.5]])
    expected = 2 * math.sin(0.5) / 2
    assert position_error(mirrored, q, np.ones(2)) == pytest.approx(expected, rel=1e-12)


def test_position_error_is_the_worst_moment_and_end_error_the_last() -> None:
    q = np.zeros((3, 2))
    off = q + np.array([[0.0, 0.0], [0.2, 0.2], [0.1, 0.1]])
    assert position_error(off, q, LENGTHS) == pytest.approx(2 * math.sin(0.1), rel=1e-12)
    assert end_error(off, q, LENGTHS) == pytest.approx(2 * math.sin(0.05), rel=1e-12)


@pytest.mark.parametrize(
    "name", ["textbook", "textbook_long", "high_energy", "unequal", "no_gravity", "three_links"]
)
def test_reference_trajectories_have_neither_position_error_nor_energy_error(name: str) -> None:
    case = read_case(name)
    masses, lengths = np.array(case.masses), np.array(case.lengths)
    q, qd = case.reference[:, : case.n], case.reference[:, case.n :]
    assert position_error(q, q, lengths) == 0
    assert energy_error(q, qd, masses, lengths, case.gravity) < 1e-14


def test_energy_error_of_a_lost_fall_is_the_height_over_the_length() -> None:
    q, qd = np.array([[0.0], [math.pi / 2]]), np.zeros((2, 1))
    assert energy_error(q, qd, np.array([2.0]), np.array([3.0]), 9.8) == pytest.approx(0.5)


def test_interpolation_is_exact_on_a_power_law() -> None:
    for error in (1e-1, 3e-4, 1e-7, 1e-12):
        assert time_at(POWER_LAW, error) == pytest.approx(5.0 * error**-0.2, rel=1e-12)


def test_order_of_the_points_does_not_matter() -> None:
    assert envelope(POWER_LAW[::-1]) == envelope(POWER_LAW) == POWER_LAW


def test_points_that_another_beats_in_both_are_left_out() -> None:
    points = [(1e-1, 1.0), (2e-2, 9.0), (1e-2, 2.0), (3e-2, 2.0), (1e-3, 4.0)]
    assert envelope(points) == [(1e-1, 1.0), (1e-2, 2.0), (1e-3, 4.0)]


def test_looser_errors_cost_the_loosest_point_and_tighter_ones_are_out_of_reach() -> None:
    assert time_at(POWER_LAW, 0.5) == POWER_LAW[0][1]
    assert time_at(POWER_LAW, 1e-13) is None
    assert time_at([], 1e-3) is None


def test_smallest_error_is_that_of_the_best_point() -> None:
    assert reached_at(POWER_LAW) == 1e-12
    assert reached_at([]) is None


def test_tolerances_hold_the_whole_decades_exactly() -> None:
    listed = tolerances(13, 4)
    assert listed[::4] == [float(f"1e-{k}") for k in range(1, 14)]
    assert len(listed) == 49
    assert listed == sorted(listed, reverse=True)


def test_fixed_steps_go_from_the_longest_to_the_shortest() -> None:
    steps = fixed_steps(0.1, 1e-4, 8)
    assert steps[0] == 0.1
    assert steps[8] == pytest.approx(1e-2)
    assert steps[-1] == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("value", "written"),
    [(0.6449, "0.645"), (9.996, "10.0"), (56.78, "56.8"), (123.4, "123"), (8765.0, "8765")],
)
def test_numbers_in_tables_have_three_digits_and_no_power_of_ten(
    value: float, written: str
) -> None:
    assert tables.number(value) == written


class Turn:
    """A run that notes its turns and takes as long as it is told."""

    def __init__(self, name: str, turns: list[str], seconds: list[float]) -> None:
        self.name, self.turns, self.seconds = name, turns, seconds

    def burst(self, seconds: float) -> list[float]:
        self.turns.append(self.name)
        return [self.seconds.pop(0)]

    def outcome(self) -> Outcome:
        raise RuntimeError("no states")


def test_every_run_has_one_turn_a_round_in_an_order_drawn_anew() -> None:
    turns: list[str] = []
    runs = {name: Turn(name, turns, [1.0] * 8) for name in "abcde"}
    interleave(runs, range(8), 0.0)
    rounds = ["".join(turns[k : k + 5]) for k in range(0, 40, 5)]
    assert all(sorted(order) == list("abcde") for order in rounds)
    assert len(set(rounds)) > 1


def test_timing_keeps_the_least_and_the_median_of_all_rounds() -> None:
    runs = {"a": Turn("a", [], [3.0, 1.0, 2.0, 9.0, 8.0])}
    timing = interleave(runs, range(5), 0.0)["a"]
    assert (timing.minimum, timing.median, timing.calls) == (1.0, 3.0, 5)


def test_slow_runs_have_fewer_turns_spread_over_all_rounds() -> None:
    turns: list[str] = []
    costs = {"quick": 0.001, "slow": 0.1, "endless": 2.0}
    runs = {name: Turn(name, turns, [cost] * 30) for name, cost in costs.items()}
    found = interleave(runs, range(30), 0.0, seconds_a_run=1.0)
    calls = {name: timing.calls for name, timing in found.items()}
    assert calls == {"quick": 30, "slow": 10, "endless": 3}
    late = turns[-14:]  # the turns of the last ten rounds
    assert late.count("slow") in (3, 4)
    assert "endless" in late


def test_first_call_of_a_burst_warms_up_unless_it_is_the_only_one() -> None:
    calls: list[int] = []
    run = PythonRun(solve=lambda: calls.append(1), read=lambda _: Outcome(np.zeros(0), None))
    assert len(run.burst(0.0)) == len(calls) == 1
    calls.clear()
    assert len(run.burst(1e-3)) == len(calls) - 1


def outcome_of(states: np.ndarray, case: Case) -> dict[str, object]:
    return achieved(PythonRun(solve=lambda: states, read=lambda s: Outcome(s, 7)), case)


def test_a_run_that_ends_early_or_in_nan_is_a_failure_not_an_error_of_zero() -> None:
    case = read_case("textbook")
    broken = case.reference.copy()
    broken[50, 1] = np.nan
    assert "failure" in outcome_of(broken, case)
    assert "failure" in outcome_of(case.reference[:-1], case)
    assert "failure" in achieved(Turn("a", [], []), case)
    assert outcome_of(case.reference, case)["error"] == 0


def test_the_fixed_cost_is_measured_on_the_same_start_over_a_ten_thousandth_of_a_second() -> None:
    case = one_step(read_case("textbook"))
    np.testing.assert_array_equal(case.times, [0.0, 1e-4])
    np.testing.assert_array_equal(case.start, read_case("textbook").start)
