"""Pages are made of the record and nothing else, and each part of the comparison runs alone."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

PROJECT = Path(__file__).parents[2]
sys.path.append(str(PROJECT / "bench" / "compare"))
sys.path.append(str(PROJECT / "docs" / "generators"))

import chains  # noqa: E402
import compare  # noqa: E402
import effects  # noqa: E402
import excerpts  # noqa: E402
import forward_derivatives  # noqa: E402
import forward_tables  # noqa: E402
import overview_tables  # noqa: E402
import pages  # noqa: E402
import solve_tables  # noqa: E402
import solves  # noqa: E402
from contenders.contender import Unsupported  # noqa: E402
from contenders.programs import find_executable  # noqa: E402
from effect_list import parameters  # noqa: E402
from equal_error import compare as best_against_best  # noqa: E402
from page_part import with_part  # noqa: E402
from pages import PAGES  # noqa: E402
from record import Record  # noqa: E402

DOCS = PROJECT / "docs"
# `make compare` asks for these, and `make test` alone does not; .ci/run has them.
needs_contenders = pytest.mark.skipif(
    not (find_spec("numba") and find_spec("scipy")), reason="numba or SciPy is missing"
)
STEMS = (*compare.TIMED, "hard_cases")
RECORDS = {stem: Record.read(DOCS / PAGES[stem].record.format(stem)) for stem in STEMS}


def test_every_written_page_is_what_its_record_says():
    made = {PAGES[stem].page.format(stem): pages.page(stem, RECORDS[stem]) for stem in STEMS}
    solves = {stem: RECORDS[stem] for stem in (*overview_tables.NAMES, "stiff")}
    made["comparison/README.md"] = pages.overview(solves)
    for page, text in made.items():
        assert (DOCS / page).read_text(encoding="utf-8") == text, page
    for document, (name, excerpt) in excerpts.EXCERPTS.items():
        text = (PROJECT / document).read_text()
        assert with_part(text, name, excerpt(RECORDS["textbook"])) == text, document


def changed(stem, contender, **scaled):
    """Return a record in which some metrics of a contender are multiplied."""
    record = RECORDS[stem]
    rows = record.rows()
    for row in rows:
        if row["contender"] == contender:
            row |= {key: row[key] * by for key, by in scaled.items() if row.get(key) is not None}
    return Record.of(record.measured, record.contenders, record.cases, rows)


LOST = [
    ("textbook", "heyoka", {"minimum_us": 0.1}, "slower than the best peer at 1e-2 (heyoka"),
    ("chains", "mujoco_parts", {"minimum_ns": 0.01}, "n = 10: MuJoCo parts of mj_forward takes"),
    ("chains", "pendcore", {"minimum_ns": 3.0}, "promised is at most 1/5: **missed**"),
    ("derivatives", "pendcore", {"minimum_ns": 9.0}, "n = 2: Pinocchio, computeABADerivatives"),
    ("effects", "one_effect_more", {"instructions": 1.1}, "**missed**"),
    ("effects", "mujoco_forward", {"minimum_ns": 1e-3}, "viscous joint in a call"),
]


@pytest.mark.parametrize(("stem", "contender", "scaled", "told"), LOST)
def test_a_loss_is_told_where_the_record_has_one(stem, contender, scaled, told):
    assert told in pages.page(stem, changed(stem, contender, **scaled))
    assert told not in pages.page(stem, RECORDS[stem])


TOOK_PART = [("textbook", ("pendcore",)), ("chains", ("odeint", "mujoco")), ("effects", ())]


@needs_contenders
@pytest.mark.parametrize(("stem", "left"), TOOK_PART)
def test_pages_and_figures_are_made_whoever_took_part(stem, left, tmp_path):
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


@needs_contenders
def test_an_interrupted_measurement_keeps_what_it_has(tmp_path, monkeypatch):
    def measure(stem, **_):
        if stem == "chains":
            raise KeyboardInterrupt
        return RECORDS[stem]

    monkeypatch.setattr(compare, "measure", measure)
    assert compare.main(["--only", "textbook", "chains", "--output", str(tmp_path)]) == 130
    written = {path.name for path in tmp_path.rglob("*.*")}
    assert written == {"textbook.json", "textbook.md", "textbook.png", "README.md"}


@needs_contenders
@pytest.mark.outside_build
def test_a_quick_run_of_solves_measures_whom_it_finds(tmp_path, monkeypatch):
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


@needs_contenders
@pytest.mark.outside_build
def test_quick_runs_of_right_hand_sides_measure_pendcore(tmp_path, monkeypatch):
    try:
        find_executable("forward_dynamics_pendcore")
    except ImportError as absence:
        pytest.skip(str(absence))
    for module in (chains, forward_derivatives, effects):
        monkeypatch.setattr(module, "BURST_SECONDS", 1e-4)
    monkeypatch.setattr(chains, "QUICK_LENGTHS", (2, 10, 100, 1000))
    for stem in ("chains", "derivatives", "effects"):
        assert compare.main(["--only", stem, "--quick", "--output", str(tmp_path)]) == 0
    links = Record.read(tmp_path / "records/comparison/chains.json")
    assert len(forward_tables.of_links(links, "pendcore", "minimum_ns")) == 4
    # No memory beyond O(n): ten times the links, ten times the bytes or less (if glibc tells).
    held = forward_tables.of_links(links, "pendcore", "bytes")
    assert not held or held[1000] < 11 * held[100]
    linear = Record.read(tmp_path / "records/comparison/derivatives.json")
    errors = forward_tables.of_links(linear, "pendcore", "error")
    assert len(errors) == 3
    assert max(errors.values()) < 1e-12
    measured = Record.read(tmp_path / "records/comparison/effects.json")
    ours = {name for name, facts in measured.cases.items() if facts["ours"]}
    assert {name for name in measured.cases if measured.points("pendcore", name)} == ours


def test_every_effect_is_carried_by_the_side_that_says_so():
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
