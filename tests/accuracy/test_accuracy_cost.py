"""What `pc.accuracy_cost` and `pendcore cost` say about errors, times and choices is true."""

from __future__ import annotations

import json
import math
import pickle
import re

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from matplotlib.figure import Figure
from pendcore._accuracy.position_error import time_grid
from pendcore.cli import main
from pendcore.cost.point import Point, duration, front, seconds_at
from pendcore.cost.reference import reference
from pendcore.cost.runs import Start

BOOK = pc.Scene.textbook()
START = ((0, 5), [np.pi / 4, np.pi / 3])
E = pc.effects
PAIRS = tuple(one["name"] for one in pc._core.methods() if one["kind"] == "pair")
QUICK = {"repeats": 2, "rtol": [1e-3, 1e-6, 1e-9]}


@pytest.fixture(autouse=True)
def no_figure_left_over():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def book():
    return pc.accuracy_cost(BOOK, *START, repeats=3, name="the book's")


def tips(q, lengths):
    return np.cumsum(np.asarray(lengths) * np.exp(1j * np.asarray(q)), axis=-1)


def test_distances_are_those_of_joints_and_tip():
    rng = np.random.default_rng(1)
    lengths = [0.3, 2.0, 1.1]
    scene = pc.Scene(links=[pc.Link(mass=1, length=x) for x in lengths])
    q, r = rng.normal(size=(2, 50, 3))
    expected = abs(tips(q, lengths) - tips(r, lengths)).max(axis=-1) / sum(lengths)
    assert scene.distances(q, r) == pytest.approx(expected, rel=1e-13)
    assert scene.distances(q, q + 2 * np.pi).max() < 1e-14
    assert (scene.distances(q, q + np.array([1e-11, 0, 0])) >= 0).all()
    assert math.isnan(scene.distances([math.nan, 0, 0], [0, 0, 0]))


def test_a_grid_has_both_ends_and_no_time_twice():
    for start, end in ((0.0, 5.0), (5.0, 0.1), (1.0, 1.0 + 5e-15), (1.0, 1.0)):
        t = time_grid(start, end)
        assert (t[0], t[-1]) == (start, end)
        assert len(set(t)) == len(t) <= 101


@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-11])
def test_second_runs_tell_the_error_of_the_first(method, rtol, reference_case):
    known = reference_case("textbook")
    times = {"t_eval": known.t, "method": method, "rtol": rtol, "atol": rtol / 1000}
    first = pc.simulate(BOOK, *START, **times)
    found = first.estimate_error()
    assert not found.verified_by.startswith(method)
    true = abs(tips(first.q, [1, 1]) - tips(known.q, [1, 1])).max() / 2
    assert true <= found.largest <= 1.2 * true


def test_the_errors_are_those_against_multiple_precision(book, reference_case):
    known = reference_case("textbook")
    assert book.times == len(known.t)
    for point in book:
        chosen = {"rtol": point.rtol, "atol": point.atol} if point.rtol else {"step": point.step}
        sol = pc.simulate(BOOK, *START, method=point.method, t_eval=known.t, **chosen)
        true = abs(tips(sol.q, [1, 1]) - tips(known.q, [1, 1])).max() / 2
        assert abs(point.error - true) <= 1.5 * book.uncertainty
        assert (point.nfev, point.accepted) == (sol.stats.nfev, sol.stats.accepted)
    assert 1e-16 < book.uncertainty < 1e-13


def test_no_method_is_its_own_reference():
    start = Start(BOOK, START[1], 0, *START[0])
    found = reference(start, stiff=False, points=101, time_limit=10)
    assert found.first.method != found.second.method
    for solution in (found.first, found.second):
        assert found.error_of(solution) == found.uncertainty > 0


def test_every_method_is_there_at_every_tolerance(book):
    methods = {p.method for p in book}
    assert {"dopri5", "dop853", "rk4", "radau5"} <= methods
    assert "dopri5-radau5" not in methods  # the pair is dopri5 here, to the last bit
    for method in methods - {"rk4"}:
        assert [p.rtol for p in book if p.method == method] == [10.0**-k for k in range(2, 15)]
    steps = [p.step for p in book if p.method == "rk4"]
    assert np.allclose(np.divide(steps[:-1], steps[1:]), 2)
    loose = pc.simulate(BOOK, *START, method="dopri5", rtol=1e-3, atol=1e-6).stats.accepted
    assert steps[0] == pytest.approx(5 / math.ceil(loose / 2))  # twice as long as a loose run's
    assert all(p.repeats == 3 and 0 < p.seconds <= p.median < 1 for p in book)


