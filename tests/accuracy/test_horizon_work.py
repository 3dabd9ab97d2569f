"""How long runs stay valid for their work, and how that agrees with the Lyapunov exponents."""

from __future__ import annotations

import re
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from chaotic_starts import chaotic_starts
from matplotlib.figure import Figure
from pendcore.plotting import LIGHT

BOOK = pc.Scene.textbook()
CHAOTIC = [-1.2, -0.6]
FEW = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12]


@pytest.fixture(scope="module")
def work() -> pc.HorizonWork:
    return pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 30), rtols=FEW)


@pytest.fixture(scope="module")
def regular() -> pc.HorizonWork:
    return pc.horizon_work(BOOK, q0=[1.5, 1.6], t_span=(0, 2), rtols=[1e-6, 1e-8])


def test_a_digit_buys_ln_10_over_lambda_seconds_on_average() -> None:
    """Neighbours do not part evenly, so one start says little; the mean over many has to be 1.

    The bound is Student's: with a probability of 99.9 %, the mean of that many numbers with that
    scatter lies within it of the true mean. It has to be so narrow that an exponent off by a tenth
    shows.
    """
    student = 3.75  # 24 degrees of freedom
    shares: dict[str, list[float]] = {}
    for case in chaotic_starts()[::2]:
        start = {"t_span": (0, 30), "q0": case.q0, "qd0": case.qd0}
        found = pc.horizon_work(case.scene, **start, rtols=FEW[::2])
        assert found.seconds_a_digit == pytest.approx(np.log(10) / found.exponent)
        for method in found.methods:
            shares.setdefault(method, []).append(found.measured(method) / found.seconds_a_digit)
    assert [*shares] == ["dopri5", "dop853", "taylor"]
    for method, of_starts in shares.items():
        assert len(of_starts) == 25
        bound = student * np.std(of_starts, ddof=1) / np.sqrt(25)
        assert bound < 0.1, method
        assert np.mean(of_starts) == pytest.approx(1, abs=bound), method


def test_every_point_is_a_run_of_its_own(work: pc.HorizonWork) -> None:
    assert work.early == min(point.valid for point in work.points)
    for method in work.methods:
        points = work.of(method)
        assert [point.rtol for point in points] == FEW
        # A looser tolerance may be luckier, but by less than the time in which errors grow by e.
        assert (np.diff([point.valid for point in points]) > -1 / work.exponent).all()
        assert (np.diff([point.early for point in points]) < 0).all()
        assert (np.diff([point.nfev for point in points]) > 0).all()
        assert all(1e-6 < point.seconds < 1 for point in points)
    one, how = work.of("dop853")[1], {"method": "dop853", "rtol": 1e-6, "atol": 1e-9}
    assert pc.simulate(BOOK, (0, 30), CHAOTIC, **how).valid_until(work.limit) == one.valid
    so_far = pc.simulate(BOOK, (0, one.valid), CHAOTIC, **how, store="end")
    assert so_far.stats.nfev == one.nfev


def test_its_figure_has_a_line_a_method_over_digits_and_over_time(work: pc.HorizonWork) -> None:
    sheet = Figure()
    assert work.plot() is not None
    plt.close("all")
    work.plot(sheet)
    by_digits, by_cost = sheet.axes
    assert len(by_digits.lines) == len(work.methods) + 1  # and what the exponent predicts
    assert len(by_cost.lines) == len(work.methods)
    assert "rad" in by_digits.get_xlabel()
    assert by_digits.get_ylabel() == f"time until an angle is off by {work.limit:g} rad (s)"
    assert "s" in by_cost.get_xlabel()


def test_what_is_valid_to_the_end_is_marked_as_that(regular: pc.HorizonWork) -> None:
    assert [point.valid for point in regular.points] == 6 * [2.0]
    rows = str(regular).splitlines()[2:]
    assert len(rows) == 6
    assert all(re.fullmatch(r"\w+ +1e-0[68] +2.00 s +\d+ us  to the end", row) for row in rows)
    sheet = Figure()
    regular.plot(sheet)
    for axis in sheet.axes:
        ground = LIGHT.ground
        hollow = [x for x in axis.lines if x.get_markerfacecolor() == ground and len(x.get_xdata())]
        assert sum(len(line.get_xdata()) for line in hollow) == 6
    assert "hollow: to the end" in [x.get_text() for x in sheet.legends[0].get_texts()]


def test_where_nothing_grows_there_is_no_exponent(regular: pc.HorizonWork) -> None:
    assert np.isnan(regular.exponent)
    assert regular.seconds_a_digit == np.inf
    assert np.isnan(regular.measured("dopri5"))


def test_where_motions_jump_there_is_no_exponent_and_it_says_why() -> None:
    rubbed = BOOK.replace(effects=[pc.effects.DryJointFriction(joint=2, coulomb=1e-3)])
    found = pc.horizon_work(rubbed, (0, 15), CHAOTIC, methods=["dopri5"], rtols=[1e-3, 1e-5])
    assert found.growth is None
    assert found.points[0].valid < found.points[1].valid
    assert found.refusal.startswith("effect 1 (dry_joint_friction)")
    told = " ".join(str(found).split())
    assert "no Lyapunov exponent: effect 1 (dry_joint_friction): motions jump or stick" in told


def test_what_was_measured_so_far_is_not_lost_and_the_rest_is_named() -> None:
    calls = []

    def stop(fraction: float) -> None:
        calls.append(fraction)
        if len(calls) == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as raised:
        pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), rtols=FEW, progress=stop)
    found = raised.value.work  # type: ignore[attr-defined]
    assert (len(found.points), found.growth) == (3, None)
    assert found.untried[:2] == (("dopri5", 1e-10), ("dopri5", 1e-12))
    assert len(found.untried) == 12
    assert str(found).splitlines()[-1] == (
        "not tried before it was stopped: dopri5 at rtol 1e-10, 1e-12, dop853, taylor"
    )
    short = pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), rtols=FEW, time_limit=1e-9)
    assert len(short.points) <= 1
    assert "not tried before it was stopped: " in str(short)


@pytest.mark.parametrize(("limit", "points"), [(0.5, 2), (np.inf, 3)])
def test_who_stops_it_does_not_wait_for_exponents(
    monkeypatch: pytest.MonkeyPatch, limit: float, points: int
) -> None:
    """The interrupt comes after two of three runs, or during the exponents."""

    def stop(fraction: float) -> None:
        if fraction > limit:
            raise KeyboardInterrupt

    def pressed(*args: object, **named: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("pendcore.cost.horizon.lyapunov", pressed)
    options: dict[str, Any] = {"methods": "dopri5", "rtols": [1e-3, 1e-5, 1e-7]}
    with pytest.raises(KeyboardInterrupt) as raised:
        pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), progress=stop, **options)
    assert len(raised.value.work.points) == points  # type: ignore[attr-defined]


@pytest.mark.parametrize("methods", ["RK45", ["RK45", "dopri5"]])
def test_methods_are_one_or_several_by_any_of_their_names(methods: Any) -> None:
    found = pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 2), methods=methods, rtols=[1e-6])
    assert [point.method for point in found.points] == ["dopri5"]
