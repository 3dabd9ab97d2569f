"""How long runs stay valid for their work, and how that agrees with the Lyapunov exponents."""

from __future__ import annotations

import dataclasses
import json
import re
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pendcore as pc
import pytest
from chaotic_starts import EACH, chaotic_starts
from matplotlib.figure import Figure

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs/generators"))

E = pc.effects
BOOK = pc.Scene.textbook()
CHAOTIC = [-1.2, -0.6]
FEW = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12]


@pytest.fixture(scope="module")
def work() -> pc.HorizonWork:
    return pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 30), rtols=FEW)


def test_a_digit_buys_ln_10_over_lambda_seconds_on_average() -> None:
    """Neighbours do not part evenly, so one start says little; the mean over many has to be 1.

    The bound is Student's: with a probability of 99.9 %, the mean of that many numbers with that
    scatter lies within it of the true mean. It has to be so narrow that an exponent off by a tenth
    shows.
    """
    student = 3.75  # 24 degrees of freedom
    shares: dict[str, list[float]] = {}
    for case in chaotic_starts()[::2]:
        found = pc.horizon_work(case.scene, q0=case.q0, qd0=case.qd0, t_span=(0, 30), rtols=FEW)
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
    one = work.of("dop853")[1]
    run = pc.simulate(BOOK, q0=CHAOTIC, t_span=(0, 30), method="dop853", rtol=1e-6, atol=1e-9)
    assert run.valid_until(work.limit) == one.valid
    so_far = pc.simulate(
        BOOK, q0=CHAOTIC, t_span=(0, one.valid), method="dop853", rtol=1e-6, atol=1e-9, store="end"
    )
    assert so_far.stats.nfev == one.nfev


def test_its_text_says_it_all(work: pc.HorizonWork) -> None:
    lines = str(work).splitlines()
    assert lines[0] == "how long the angles stay within 0.1 rad"
    assert len(lines) == 3 + len(work.points)
    assert re.fullmatch(r"dopri5 +1e-04 +[\d.]+ s +\d+ us", lines[2])
    assert re.fullmatch(r"Lyapunov exponent [\d.]+/s: a digit more is worth [\d.]+ s", lines[-1])


def test_horizon_work_is_drawn(work: pc.HorizonWork) -> None:
    mpl.use("Agg")
    sheet = Figure()
    work.plot(sheet)
    by_digits, by_cost = sheet.axes
    assert len(by_digits.lines) == len(work.methods) + 1
    assert len(by_cost.lines) == len(work.methods)
    assert "rad" in by_digits.get_xlabel()
    assert "s" in by_cost.get_xlabel()
    assert sheet.legends
    assert not by_digits.get_legend()  # the legend stands outside, where it covers no point
    assert work.plot() is not None


def labels(axis: Any) -> list[Any]:
    """Return those labels of the x axis that are drawn."""
    ticks = axis.xaxis.get_majorticklabels() + axis.xaxis.get_minorticklabels()
    low, high = sorted(axis.get_xlim())
    return [x for x in ticks if x.get_text() and low <= x.get_position()[0] <= high]


def test_what_is_valid_to_the_end_is_marked_as_that() -> None:
    regular = pc.horizon_work(BOOK, q0=[1.5, 1.6], t_span=(0, 2), rtols=[1e-6, 1e-8])
    rows = str(regular).splitlines()[2:]
    assert len(rows) == 6
    assert all(re.fullmatch(r"\w+ +1e-0[68] +2.00 s +\d+ us  to the end", row) for row in rows)
    sheet = Figure()
    regular.plot(sheet)
    for axis in sheet.axes:
        hollow = [x for x in axis.lines if x.get_markerfacecolor() == "w" and len(x.get_xdata())]
        assert sum(len(line.get_xdata()) for line in hollow) == 6
    assert "hollow: to the end" in [x.get_text() for x in sheet.legends[0].get_texts()]


