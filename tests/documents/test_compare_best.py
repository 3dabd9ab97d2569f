"""Best is compared with best: who with whom, at which errors, and what is said of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import equal_error
import excerpts
import figure
import overview
import page
import tables
from equal_error import SIDES, bar, compare

IN_CPP, HELD_BACK, IN_PYTHON = SIDES


def contender(
    name: str, times: dict[float, float], sides: tuple[str, ...], **other: Any
) -> dict[str, Any]:
    """Make a contender whose settings are its errors; a peer's median is four minima, ours two."""
    ours = name.startswith("pendcore")
    return {
        "name": name,
        "label": name,
        "about": "made up",
        "ours": ours,
        "sides": list(sides),
        "setting": "tolerance",
        "compile_seconds": None,
        "one_step": {"evaluations": 7, "minimum_us": 1.0, "median_us": 2.0, "calls": 9},
        "points": [
            {
                "setting": error,
                "error": error,
                "end_error": error,
                "energy_error": None,
                "evaluations": 100,
                "steps": None,
                "minimum_us": time,
                "median_us": (2 if ours else 4) * time,
                "calls": 30,
            }
            for error, time in times.items()
        ],
        **other,
    }


LOW = contender("pendcore_dopri5_cpp", {1e-2: 1.0, 1e-4: 10.0, 1e-6: 100.0}, ("compiled",))
HIGH = contender("pendcore_dop853_cpp", {1e-2: 4.0, 1e-4: 8.0, 1e-9: 20.0}, ("compiled",))
NARROW = contender("pendcore_dopri5_cpp_v3", {1e-2: 3.0, 1e-6: 300.0}, ("compiled_v3",))
PYTHON = contender("pendcore_dopri5", {1e-2: 2.0, 1e-6: 100.0}, ("python",))
BOOST = contender("odeint_dopri5", {1e-2: 2.0, 1e-4: 20.0, 1e-5: 60.0}, ("compiled",))
BOTH = contender("heyoka", {1e-3: 12.0, 1e-12: 12.0}, ("compiled", "python"))
EVERYBODY = (LOW, HIGH, NARROW, PYTHON, BOOST, BOTH)


def record(*contenders: dict[str, Any], **other: Any) -> dict[str, Any]:
    return {
        "case": "textbook",
        "date": "2026-01-01",
        "rounds": 30,
        "duration": 5.0,
        "times": 101,
        "uncertainty": 1e-30,
        "machine": {"processor": "of the test", "instruction set of pendcore": "x86-64-v4"},
        "absent": {},
        "contenders": list(contenders),
        **other,
    }


def test_the_best_of_each_side_is_the_quickest_at_that_error() -> None:
    loose, middle, tight, out = compare(record(*EVERYBODY), IN_CPP, [1e-2, 1e-4, 1e-9, 1e-12])
    assert (loose.own, loose.peer) == ((1.0, "pendcore_dopri5_cpp"), (2.0, "odeint_dopri5"))
    assert (middle.own, middle.peer) == ((8.0, "pendcore_dop853_cpp"), (12.0, "heyoka"))
    assert (tight.own, tight.peer) == ((20.0, "pendcore_dop853_cpp"), (12.0, "heyoka"))
    assert [at.ratio for at in (loose, middle, tight)] == pytest.approx([0.5, 8 / 12, 20 / 12])
    assert loose.of_medians == pytest.approx(0.25)
    assert (out.own, out.ratio, out.reached) == (None, None, False)
    assert out.peer == (12.0, "heyoka")


def test_sides_do_not_mix() -> None:
    (narrow,) = compare(record(*EVERYBODY), HELD_BACK, [1e-2])
    assert (narrow.own, narrow.peer) == ((3.0, "pendcore_dopri5_cpp_v3"), (2.0, "odeint_dopri5"))
    (python,) = compare(record(*EVERYBODY), IN_PYTHON, [1e-2])
    assert (python.own, python.peer) == ((2.0, "pendcore_dopri5"), (12.0, "heyoka"))


def test_goal_is_half_and_in_cpp_six_tenths_above_1e_5() -> None:
    assert [bar(IN_CPP, error) for error in (1e-2, 1e-4, 1e-5, 1e-13)] == [0.6, 0.6, 0.5, 0.5]
    assert [bar(HELD_BACK, error) for error in (1e-4, 1e-5)] == [0.6, 0.5]
    assert [bar(IN_PYTHON, error) for error in (1e-2, 1e-13)] == [0.5, 0.5]


@pytest.mark.parametrize(("own", "reached"), [(1.19, True), (1.21, False)])
def test_a_goal_is_reached_by_the_ratio_or_by_being_alone(own: float, reached: bool) -> None:
    quick = contender("pendcore_dopri5_cpp", {1e-2: own, 1e-6: 2.0}, ("compiled",))
    both, alone = compare(record(quick, BOOST), IN_CPP, [1e-2, 1e-6])
    assert both.reached == reached
    assert (alone.peer, alone.reached) == (None, True)
    written = tables.best_against_best(record(quick, BOOST), IN_CPP)
    assert written.splitlines()[2].endswith("0.6 reached |" if reached else "0.6 missed |")
    assert "pendcore alone" in written.splitlines()[6]


