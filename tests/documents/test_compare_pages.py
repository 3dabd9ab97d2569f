"""Each part of the comparison runs alone; pages are made of the record and nothing else."""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path
from typing import Any

import pytest

# `make compare` asks for these, and `make test` alone does not; .ci/run has them.
pytest.importorskip("numba")
pytest.importorskip("scipy")

PROJECT = Path(__file__).parents[2]
sys.path.append(str(PROJECT / "bench" / "compare"))

import chains  # noqa: E402
import compare  # noqa: E402
import effects  # noqa: E402
import equal_error  # noqa: E402
import overview  # noqa: E402
import page  # noqa: E402
import solves  # noqa: E402
import stiff_page  # noqa: E402
from contenders.conversation import find_executable  # noqa: E402
from work_precision import time_at  # noqa: E402

PAGES = PROJECT / "docs/comparison"
RECORDS = PROJECT / "docs/records/comparison"
COMPARISONS = compare.COMPARISONS


def read(stem: str) -> Any:
    return json.loads((RECORDS / f"{stem}.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", COMPARISONS)
def test_written_page_is_what_the_record_says(name: str) -> None:
    comparison = COMPARISONS[name]
    written = (PAGES / f"{comparison.stem}.md").read_text(encoding="utf-8")
    assert comparison.page(read(comparison.stem)) == written


def test_page_on_all_solves_is_what_the_records_say() -> None:
    known = {stem: read(stem) for stem in [*page.ABOUT, "stiff"]}
    written = (PAGES / "README.md").read_text(encoding="utf-8")
    assert overview.page(known) == written
    assert all(f"({stem}.md)" in written for stem in [*known, "chains", "effects", "ensembles"])


# The comparison is about these contenders; a record without one of them would miss its purpose.
FAMILIES = ("pendcore_dop", "pendcore_rk4", "odeint", "arkode", "cvode", "heyoka", "cyrk", "scipy")


@pytest.mark.parametrize("case", page.ABOUT)
def test_everybody_took_part_in_the_record(case: str) -> None:
    record = read(case)
    names = [one["name"] for one in record["contenders"]]
    assert all(any(family in name for name in names) for family in FAMILIES)
    assert {side for one in record["contenders"] for side in one["sides"]} >= {"compiled", "python"}
    assert record["machine"]["processor"]
    assert record["machine"]["instruction set of pendcore"].startswith("x86-64-v")
    points = [p for one in record["contenders"] for p in one["points"] if "error" in p]
    assert all(p["calls"] >= record["rounds"] >= 30 for p in points if p["minimum_us"] < 400)
    assert all(p["minimum_us"] <= p["median_us"] for p in points)


def ratios_to_scipy(record: dict[str, Any], kind: str) -> dict[float, list[float]]:
    """Return ratios of radau5's steps or times to each of SciPy's Radaus, at every common error."""
    who = {one["name"]: one for one in record["contenders"]}
    own = stiff_page.counted(who["pendcore_radau5"], kind)
    found: dict[float, list[float]] = {}
    for peer in ("scipy_radau_numba", "scipy_radau_python"):
        other = stiff_page.counted(who[peer], kind)
        for error in stiff_page.ERRORS:
            both = time_at(own, error), time_at(other, error)
            if both[0] and both[1]:
                found.setdefault(error, []).append(both[0] / both[1])
    return found


@pytest.mark.parametrize(("kind", "most"), [("steps", 2.0), ("minimum_us", 0.02)])
def test_stiff_scenes_take_few_steps_and_a_fiftieth_of_scipys_time(kind: str, most: float) -> None:
    scenes = read("stiff")["scenes"]
    assert [scene["case"] for scene in scenes] == ["damper", "spring", "controller"]
    for scene in scenes:
        found = ratios_to_scipy(scene, kind)
        assert set(found) >= {1e-3, 1e-4, 1e-5, 1e-6}, scene["case"]
        assert all(ratio <= most for each in found.values() for ratio in each), scene["case"]


@pytest.mark.parametrize("name", ["textbook", "chains", "effects"])
def test_another_figure_in_the_record_is_another_page(name: str, tmp_path: Path) -> None:
    stem = COMPARISONS[name].stem
    text = (RECORDS / f"{stem}.json").read_text(encoding="utf-8")
    record = json.loads(text)
    (first, *_) = record["contenders"]
    first["about"] = "changed by a test"
    changed = tmp_path / "records/comparison" / f"{stem}.json"
    changed.parent.mkdir(parents=True)
    changed.write_text(json.dumps(record), encoding="utf-8")
    assert compare.main(["--only", name, "--redraw", "--output", str(tmp_path)]) == 0
    written = tmp_path / "comparison" / f"{stem}.md"
    assert "changed by a test" in written.read_text(encoding="utf-8")
    assert written.with_suffix(".png").stat().st_size > 1000


def test_ctrl_c_ends_it_and_leaves_nothing_half_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(**_: Any) -> dict[str, Any]:
        raise KeyboardInterrupt

    stopped = dataclasses.replace(COMPARISONS["chains"], measure=interrupted)
    monkeypatch.setitem(COMPARISONS, "chains", stopped)
    assert compare.main(["--only", "chains", "--output", str(tmp_path)]) == 130
    assert list(tmp_path.iterdir()) == []


@pytest.mark.outside_build
def test_a_quick_run_of_solves_measures_whom_it_finds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = ("pendcore_dopri5", "pendcore_rk4", "pendcore_dopri5_cpp", "odeint_dopri5", "heyoka")
    chosen = {"takes_part": few.__contains__, "tightest": 1e-5}
    monkeypatch.setattr(solves.measure, "__kwdefaults__", chosen)
    monkeypatch.setenv("SOLVES_SUNDIALS", str(tmp_path / "nowhere"))
    assert compare.main(["--only", "textbook", "--quick", "--output", str(tmp_path)]) == 0
    record = json.loads((tmp_path / "records/comparison/textbook.json").read_text(encoding="utf-8"))
    assert "solves_sundials" in record["absent"]
    pages = tmp_path / "comparison"
    assert "not here: solves_sundials" in (pages / "textbook.md").read_text(encoding="utf-8")
    names = [one["name"] for one in record["contenders"]]
    assert {"pendcore_dopri5", "pendcore_rk4", "heyoka"} <= set(names) <= set(few)
    for at in equal_error.compare(record, equal_error.SIDES[-1], [1e-3]):
        assert at.own
        assert at.peer
        assert at.ratio == pytest.approx(at.own[0] / at.peer[0])
    assert (pages / "textbook.png").stat().st_size > 1000
    assert "(textbook.md)" in (pages / "README.md").read_text(encoding="utf-8")


@pytest.mark.outside_build
def test_quick_runs_of_chains_and_effects_measure_pendcore(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    try:
        find_executable("forward_dynamics_pendcore", "PENDCORE_FORWARD_DYNAMICS")
    except ImportError as absence:
        pytest.skip(str(absence))
    for module in (chains, effects):
        monkeypatch.setattr(module, "BURST_SECONDS", 1e-4)
    monkeypatch.setattr(chains, "QUICK_LENGTHS", (2, 10, 100, 1000))
    for name in ("chains", "effects"):
        assert compare.main(["--only", name, "--quick", "--output", str(tmp_path)]) == 0
    records = tmp_path / "records/comparison"
    links = json.loads((records / "chains.json").read_text(encoding="utf-8"))["contenders"]
    (own,) = (one for one in links if one["name"] == "pendcore")
    held = {point["n"]: point["bytes"] for point in own["points"]}
    assert list(held) == [2, 10, 100, 1000]
    assert all(point["minimum_ns"] > 0 for point in own["points"])
    # No memory beyond O(n): ten times the links, ten times the bytes or less
    # (None where no glibc tells).
    assert held[1000] is None or held[1000] < 11 * held[100]
    measured = json.loads((records / "effects.json").read_text(encoding="utf-8"))["effects"]
    assert {one["name"] for one in measured if "pendcore" in one["sides"]} == {
        effect.name for effect in (effects.BARE, *effects.EFFECTS) if effect.ours
    }