def point(error, seconds):
    return Point(
        method="m", rtol=error, atol=0.0, step=None, error=error, seconds=seconds, median=seconds,
        repeats=1, nfev=1, accepted=1, failure="" if error < math.inf else "failed",
    )  # fmt: skip


def test_the_front_is_what_no_other_beats():
    rng = np.random.default_rng(2)
    points = [point(*x) for x in 10.0 ** -rng.uniform(0, 9, (60, 2))] + [point(math.inf, 1e-20)]
    found = front(points, 1e-8)
    for p in points[:-1]:
        clipped = max(p.error, 1e-8)
        beaten = [
            x
            for x in points[:-1]
            if (max(x.error, 1e-8) <= clipped and x.seconds < p.seconds)
            or (max(x.error, 1e-8) < clipped and x.seconds <= p.seconds)
        ]
        assert (p in found) == (not beaten)
    assert [p.seconds for p in found] == sorted(p.seconds for p in found)


def test_between_the_points_log_time_is_linear_in_log_error():
    curve = [point(1e-2, 1.0), point(1e-4, 100.0)]
    assert seconds_at(1e-3, curve, 0.0) == pytest.approx(10.0)
    assert seconds_at(1e-1, curve, 0.0) == 1.0
    assert seconds_at(1e-5, curve, 0.0) is None


def test_times_are_told_in_three_digits_and_the_unit_that_suits_them():
    told = {2.5e-6: "2.5 us", 9.994e-4: "999 us", 1e-3: "1 ms", 0.25: "250 ms", 12.34: "12.3 s"}
    assert {seconds: duration(seconds) for seconds in told} == told
    assert duration(np.nan) == "-"


def test_the_best_is_the_cheapest_that_keeps_the_error(book):
    for error in (1e-3, 1e-6, 1e-10):
        kept = [p for p in book if p.error + book.uncertainty <= error]
        assert book.best(error) == min(kept, key=lambda p: p.seconds)
    with pytest.raises(ValueError, match=r"error = 1e-17: nothing measured here reaches it"):
        book.best(1e-17)
    best = book.best(1e-6)
    advice = f"for 1e-06 of the length over 5 s take {best.method} at {best.setting}: "
    assert book.sentence(1e-6).startswith(advice)
    assert "ten times the accuracy" in book.sentence(1e-6)
    assert "nothing measured" in book.sentence(1e-17)


def test_it_pickles_and_becomes_strict_json(book, tmp_path):
    assert pickle.loads(pickle.dumps(book)) == book
    text = book.to_json(tmp_path / "cost.json")
    assert (tmp_path / "cost.json").read_text() == text + "\n"

    def refuse(name):
        raise AssertionError(f"{name} is no JSON")

    kept = json.loads(text, parse_constant=refuse)
    assert len(kept["points"]) == len(book)
    front = [(p["method"], p["rtol"], p["step"]) for p in kept["points"] if p["pareto"]]
    best = [(p.method, p.rtol, p.step) for p in book.pareto()]
    assert sorted(front, key=str) == sorted(best, key=str)


@pytest.mark.parametrize("y", ["time", "nfev"])
def test_the_figure_has_a_line_a_method_with_its_unit_and_shades_what_is_not_known(book, y):
    lines = book.plot(y=y)
    ax = lines[0].axes
    assert [line.get_label() for line in lines] == [*dict.fromkeys(p.method for p in book)]
    assert len({(line.get_linestyle(), line.get_marker()) for line in lines}) == len(lines)
    unit = re.search(r"time of a run \((\w+)\)", ax.get_ylabel())
    factor = {"\N{MICRO SIGN}s": 1e6, "ms": 1e3, "s": 1.0}[unit[1]] if unit else 1.0
    for line in lines:
        ours = [p for p in book if p.method == line.get_label()]
        assert line.get_xdata().tolist() == [p.error for p in ours]
        height = [factor * p.seconds if y == "time" else p.nfev for p in ours]
        assert line.get_ydata() == pytest.approx(height)
    assert "total length" in ax.get_xlabel()
    assert unit if y == "time" else ax.get_ylabel() == "right-hand sides (of taylor: expansions)"
    (known,) = [p for p in ax.patches if p.get_width()]
    assert known.get_bbox().x1 == pytest.approx(book.uncertainty)
    assert ax.get_legend().get_title().get_text().startswith("What accuracy costs: ")
    given = Figure().subplots()
    book.plot(given, y=y)
    assert given.get_legend().get_title().get_text() == ""


def test_the_figure_refuses_what_it_cannot_draw(book):
    for given, error in (({"y": "cost"}, ValueError), ({"ax": 3}, TypeError)):
        with pytest.raises(error, match=next(iter(given))):
            book.plot(**given)