def test_one_that_fails_at_every_setting_is_on_the_page_and_in_no_table(tmp_path: Path) -> None:
    failed = {**LOW, "points": [{"setting": 1e-2, "failure": "too stiff"}], "one_step": None}
    made = record(failed, BOOST)
    assert compare(made, IN_CPP, [1e-2])[0].own is None
    assert "* pendcore_dopri5_cpp at 1e-2: too stiff." in page.page(made)
    assert len(tables.fixed_cost(made).splitlines()) == 2 + 1
    figure.draw(made, tmp_path / "textbook.png")


def test_settings_that_failed_are_no_points() -> None:
    failed = {"setting": 1e-9, "failure": "not run"}
    cut = {**LOW, "points": [*LOW["points"], failed]}
    assert equal_error.curve(cut) == equal_error.curve(LOW)
    assert "* pendcore_dopri5_cpp at 1e-9: not run." in page.page(record(cut))


def test_failures_that_differ_in_time_alone_are_one_line() -> None:
    points = [{"setting": 10.0**-k, "failure": f"too small (at t = {k} s)."} for k in (1, 2, 3)]
    (line,) = page.failures(record({**LOW, "points": points}))
    assert line == "* pendcore_dopri5_cpp at 1e-1 to 1e-3: too small."


def test_a_loss_is_named_on_the_page_and_in_the_overview() -> None:
    lines = page.losses(record(*EVERYBODY))
    assert "1e-9 (heyoka: x 1.67)" in lines[0]
    assert "does not get to 1e-10 (heyoka), 1e-11 (heyoka), 1e-12 (heyoka)" in lines[1]
    written = overview.page({"textbook": record(*EVERYBODY)})
    assert "* **heyoka**. It compiles" in written
    assert "the first time on a machine" in written
    assert "[textbook, 5 s](textbook.md) in C++: from 1e-7 to 1e-12" in written
    nowhere = record(contender("pendcore_dop853_cpp", {1e-13: 0.1}, ("compiled",)), BOOST)
    assert page.losses(nowhere) == []
    assert "* Nowhere among these" in overview.page({"textbook": nowhere})


def test_a_call_that_costs_more_is_named() -> None:
    cheap = {**BOOST, "one_step": {**BOOST["one_step"], "minimum_us": 0.3}}
    (line,) = page.dearer_calls(record(LOW, cheap))
    assert line == (
        "* in C++: a call of one step costs 1.00 us or more, and less with odeint_dopri5 0.300 us."
    )


def test_what_to_choose_is_the_best_method_of_each_error() -> None:
    written = overview.choice({"textbook": record(*EVERYBODY)})
    assert "dopri5_cpp` from 1e-2 to 1e-3" in written
    assert "dop853_cpp` from 1e-4 to 1e-9" in written


def test_everybody_has_a_row_with_the_smallest_error() -> None:
    rows = tables.everybody(record(*EVERYBODY), "compiled").splitlines()
    assert rows[2].startswith("| pendcore_dopri5_cpp | 1.00 | 3.16 | 10.0 |")
    assert rows[2].endswith("| — | 1e-6 |")
    assert len(rows) == 2 + 4


def test_heyokas_compile_time_and_the_missing_are_told() -> None:
    waiting = {**BOTH, "compile_seconds": [0.0123, 1.5]}
    written = page.page(record(LOW, waiting, absent={"solves_sundials": "not built"}))
    assert "compiles for 0.012 to 1.5 s, which is in no figure here" in written
    assert "* not here: solves_sundials: not built" in written


def test_the_readme_quotes_best_against_best() -> None:
    quoted = excerpts.figures(record(*EVERYBODY)).splitlines()
    assert quoted[2].startswith("| 1e-3 of the length | 3.16 us, pendcore_dopri5_cpp | 6.32 us, ")
    assert "1.00 us in C++, 1.00 us from Python" in excerpts.figures(record(*EVERYBODY))


@pytest.mark.parametrize("who", [(), (LOW,), (BOOST,), (LOW, BOOST), EVERYBODY])
def test_pages_and_figures_are_made_whoever_took_part(who: Any, tmp_path: Path) -> None:
    assert page.page(record(*who)).startswith("# What accuracy costs: textbook")
    assert page.summary(record(*who))
    assert overview.page({"textbook": record(*who)})
    figure.draw(record(*who), tmp_path / "textbook.png")
    assert (tmp_path / "textbook.png").stat().st_size > 1000


def test_every_contender_has_a_family_and_a_marker_of_its_own() -> None:
    names = [
        *("pendcore_dopri5_cpp", "pendcore_dop853_cpp", "pendcore_rk4_cpp", "pendcore_radau5_cpp"),
        *("pendcore_taylor_cpp", "odeint_dopri5", "odeint_rkf78", "arkode_dopri5"),
        *("arkode_verner6", "arkode_rkf78", "cvode_adams", "cvode_bdf", "heyoka"),
    ]
    styles = [figure.style(name) for name in names]
    assert all(one["marker"] != "h" for one in styles)
    looks = {(str(one["linestyle"]), one["linewidth"], one["marker"]) for one in styles}
    assert len(looks) == len(names), "two of them look alike without colour"
