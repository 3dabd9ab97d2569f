"""The comparison of chains rests on the dense answer, the ratios, and the promises' verdicts."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import chains
import chains_figure
import chains_page
from chain_scenes import ChainScene, chain_scene
from contenders.conversation import words
from contenders.forward_dynamics import described

MACHINE = {"machine": {"processor": "of the test"}, "date": "2026-01-01", "rounds": 3}


def two_rods(q: list[float], qd: list[float]) -> ChainScene:
    return ChainScene(
        masses=np.ones(2),
        lengths=np.ones(2),
        gravity=9.8,
        effect="none",
        q=np.array([q]),
        qd=np.array([qd]),
    )


def test_dense_equations_give_the_fall_of_two_rods_from_rest() -> None:
    level = chains.accelerations(two_rods([0.0, 0.0], [0.0, 0.0]))
    np.testing.assert_allclose(level, [9 * 9.8 / 7, -3 * 9.8 / 7], rtol=1e-14)


def test_dense_equations_feel_what_turning_links_pull() -> None:
    # cos(q_1 - q_2) = 0 and no weight: A_11 qdd_1 = -A_12 qd_2^2, A_22 qdd_2 = +A_12 qd_1^2
    scene = two_rods([np.pi / 2, 0.0], [2.0, 3.0])
    without_weight = ChainScene(
        masses=scene.masses,
        lengths=scene.lengths,
        gravity=0.0,
        effect="none",
        q=scene.q,
        qd=scene.qd,
    )
    found = chains.accelerations(without_weight)
    np.testing.assert_allclose(found, [-0.5 * 9 / (4 / 3), 0.5 * 4 / (1 / 3)], rtol=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3, 10, 100, 500])
def test_calls_go_through_a_power_of_two_of_states(n: int) -> None:
    scene = chain_scene(n)
    states = scene.q.shape[0]
    assert states >= 2
    assert states & (states - 1) == 0
    assert scene.qd.shape == scene.q.shape == (states, n)


def test_a_scene_is_written_so_that_it_reads_back_as_the_same_numbers() -> None:
    scene = chain_scene(3, "viscous_joint")
    effect, n, states, *numbers = described(scene).split()
    assert (effect, int(n), int(states)) == ("viscous_joint", 3, scene.q.shape[0])
    expected = [*scene.masses, *scene.lengths, scene.gravity, *scene.q.flat, *scene.qd.flat]
    assert [float(number) for number in numbers] == expected
    assert words([0.1, 1e-300]) == "0.1 1e-300"


def contender(name: str, times: dict[int, float]) -> dict[str, Any]:
    points = [
        {
            "n": n,
            "minimum_ns": time,
            "median_ns": 1.1 * time,
            "calls": 9,
            "bytes": int(80 * n + time),
            "disagreement": 1e-12,
        }
        for n, time in times.items()
    ]
    return {"name": name, "label": name, "about": "of the test", "stops": None, "points": points}


def record(*contenders: dict[str, Any]) -> dict[str, Any]:
    return {**MACHINE, "comparison": "chains", "contenders": list(contenders)}


OURS = contender("pendcore", {10: 100.0, 100: 1000.0, 1000: 10000.0})
STEPS = contender("pendcore_step", {10: 1.0, 100: 1.0})
SLOW = contender("slow", {10: 900.0, 100: 90000.0})
QUICK = contender("quick", {10: 600.0, 100: 7000.0})


def test_ratios_are_to_the_fastest_peer_and_never_to_pendcore_itself() -> None:
    label, *found = chains_page.ratios(record(OURS, STEPS, SLOW, QUICK), 10) or ("nobody",)
    assert label == "quick"
    assert found == [pytest.approx(1 / 6), pytest.approx(1 / 6)]
    assert chains_page.ratios(record(OURS, STEPS, SLOW, QUICK), 1000) is None


def test_a_promise_is_kept_or_missed_by_its_own_measure() -> None:
    at_10, at_100 = chains_page.bars(record(OURS, SLOW, QUICK))
    assert "1/6.0 of the time of quick" in at_10
    assert at_10.endswith("at most 1/5: kept.")
    assert at_100.endswith("at most 1/8: **missed**.")


def test_growth_is_the_power_of_n() -> None:
    grown = contender("pendcore", {n: 3.0 * n**1.5 for n in (2, 100, 300, 1000)})
    assert chains_page.exponent(record(grown), "pendcore") == pytest.approx(1.5, rel=1e-12)
    assert chains_page.exponent(record(SLOW), "pendcore") is None


def test_a_peer_that_is_quicker_is_named_as_a_loss() -> None:
    assert chains_page.losses(record(OURS, QUICK)) == ["* At none of these n."]
    ahead = contender("ahead", {10: 50.0})
    assert chains_page.losses(record(OURS, ahead)) == ["* n = 10: ahead takes 0.50 of its time."]


def test_memory_is_told_a_link_and_its_growth_from_first_to_last() -> None:
    steady = contender("pendcore", {10: 9.0, 100: 0.0, 1000: 0.0})
    assert "80 bytes a link at n = 100 and 80 at n = 1000: 1.00 times as much" in chains_page.held(
        record(steady)
    )
    square = contender("pendcore", {100: 100.0**2 - 8000, 1000: 1000.0**2 - 80000})
    assert "10.00 times as much for 10 times the links" in chains_page.held(record(square))
    assert "| 10 | 80.9 | 170 |" in chains_page.memory(record(steady, SLOW))


def test_figure_draws_of_a_peer_its_best_way_at_each_n() -> None:
    ways = (
        contender("pinocchio_local", {2: 5.0, 10: 9.0}),
        contender("pinocchio_world", {2: 4.0, 10: 11.0, 100: 7.0}),
        contender("pendcore", {2: 1.0}),
    )
    drawn = chains_figure.least(record(*ways), "pinocchio", "minimum_ns")
    assert drawn == [(2, 4.0), (10, 9.0), (100, 7.0)]
    assert chains_figure.least(record(STEPS), "pendcore", "minimum_ns") == []


@pytest.mark.parametrize("who", [(), (OURS,), (QUICK,), (OURS, QUICK)])
def test_page_and_figure_are_made_whoever_took_part(who: tuple[Any, ...], tmp_path: Path) -> None:
    assert "kept" in chains_page.page(record(*who)) or len(who) < 2
    chains_figure.draw(record(*who), tmp_path / "chains.png")
    assert (tmp_path / "chains.png").stat().st_size > 1000
