"""A few hundred cases of `make fuzz`, and that the campaign sees what it is there to see."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from fuzz import campaign, claims
from fuzz.choices import FromSeed
from fuzz.drawn_run import TIME_LIMIT, Drawn, drawn
from fuzz.shrinking import breaches_alone, shrunk
from fuzz.verdict import of_case, of_seed
from pendcore.effects import KINDS

CASES = 400
SEED = "ci"


@pytest.fixture(scope="module")
def cases() -> list[Drawn]:
    """Return the cases of the reduced campaign."""
    found = []
    for i in range(CASES):
        try:
            found.append(drawn(FromSeed(f"{SEED}/{i}")))
        except ValueError:
            continue
    return found


def test_random_cases_end_in_time_and_keep_every_claim() -> None:
    """The whole campaign, of a hundred thousand cases, is `make fuzz`."""
    told = campaign.run(SEED, range(CASES))
    assert told.outcomes.total() == CASES
    assert not told.failed, campaign.report_of("", told, SEED, 0)
    assert 0 < told.longest[0] < 4 * TIME_LIMIT


def test_the_cases_are_of_every_kind(cases: list[Drawn]) -> None:
    assert len(cases) > 0.8 * CASES
    kinds = {effect.kind for case in cases for effect in case.scene.effects}
    assert kinds >= set(KINDS) - {"compiled_user"}
    assert {len(case.scene.links) for case in cases} == {1, 2, 3, 4, 5, 6}
    spans = np.array([case.t_span[1] - case.t_span[0] for case in cases])
    assert all(some.any() for some in (spans < 0, spans == 0, spans > 1e3))
    assert any(0 < abs(x) < 1e-10 for x in spans)


def test_a_case_is_its_seed() -> None:
    assert repr(of_seed("a/7")[0]) == repr(of_seed("a/7")[0]) != repr(of_seed("a/8")[0])


# A deliberate mistake of each sort is seen -----------------------------------------------------

WORKER = """
import json, os, sys, time
kind, _, first, end, stride = sys.argv[1:]
for case in range(int(first), int(end), int(stride)):
    print(json.dumps({"begins": case}), flush=True)
    if case == 5 and kind == "crash":
        os.abort()
    if case == 5 and kind == "hang":
        time.sleep(60)
    if case == 5 and kind == "exit":
        sys.exit(3)
    told = {"case": case, "outcome": "finished", "breaches": [], "seconds": 0.0}
    print(json.dumps(told), flush=True)
"""


@pytest.mark.parametrize(
    ("kind", "outcome"), [("crash", "crash"), ("hang", "hang"), ("exit", "crash")]
)
def test_a_worker_that_dies_or_hangs_names_its_case(
    kind: str, outcome: str, tmp_path: Path
) -> None:
    script = tmp_path / "worker.py"
    script.write_text(WORKER)
    worker = [sys.executable, str(script), kind]
    told = campaign.run("seed", range(3, 11), 2, worker, patience=1.5)
    assert told.outcomes == {"finished": 7, outcome: 1}
    assert [verdict["case"] for verdict in told.failed] == [5]


class Broken:
    """A solution like another one, except for the given entries."""

    def __init__(self, sol: pc.Solution, **changes: object) -> None:
        self._sol = sol
        self._changes = changes

    def __getattr__(self, name: str) -> object:
        return self._changes[name] if name in self._changes else getattr(self._sol, name)

    def __call__(self, t: object) -> object:
        return self._changes.get("at", self._sol)(t)


def case_of(**options: object) -> Drawn:
    return Drawn(
        pc.Scene.textbook(), [0.3, 1.0], [0.0, 0.0], (0.0, 0.5), {"max_steps": 500} | options
    )


NOT_FINITE = np.array([[0.3, 1.0, 0, 0], [np.nan, 1.0, 0, 0]]).T
MISTAKES = {
    "another status": (claims.says_how_it_ended, {"status": "splendid"}),
    "no message": (claims.says_how_it_ended, {"message": ""}),
    "a success that is none": (claims.says_how_it_ended, {"success": False}),
    "time runs back": (claims.times_run_one_way, {"t": np.array([0, 0.2, 0.1])}),
    "a NaN that is not said": (claims.is_finite, {"y": NOT_FINITE}),
    "dense output beside the steps": (
        claims.dense_output_meets_the_steps,
        {"at": lambda t: np.ones((4, len(t)))},
    ),
    "dense output of NaN": (
        claims.dense_output_meets_the_steps,
        {"at": lambda t: np.full((4, len(t)), np.nan)},
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_breach_is_seen(mistake: str) -> None:
    claim, changes = MISTAKES[mistake]
    case = case_of()
    sol = case.simulate()
    assert not list(claim(case, sol, FromSeed("x")))
    assert list(claim(case, Broken(sol, **changes), FromSeed("x")))


@pytest.mark.parametrize("claim", [claims.storing_changes_nothing, claims.resuming_changes_nothing])
def test_another_trajectory_is_seen(claim: claims.Claim) -> None:
    """The second run is one of other tolerances: what it must not depend on changes it."""
    case = case_of(rtol=1e-6, time_limit=5.0)
    other = case_of(rtol=1e-7, time_limit=5.0).simulate()
    assert not list(claim(case, case.simulate(), FromSeed("y")))
    assert list(claim(case, other, FromSeed("y")))


def test_a_failing_case_is_made_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """What makes it fail stays, the rest goes."""

    def no_spring(case: Drawn, sol: pc.Solution, _: object) -> list[str]:
        return ["a spring"] * any(e.kind == "torsional_spring" for e in case.scene.effects)

    monkeypatch.setattr("fuzz.verdict.ALWAYS", (no_spring,))
    fx = pc.effects
    rod = pc.Link(mass=2.0, length=0.3)
    scene = pc.Scene(
        links=[rod, rod, rod],
        gravity=3.0,
        effects=[fx.ViscousJoint(1, 0.1), fx.TorsionalSpring(1, 2.0), fx.RodDrag(3, 1.0, 0.1)],
    )
    options = {"max_steps": 50, "time_limit": 5.0, "rtol": 1e-7, "ledger": True}
    case = Drawn(scene, [0.3, 1.0, 2.0], [1.0, 0.0, 0.5], (0.0, 1.0), options)
    (breach,) = of_case(case, "seed").breaches
    small = shrunk(case, "seed", breach)
    assert [effect.kind for effect in small.scene.effects] == ["torsional_spring"]
    assert small.scene.links == (pc.Link(mass=1.0, length=1.0),)
    assert (small.q0, small.qd0) == ([0.0], [0.0])
    assert small.options == {"max_steps": 50, "time_limit": 5.0}


def test_a_breach_that_is_told_at_length_is_told_in_short(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pipe holds no more than 64 kB."""
    monkeypatch.setattr("fuzz.verdict.ALWAYS", (lambda *_: ["long: " + 70_000 * "x"],))
    (breach,) = breaches_alone(case_of(time_limit=5.0), "seed")
    assert breach.endswith("xxx")
    assert len(breach) < 1000
