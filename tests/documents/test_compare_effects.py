"""The comparison of effects rests on differences from the bare scene, and on the verdicts."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import effects
import effects_figure
import effects_page
from contenders.contender import Unsupported

CONTENDERS = Path(effects.__file__).parent / "contenders"
OURS = {"pendcore": 20.0, "pendcore_step": 21.0, "pendcore_run": 22.0}
THEIRS = {"mujoco_forward": 400.0, "mujoco_run": 500.0}
SIDES = OURS | THEIRS
ALIKE = {"scene": 160.0, "kernel": 160.0, "one_effect_more": 160.0}


def effect(name: str, more: dict[str, float], **other: Any) -> dict[str, Any]:
    """Make an effect that adds `more` to the bare times, and as many instructions as said."""
    counted = {"call": 100 + other.pop("instructions", 0), "step": 100}
    return {
        "name": name,
        "label": name,
        "theirs": "theirs",
        "ours": True,
        "most_ns": 6,
        "most_instructions": 60,
        "sides": {
            side: {"minimum_ns": time + more.get(side, 0.0), "median_ns": time, "calls": 9}
            for side, time in SIDES.items()
            if side not in other.get("without", ())
        },
        "disagreement": 1e-12,
        "instructions": counted,
        **other,
    }


def record(*listed: dict[str, Any]) -> dict[str, Any]:
    return {
        "comparison": "effects",
        "date": "2026-01-01",
        "rounds": 3,
        "machine": {"processor": "of the test"},
        "contenders": [{"name": side, "label": side, "about": ""} for side in SIDES],
        "bare_instructions": ALIKE,
        "effects": [effect("none", {}), *listed],
    }


def test_what_is_added_is_the_difference_to_the_same_sides_bare_scene() -> None:
    one = effect("one", {"pendcore": 2.0, "mujoco_forward": 40.0})
    made = record(one)
    assert effects_page.added(made, one, "pendcore") == pytest.approx(2.0)
    assert effects_page.share(made, one, "pendcore") == pytest.approx(0.1)
    assert effects_page.added(made, one, "mujoco_forward") == pytest.approx(40.0)
    assert effects_page.share(made, one, "mujoco_forward") == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("more", "instructions", "verdict"),
    [
        ({"pendcore": 6.0, "pendcore_step": 5.9}, 60, "kept"),
        ({"pendcore": 6.1}, 60, "6.1 ns in a call"),
        ({"pendcore_step": 9.0}, 0, "9.0 ns in a step"),
        ({}, 61, "61 instructions in a call"),
    ],
)
def test_a_promise_is_broken_by_time_or_by_instructions(
    more: dict[str, float], instructions: int, verdict: str
) -> None:
    one = effect("one", more, instructions=instructions)
    assert effects_page.verdict(record(one), one) == verdict
    assert ("adds more than promised" in effects_page.page(record(one))) == (verdict != "kept")


def test_an_effect_that_was_not_measured_keeps_no_promise() -> None:
    one = effect("one", {}, without=("pendcore",))
    assert effects_page.verdict(record(one), one) == "not measured"


@pytest.mark.parametrize(
    ("counted", "verdict"),
    [
        (ALIKE, "160.0: kept."),
        (ALIKE | {"one_effect_more": 161.0}, "161.0: **missed**."),
        (ALIKE | {"kernel": 150.0}, "160.0: **missed**."),
        ({}, "Not counted."),
    ],
)
def test_absent_costs_nothing_only_if_all_three_counts_are_alike(
    counted: dict[str, float], verdict: str
) -> None:
    assert effects_page.absent(record() | {"bare_instructions": counted}).endswith(verdict)


def test_an_effect_that_costs_more_than_the_peers_is_named_as_a_loss() -> None:
    one = effect("one", {"pendcore": 3.0, "mujoco_forward": 1.0})
    assert "* one in a call: 3.0 ns here, 1.0 ns there." in effects_page.losses(record(one))


def test_page_and_figure_are_made_whoever_took_part(tmp_path: Path) -> None:
    for without in ((), tuple(OURS), tuple(THEIRS), tuple(SIDES)):
        one = effect("one", {"pendcore": 1.0}, without=without)
        made = record(one, effect("two", {}, most_ns=None, instructions=0) | {"instructions": {}})
        assert "| one |" in effects_page.page(made)
        effects_figure.draw(made, tmp_path / "effects.png")
        assert (tmp_path / "effects.png").stat().st_size > 1000


def test_every_effect_is_carried_by_one_of_the_two_sides() -> None:
    carried = {
        side: set(re.findall(r'(?:name|effect) == "(\w+)"', (CONTENDERS / file).read_text()))
        for side, file in (("ours", "pendcore_forward.cpp"), ("theirs", "mujoco_scene.cpp"))
    }
    for one in effects.EFFECTS:
        assert one.name in carried["ours"] | carried["theirs"]
        assert one.ours == (one.name in carried["ours"])
        assert bool(one.theirs) == (one.name in carried["theirs"])


class Side:
    """A contender that answers with given accelerations."""

    def __init__(self, name: str, answers: dict[str, list[float]]) -> None:
        self.name, self.answers = name, answers

    def prepare(self, scene: Any) -> Any:
        if scene.effect not in self.answers:
            raise Unsupported(scene.effect)
        answer = np.array(self.answers[scene.effect])
        return type("Calls", (), {"accelerations": lambda _: answer})()


BARE = {"none": [1.0, 2.0]}


def test_two_sides_that_disagree_are_not_compared() -> None:
    ours: Any = Side("pendcore", BARE | {"viscous_joint": [1.5, 2.0]})
    theirs: Any = Side("mujoco_forward", BARE | {"viscous_joint": [1.5, 2.0 + 1e-8]})
    _, apart = effects.prepare([ours, theirs])
    assert apart["viscous_joint"] == pytest.approx(5e-9)
    theirs.answers["viscous_joint"] = [1.5, 2.1]
    with pytest.raises(RuntimeError, match="not one scene"):
        effects.prepare([ours, theirs])


def test_an_effect_that_a_side_does_not_feel_is_not_compared() -> None:
    unfelt: Any = Side("mujoco_forward", BARE | {"viscous_joint": [1.0, 2.0]})
    with pytest.raises(RuntimeError, match="mujoco_forward does not feel it"):
        effects.prepare([unfelt])
    unfelt = Side("mujoco_forward", BARE | {"joint_limit": [1.0, 2.0]})
    effects.prepare([unfelt])
