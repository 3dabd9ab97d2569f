"""Pages are made of the record and nothing else, and each part of the comparison runs alone."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

# `make compare` asks for these, and `make test` alone does not; .ci/run has them.
pytest.importorskip("numba")
pytest.importorskip("scipy")

PROJECT = Path(__file__).parents[2]
sys.path.append(str(PROJECT / "bench" / "compare"))

import chains  # noqa: E402
import compare  # noqa: E402
import effects  # noqa: E402
import forward_tables  # noqa: E402
import overview_tables  # noqa: E402
import pages  # noqa: E402
import solve_tables  # noqa: E402
import solves  # noqa: E402
from contenders.contender import Unsupported  # noqa: E402
from contenders.programs import find_executable  # noqa: E402
from effect_list import parameters  # noqa: E402
from equal_error import compare as best_against_best  # noqa: E402
from pages import PAGES  # noqa: E402
from record import Record  # noqa: E402

DOCS = PROJECT / "docs"
RECORDS = {stem: Record.read(DOCS / PAGES[stem].record.format(stem)) for stem in compare.TIMED}
SOLVES = {stem: RECORDS[stem] for stem in (*overview_tables.NAMES, "stiff")}


@pytest.mark.parametrize("stem", RECORDS)
def test_written_page_is_what_the_record_says(stem: str) -> None:
    written = (DOCS / PAGES[stem].page.format(stem)).read_text(encoding="utf-8")
    assert pages.page(stem, RECORDS[stem]) == written


def test_page_on_all_solves_is_what_the_records_say() -> None:
    written = (DOCS / "comparison/README.md").read_text(encoding="utf-8")
    assert pages.overview(SOLVES) == written
    assert all(f"({stem}.md)" in written for stem in RECORDS)


@pytest.mark.parametrize("stem", overview_tables.NAMES)
def test_every_region_in_which_a_peer_wins_is_on_the_page_and_in_the_overview(stem: str) -> None:
    page, overview = pages.page(stem, RECORDS[stem]), pages.overview(SOLVES)
    _, who = solve_tables.solves_of(RECORDS[stem])
    lost = [at for at in best_against_best(who, pages.solve_tables.SIDES[0]) if at.lost]
    section = page.partition("## Where pendcore loses")[2].partition("## ")[0]
    for at in lost:
        assert re.search(rf"in C\+\+: .*{solve_tables.power(at.error)}", section)
    assert (f"({stem}.md) in C++:" in overview) == bool(lost)


def changed(stem: str, contender: str, **scaled: float) -> Record:
    """Return a record in which some metrics of a contender are multiplied."""
    record = RECORDS[stem]
    rows = record.rows()
    for row in rows:
        if row["contender"] == contender:
            row |= {key: row[key] * by for key, by in scaled.items() if row.get(key) is not None}
    return Record.of(record.measured, record.contenders, record.cases, rows)


@pytest.mark.parametrize(
    ("stem", "contender", "scaled", "told"),
    [
        ("textbook", "heyoka", {"minimum_us": 0.1}, "slower than the best peer at 1e-2 (heyoka"),
        ("textbook", "odeint_dopri5", {"minimum_us": 0.1}, "Boost.odeint dopri5 0.0310 us"),
        (
            "chains",
            "mujoco_parts",
            {"minimum_ns": 0.01},
            "n = 10: MuJoCo parts of mj_forward takes",
        ),
        ("chains", "pendcore", {"minimum_ns": 3.0}, "promised is at most 1/5: **missed**"),
        ("effects", "pendcore_step", {"instructions": 2.0}, "in C++ programs"),
        ("effects", "one_effect_more", {"instructions": 1.1}, "executes 168.3: **missed**"),
        ("effects", "mujoco_forward", {"minimum_ns": 1e-3}, "viscous joint in a call"),
    ],
)
def test_a_loss_is_told_where_the_record_has_one(
    stem: str, contender: str, scaled: dict[str, float], told: str
) -> None:
    assert told in pages.page(stem, changed(stem, contender, **scaled))


def test_growth_is_the_power_of_n_and_what_an_effect_adds_is_beside_its_own_bare_scene() -> None:
    grown = {n: 3.0 * n**1.5 for n in (2, 100, 300, 1000)}
    assert forward_tables.exponent(grown) == pytest.approx(1.5, rel=1e-12)
    assert forward_tables.exponent({2: 1.0, 100: 2.0}) is None
    record = RECORDS["effects"]
    bare, drag = (record.points("pendcore", case)[0] for case in ("none", "rod_drag"))
    more = drag["minimum_ns"] - bare["minimum_ns"]
    assert forward_tables.added(record, "rod_drag", "pendcore") == pytest.approx(more)
    assert f"{more:+.1f} ({more / bare['minimum_ns']:+.0%})" in pages.page("effects", record)
    assert forward_tables.exceeded(record, "rod_drag")[0] == "169 instructions in a call"


@pytest.mark.parametrize("stem", ["textbook", "chains", "effects"])
@pytest.mark.parametrize("left", [(), ("pendcore",), ("odeint", "mujoco")])
def test_pages_and_figures_are_made_whoever_took_part(
    stem: str, left: tuple[str, ...], tmp_path: Path
) -> None:
    record = RECORDS[stem]
    rows = [row for row in record.rows() if row["contender"].startswith(left or "nobody")]
    names = {row["contender"] for row in rows}
    contenders = {name: facts for name, facts in record.contenders.items() if name in names}
    few = Record.of(record.measured, contenders, record.cases, rows)
    few.write(tmp_path / PAGES[stem].record.format(stem))
    assert compare.main(["--only", stem, "--redraw", "--output", str(tmp_path)]) == 0
    page = tmp_path / PAGES[stem].page.format(stem)
    assert all(facts["about"] in page.read_text(encoding="utf-8") for facts in contenders.values())
    assert page.with_suffix(".png").stat().st_size > 1000


def test_a_record_comes_back_in_nine_digits(tmp_path: Path) -> None:
    row = {"contender": "a", "case": "b", "setting": 1e-3, "time": 1 / 3, "said": None}
    made = Record.of({"date": "today"}, {"a": {"label": "A"}}, {"b": {}}, [row])
    made.write(tmp_path / "one.json")
    found = Record.read(tmp_path / "one.json")
    assert found.points("a", "b") == [{"setting": 1e-3, "time": 0.333333333}]
    assert (found.measured, found.taking_part("b")[0]["label"]) == ({"date": "today"}, "A")


def test_an_interrupted_measurement_keeps_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def measure(stem: str, **_: Any) -> Record:
        if stem == "chains":
            raise KeyboardInterrupt
        return RECORDS[stem]

    monkeypatch.setattr(compare, "measure", measure)
    assert compare.main(["--only", "textbook", "chains", "--output", str(tmp_path)]) == 130
    written = {path.name for path in tmp_path.rglob("*.*")}
    assert written == {"textbook.json", "textbook.md", "textbook.png", "README.md"}


@pytest.mark.outside_build
def test_a_quick_run_of_solves_measures_whom_it_finds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = ("pendcore_dopri5", "pendcore_rk4", "pendcore_dopri5_cpp", "odeint_dopri5", "heyoka")
    chosen = {"takes_part": few.__contains__, "tightest": 1e-5, "facts": None}
    monkeypatch.setattr(solves.measure, "__kwdefaults__", chosen)
    monkeypatch.setenv("SOLVES_SUNDIALS", str(tmp_path / "nowhere"))
    assert compare.main(["--only", "textbook", "--quick", "--output", str(tmp_path)]) == 0
    record = Record.read(tmp_path / "records/comparison/textbook.json")
    page = (tmp_path / "comparison/textbook.md").read_text(encoding="utf-8")
    assert "not here: solves_sundials" in page
    assert {"pendcore_dopri5", "pendcore_rk4", "heyoka"} <= set(record.contenders) <= set(few)
    who = record.taking_part("textbook")
    (at,) = best_against_best(who, solve_tables.SIDES[-1], [1e-3])
    assert at.own
    assert at.peer
    assert all(one["one_step"]["minimum_us"] > 0 for one in who)


@pytest.mark.outside_build
def test_quick_runs_of_chains_and_effects_measure_pendcore(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    try:
        find_executable("forward_dynamics_pendcore")
    except ImportError as absence:
        pytest.skip(str(absence))
    for module in (chains, effects):
        monkeypatch.setattr(module, "BURST_SECONDS", 1e-4)
    monkeypatch.setattr(chains, "QUICK_LENGTHS", (2, 10, 100, 1000))
    for stem in ("chains", "effects"):
        assert compare.main(["--only", stem, "--quick", "--output", str(tmp_path)]) == 0
    links = Record.read(tmp_path / "records/comparison/chains.json")
    assert len(forward_tables.of_links(links, "pendcore", "minimum_ns")) == 4
    # No memory beyond O(n): ten times the links, ten times the bytes or less (if glibc tells).
    held = forward_tables.of_links(links, "pendcore", "bytes")
    assert not held or held[1000] < 11 * held[100]
    measured = Record.read(tmp_path / "records/comparison/effects.json")
    ours = {name for name, facts in measured.cases.items() if facts["ours"]}
    assert {name for name in measured.cases if measured.points("pendcore", name)} == ours


def test_every_effect_is_carried_by_the_side_that_says_so() -> None:
    pytest.importorskip("mujoco")
    import mujoco_models

    folder = Path(effects.__file__).parent / "contenders"
    for file in ("pendcore_forward.cpp", "mujoco_forward.cpp"):
        assert '"user"' in (folder / file).read_text()
    for one in effects.EFFECTS:
        of_core = parameters(one.name)
        carried = True
        for effect in of_core:
            rods = mujoco_models.chain([1.0, 1.0], [1.0, 1.0], 9.8)
            try:
                mujoco_models.add_effect(rods, effect, np.array([1.0, 0.0, 0.0]))
            except Unsupported:
                carried = False
        assert one.ours == bool(of_core or one.name == "user")
        assert bool(one.theirs) == carried, one.name