def test_it_says_what_there_was_no_time_for_and_why_there_is_no_exponent() -> None:
    calls = []

    def stop(fraction: float) -> None:
        calls.append(fraction)
        if len(calls) == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as raised:
        pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), rtols=FEW, progress=stop)
    found = raised.value.work  # type: ignore[attr-defined]
    assert found.untried[:2] == (("dopri5", 1e-10), ("dopri5", 1e-12))
    assert len(found.untried) == 12
    assert str(found).splitlines()[-1] == (
        "not tried before it was stopped: dopri5 at rtol 1e-10, 1e-12, dop853, taylor"
    )
    short = pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), rtols=FEW, time_limit=1e-9)
    assert "not tried before it was stopped: " in str(short)
    rubbed = pc.Scene(links=BOOK.links, effects=[E.DryJointFriction(joint=2, coulomb=1e-3)])
    found = pc.horizon_work(
        rubbed, q0=CHAOTIC, t_span=(0, 15), methods=["dopri5"], rtols=[1e-3, 1e-5]
    )
    told = " ".join(str(found).split())
    assert "no Lyapunov exponent: effect 1 (dry_joint_friction): motions jump or stick" in told
    assert found.refusal.startswith("effect 1 (dry_joint_friction)")


@pytest.mark.parametrize("spread", [1.05, 1.5, 3.0, 4.0, 9.0, 25.0, 90.0, 110.0, 1e3])
def test_the_labels_of_its_figure_do_not_meet(work: pc.HorizonWork, spread: float) -> None:
    count = len(work.points)
    points = tuple(
        point._replace(seconds=3.3e-5 * spread ** (k / (count - 1)))
        for k, point in enumerate(work.points)
    )
    sheet = Figure(figsize=(9.6, 4.2), layout="constrained")
    dataclasses.replace(work, points=points).plot(sheet)
    sheet.canvas.draw()
    for axis in sheet.axes:
        boxes = sorted((x.get_window_extent() for x in labels(axis)), key=lambda box: box.x0)
        assert len(boxes) >= 2
        for left, right in pairwise(boxes):
            assert left.x1 < right.x0


def test_where_nothing_grows_or_all_jumps_there_is_no_exponent() -> None:
    regular = pc.horizon_work(
        BOOK, q0=[1.5, 1.6], t_span=(0, 2), methods=["dopri5"], rtols=[1e-6, 1e-8]
    )
    assert [point.valid for point in regular.points] == [2.0, 2.0]
    assert np.isnan(regular.exponent)
    assert regular.seconds_a_digit == np.inf
    assert np.isnan(regular.measured("dopri5"))
    rubbed = pc.Scene(links=BOOK.links, effects=[E.DryJointFriction(joint=2, coulomb=1e-3)])
    found = pc.horizon_work(
        rubbed, q0=CHAOTIC, t_span=(0, 15), methods=["dopri5"], rtols=[1e-3, 1e-5]
    )
    assert found.growth is None
    assert found.points[0].valid < found.points[1].valid


def test_what_was_measured_so_far_is_not_lost() -> None:
    calls = []

    def stop(fraction: float) -> None:
        calls.append(fraction)
        if len(calls) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as raised:
        pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), rtols=FEW, progress=stop)
    assert len(raised.value.work.points) == 2  # type: ignore[attr-defined]
    assert raised.value.work.growth is None  # type: ignore[attr-defined]
    short = pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), rtols=FEW, time_limit=1e-9)
    assert len(short.points) <= 1


def test_who_stops_it_does_not_wait_for_exponents(monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(fraction: float) -> None:
        if fraction > 0.5:
            raise KeyboardInterrupt

    def pressed(*args: object, **named: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("pendcore.cost.horizon.lyapunov", pressed)
    options: dict[str, Any] = {"methods": "dopri5", "rtols": [1e-3, 1e-5, 1e-7]}
    with pytest.raises(KeyboardInterrupt) as raised:
        pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), progress=stop, **options)
    assert len(raised.value.work.points) == 2  # type: ignore[attr-defined]
    with pytest.raises(KeyboardInterrupt) as raised:  # during the exponents
        pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 10), **options)
    assert len(raised.value.work.points) == 3  # type: ignore[attr-defined]


