"""What `make campaign OF=errors` claims holds on a few scenes of each family, and it sees mistakes.

`pytest --full` takes a few dozen of each; the whole of it is `make campaign OF=errors`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pendcore as pc
import pytest

pytest.importorskip("heyoka", reason="the references of true errors need heyoka")

from true_error import campaign, report
from true_error.asked import Drawn
from true_error.families import FAMILIES
from true_error.judge import Verdict, judged
from true_error.reference import Reference
from true_error.trajectory import NoReferenceError

pytestmark = pytest.mark.unsanitized
SEEDS = [
    range(100_000, 100_002),
    *(
        pytest.param(range(begin, end), marks=pytest.mark.whole)
        for begin, end in ((100_002, 100_008), (100_008, 100_016), (100_016, 100_024))
    ),
]
"""`make campaign OF=errors` has none of these seeds by default."""
SECONDS = 60.0
"""An answer may take this long, s: so few scenes must not time out on a busy machine."""


@pytest.mark.few_cases
@pytest.mark.every_value("family")
@pytest.mark.parametrize("seeds", SEEDS, ids=lambda seeds: f"{seeds.start}")
@pytest.mark.parametrize("family", FAMILIES)
def test_no_run_is_farther_off_than_it_says(family: str, seeds: range) -> None:
    found = list(campaign.verdicts([family], seeds, seconds=SECONDS))
    assert not report.broken(found), report.offenders({family: found})
    known = sum(verdict.true is not None for verdict in found)
    assert known >= 0.9 * sum(verdict.outcome == "kept" for verdict in found) > 0


@pytest.mark.parametrize("family", FAMILIES)
def test_a_scene_is_its_seed(family: str) -> None:
    one, again, other = (FAMILIES[family](seed) for seed in (7, 7, 8))
    assert repr(one) == repr(again) != repr(other)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_scenes_of_a_family_are_of_every_kind(family: str) -> None:
    drawn = [FAMILIES[family](seed) for seed in range(60)]
    links = {2, 3} if family == "short_links" else {1, 2, 3, 4, 5}
    assert {len(one.scene.links) for one in drawn} == links
    assert {name for one in drawn for name in one.options} >= {"t_eval", "store", "events"}
    assert any(one.t_start for one in drawn)
    goes_back = any(one.t_end < one.t_start for one in drawn)
    assert goes_back == (family not in ("contact", "stiff"))


# A deliberate mistake of each sort is seen -----------------------------------------------------


class Claiming:
    """A solution that makes other claims about itself than the true one."""

    def __init__(self, sol: pc.Solution, **claims: Any) -> None:
        self._sol, self._claims = sol, claims

    def __getattr__(self, name: str) -> Any:
        return self._claims[name] if name in self._claims else getattr(self._sol, name)

    def __call__(self, t: Any) -> Any:
        return self._sol(t)


@pytest.fixture
def drawn() -> Drawn:
    """Return the textbook's scene, about which everything is known."""
    return Drawn(
        family="mixed", seed=0, scene=pc.Scene.textbook(), q0=(0.8, 1.0), qd0=(0.0, 0.0),
        t_start=0.0, t_end=5.0, error=1e-7, rtol=1e-6, limit=1e-3,
    )  # fmt: skip


def test_what_is_right_is_no_fault(drawn: Drawn) -> None:
    found = judged(drawn)
    assert found.outcome == "kept"
    assert found.faults == []
    assert 0 < found.true < 1e-7  # type: ignore[operator]
    assert found.limit_known


@pytest.mark.parametrize("family", ["contact", "own"])
def test_an_error_that_is_not_what_is_told_is_above(family: str) -> None:
    def boasting(*scene_and_start: Any, error: float = 0.0, **options: Any) -> Any:
        if not error:
            return pc.simulate(*scene_and_start, **options)
        sol = pc.simulate(*scene_and_start, error=1e3 * error, **options)
        claims = {"asked": error, "achieved": error / 2, "outcome": "kept"}
        return Claiming(sol, accuracy=replace(sol.accuracy, **claims))

    scenes = [replace(FAMILIES[family](seed), error=1e-6) for seed in range(4)]
    assert "above" in {fault for one in scenes for fault in judged(one, boasting).faults}