def test_a_chaotic_span_is_cut_to_what_can_be_followed():
    found = pc.accuracy_cost(BOOK, q0=[-1.5, -1.4], t_span=(0, 100), **QUICK, methods=["dopri5"])
    assert found.asked_t_span == (0, 100)
    assert 10 < found.t_span[1] < 30
    assert found.uncertainty <= 1e-6
    assert "double precision follows this motion" in found.remarks[0]
    assert found.remarks[0] in " ".join(str(found).split())


PIECES = {
    "rubbed": [E.DryJointFriction(joint=j, coulomb=c) for j, c in ((1, 2.0), (2, 1.0))],
    "stopped": [E.JointStop(joint=2, range=(-0.5, 0.5), restitution=0.5)],
}


@pytest.mark.parametrize("kind", PIECES)
def test_scenes_in_pieces_are_measured_too(kind):
    scene = BOOK.replace(effects=PIECES[kind])
    found = pc.accuracy_cost(scene, q0=[0.7, 1.0], t_span=(0, 3), **QUICK)
    assert found.best(1e-5).error < 1e-5
    assert found.t_span == (0, 3)


def test_a_stiff_scene_is_measured_and_what_takes_too_long_says_so():
    scene = BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=1e7)])
    found = pc.accuracy_cost(scene, q0=[0.7, 1.0], t_span=(0, 5), **QUICK, time_limit=2.0)
    failed = {p.method: p for p in found if p.failure}
    assert "took more than" in failed["dopri5"].failure
    assert failed["dopri5"].error == math.inf
    assert len([p for p in found if p.method == "dopri5"]) == 1  # tighter runs would take longer
    assert any("tried: dopri5 at rtol 1e-06 and below, " in remark for remark in found.remarks)
    assert found.best(1e-5).method in ("radau5", *PAIRS)
    assert {"radau5", *PAIRS} <= {p.method for p in found if not p.failure}
    assert any("both references are radau5" in remark for remark in found.remarks)
    assert json.loads(found.to_json())["points"][0]["error"] is None


@pytest.mark.parametrize("limit", [0.45, -1.0])
def test_interrupted_it_hands_over_what_it_has(book, limit):
    def report(fraction):
        if fraction > limit:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        pc.accuracy_cost(BOOK, *START, progress=report, repeats=3)
    found = caught.value.accuracy_cost
    assert "interrupted" in found.remarks[-1]
    assert found.remarks[-1] in str(found)
    if limit > 0:
        assert 0 < len(found) < len(book)
        return
    assert (len(found), found.t_span, found.times) == (0, (0, 5), 0)
    assert "nothing was measured before it was stopped" in str(found)
    assert json.loads(found.to_json())["uncertainty"] is None
    found.plot()
    plt.gcf().draw_without_rendering()


def test_a_command_that_is_interrupted_before_it_has_a_point_says_so(tmp_path, monkeypatch, capsys):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pendcore.cli.cost.accuracy_cost", stop)
    assert main(["cost"]) == 1
    assert capsys.readouterr().err.endswith("pendcore cost: interrupted\n")
    assert not list(tmp_path.iterdir())


def test_progress_only_grows_and_what_looks_wrong_is_said_once():
    seen = []
    with pytest.warns(pc.PendcoreWarning) as caught:
        found = pc.accuracy_cost(
            BOOK, (0, 1), [45, 60], **QUICK, methods="DOP853", progress=seen.append
        )
    assert {p.method for p in found} == {"dop853"}  # one name need not be in a list
    assert len(caught) == 1
    assert seen == sorted(seen)
    assert (seen[0], seen[-1]) == (0.0, 1.0)


def test_the_command_writes_table_figure_and_json(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "swing.toml").write_text(pc.Case.textbook().to_toml())
    few = ["--methods", "dopri5,DOP853", "--repeats", "2"]
    assert main(["cost", "swing.toml", *few, "--error", "1e-4"]) == 0
    printed = capsys.readouterr().out
    assert (tmp_path / "out/swing/cost.txt").read_text() == printed
    assert "for 0.0001 of the length over 5 s take" in " ".join(printed.split())
    image = plt.imread(tmp_path / "out/swing/cost.png")[..., :3]
    assert (image < 0.5).any()
    assert image.max(axis=-1).min() > 0.1, "the house's ink is not black, which matplotlib's is"
    assert main(["cost", "-o", "here", *few, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((tmp_path / "here/cost.json").read_text())
    assert {p["method"] for p in printed["points"]} == {"dopri5", "dop853"}
    assert main(["cost", "--methods", "euler"]) == 2
    assert "euler" in capsys.readouterr().err
    for error in ("0", "-1", "nan"):
        assert main(["cost", "--error", error]) == 2
        assert "--error = " in capsys.readouterr().err
    assert not (tmp_path / "out/textbook").exists()