def test_the_interrupt_has_no_run_that_nobody_asked_for() -> None:
    calls = 0

    def law(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls == 3000:
            raise KeyboardInterrupt
        return 0 * q

    scene = BOOK.replace(effects=[E.User(law)])
    with pytest.raises(KeyboardInterrupt) as raised:
        pc.horizon_work(scene, q0=CHAOTIC, t_span=(0, 10), rtols=FEW)
    assert raised.value.work.points == ()  # type: ignore[attr-defined]
    assert not {"solution", "estimate", "exponents"} & {*vars(raised.value)}


def test_one_method_need_not_be_in_a_list() -> None:
    found = pc.horizon_work(BOOK, q0=CHAOTIC, t_span=(0, 2), methods="RK45", rtols=[1e-6])
    assert found.methods == ["dopri5"]
    twice = pc.horizon_work(
        BOOK, q0=CHAOTIC, t_span=(0, 2), methods=["RK45", "dopri5"], rtols=[1e-6]
    )
    assert len(twice.points) == 1


def test_the_page_quotes_its_record() -> None:
    import horizon

    page = (ROOT / "docs/background/horizon.md").read_text()
    found = json.loads((ROOT / "docs/records/horizon.json").read_text())
    between = page.split(horizon.BEGIN)[1].split(horizon.END)[0]
    assert between == horizon.table(found)
    for one in found["trusted"]:
        next_known = np.array(one["right"]) + 1 / EACH
        assert (np.array(one["valid"]) < next_known).all()


def test_the_lines_of_the_page_run() -> None:
    mpl.use("Agg")
    page = (ROOT / "docs/background/horizon.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == 3
    names: dict[str, object] = {}
    for block in blocks[:2]:  # the tests above run what the third block shows
        exec(block, names)
    others = json.loads((ROOT / "docs/records/horizon.json").read_text())["neighbours"]
    wanted = pytest.approx(np.mean(others), abs=4 * np.std(others, ddof=1))
    assert names["found"].largest == wanted  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ({"limit": 0.0}, "limit = 0.0: must be > 0"),
        ({"limit": np.nan}, r"limit = nan: must be > 0 \(rad\)"),
        ({"methods": ["euler"]}, "methods: 'euler' is none: known are dopri5"),
        ({"methods": "auto"}, "methods: 'auto' is a rule that chooses one: known are dopri5"),
        ({"methods": []}, "methods: is empty: must name a method, or be left out"),
        ({"methods": 8}, "methods = 8: must be names of methods, or one"),
        (
            {"methods": "rk4"},
            "methods: 'rk4' takes fixed steps and has no tolerance .* must be of dopri5,",
        ),
        ({"rtols": [-1.0]}, r"rtols = \[-1.0\]: .* each be > 0 and < 1"),
        ({"rtols": []}, r"rtols = \[\]: must hold a tolerance"),
        ({"t_span": (0, np.inf)}, r"t_span\[1\] = inf: must be finite \(s\)"),
        ({"t_span": (0, np.nan)}, r"t_span\[1\] = nan: must be finite \(s\)"),
        ({"t_span": (0, 1, 2)}, r"t_span = \(0, 1, 2\): must be \(t_start, t_end\)"),
        ({"t_span": 5}, r"t_span = 5: must be \(t_start, t_end\)"),
        ({"t_span": (-1.7e308, 1.7e308)}, "t_span = .*: is inf s long: must be below"),
        ({"time_limit": np.nan}, r"time_limit = nan: must be > 0 \(s\)"),
        ({"time_limit": -1}, r"time_limit = -1.0: must be > 0 \(s\)"),
    ],
)
def test_bad_arguments_are_named(bad: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"t_span": (0, 1), "rtols": [1e-3], **bad}
    with pytest.raises((ValueError, TypeError), match=message):
        pc.horizon_work(BOOK, q0=CHAOTIC, **arguments)  # type: ignore[arg-type]