class Bent(Claiming):
    """A solution that is off between the times that divide its run evenly.

    Such an error arises where a whole number of periods fills the run.
    """

    def __call__(self, t: Any) -> Any:
        y = self._sol(t).copy()
        y[0] += 3e-7 * np.sin(20 * np.pi * t)  # zero at each of 101 evenly spaced times
        return y


def denied(sol: pc.Solution) -> Claiming:
    estimate = sol.estimate_error()
    worse = replace(estimate, position=estimate.position + 2e-7)
    return Claiming(sol, estimate_error=lambda **_: worse)


def trusted(sol: pc.Solution) -> Claiming:
    return Claiming(sol, valid_until=lambda limit, **_: 5.0)


def broken(sol: pc.Solution) -> Claiming:
    raise RecursionError("too deep")


@pytest.mark.parametrize(
    ("mistake", "which", "fault"),
    [
        (Bent, "error", "above"),
        (denied, "error", "contradicted"),
        (trusted, "rtol", "late"),
        (broken, "error", "exceptions"),
        (broken, "rtol", "exceptions"),
    ],
)
def test_a_mistake_is_seen(drawn: Drawn, mistake: Any, which: str, fault: str) -> None:
    """One of the two runs of a scene, that with ``error`` or that with ``rtol``, has it."""

    def simulate(*scene_and_start: Any, **options: Any) -> Any:
        sol = pc.simulate(*scene_and_start, **options)
        return mistake(sol) if which in options else sol

    found = judged(replace(drawn, rtol=1e-4, limit=1e-7) if fault == "late" else drawn, simulate)
    assert found.faults == [fault]
    if fault == "above":
        assert found.true == pytest.approx(1.5e-7, rel=0.2)  # half of the length hangs on link 1
    if fault == "late":
        assert 0 < found.first_past < 5.0  # type: ignore[operator]
    if fault == "exceptions":
        assert found.exception == "RecursionError: too deep"


def test_what_hangs_is_told_and_ends_nothing(drawn: Drawn, monkeypatch: pytest.MonkeyPatch) -> None:
    def hanging(*_: Any, **__: Any) -> Any:
        while True:
            pass

    monkeypatch.setattr("true_error.judge.PATIENCE", 0.02)
    found = judged(drawn, hanging)
    assert found.exception.startswith("TimeoutError")


def test_a_reference_that_is_not_good_enough_says_so(drawn: Drawn) -> None:
    """By the end long doubles have lost the motion, and there is no time for more digits."""
    links = [pc.Link(mass=1.0, length=0.5)] * 3
    far = replace(
        drawn, scene=pc.Scene(links=links), q0=(-1.5, -1.2, -1.0), qd0=(0.0,) * 3, t_end=40.0,
        error=1e-4, options={"store": "end"},
    )  # fmt: skip
    t = np.array([40.0])
    assert Reference(far, 10.0).angles(t).unsure[0] > 1e-4
    with pytest.raises(NoReferenceError, match="the time was up"):
        Reference(far, 0.0).angles(t, finest=True)


def test_the_campaign_lists_what_repeats_an_offender(
    tmp_path: Any, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    worse = {"outcome": "kept", "true": 3.0, "achieved": 0.5, "asked": 1.0}
    monkeypatch.setattr(campaign, "of_case", lambda case: Verdict(case[0], case[1], 2, **worse))
    out, record = tmp_path / "o.json", tmp_path / "r.json"
    asked = ["--family", "mixed", "--seeds", "5:7", "--workers", "1"]
    assert campaign.main([*asked, "--output", str(out), "--record", str(record)]) == 1
    told = capsys.readouterr().out
    assert "--family mixed --seeds 6:7" in told
    assert "mixed: 2 of 2 above" in told
    assert '"above": 2' in record.read_text()
    assert out.read_text().count('"faults"') == 2
