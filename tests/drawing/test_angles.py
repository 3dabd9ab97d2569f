"""The figure is the textbook's: angles in degrees over time, red and blue, one axes each."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from matplotlib.colors import to_rgb
from pendcore.plotting import LIGHT

SCENE = pc.Scene.textbook()


@pytest.fixture(autouse=True)
def no_figure_left_over(monkeypatch):
    def show(*_, **__):
        raise AssertionError("a plot must not show itself")

    monkeypatch.setattr(plt, "show", show)
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def sol():
    return pc.Case.textbook().simulate()


def run(t_end=5, q0=1.0, **options):
    return pc.simulate(SCENE, (0, t_end), q0, **options)


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_labels_units_colors_and_curves_are_the_books(sol):
    lines = sol.plot()
    axes = [line.axes for line in lines]
    assert [ax.get_ylabel() for ax in axes] == ["$q_{1}$ (deg)", "$q_{2}$ (deg)"]
    assert [ax.get_xlabel() for ax in axes] == ["", "t (s)"]  # the time axis is shared
    assert [line.get_color() for line in lines] == [LIGHT.red, LIGHT.blue]
    assert axes[0] is not axes[1]
    assert axes[0].figure is axes[1].figure
    for i, line in enumerate(lines):
        t, angle = line.get_data()
        assert (t[0], t[-1]) == (0.0, 5.0)
        np.testing.assert_allclose(angle, np.rad2deg(sol(t)[i]), rtol=1e-14)
    assert angle[0] == pytest.approx(60)


@pytest.mark.parametrize(
    ("options", "first", "last"),
    [
        ({"rtol": 1e-3}, 0, 5),
        ({"rtol": 1e-3, "t_span": (5, 0)}, 5, 0),
        ({"t_eval": [1.0, 2.0, 4.0]}, 1, 4),
        ({"t_eval": [4.0]}, 0, 5),
        ({"store": "end"}, 0, 5),
    ],
    ids=str,
)
def test_curves_are_smooth_however_few_steps_or_times_are_kept(options, first, last):
    sol = pc.simulate(SCENE, **{"t_span": (0, 5), "q0": [0.5, 1.0]} | options)
    assert len(sol.t) < 100
    t = sol.plot()[0].get_xdata()
    assert (t[0], t[-1]) == (first, last)
    assert len(t) > 1000
    if "rtol" in options:
        assert set(sol.t) <= set(t)


def test_a_single_point_can_be_seen():
    line = pc.simulate(SCENE, q0=1.0, t_span=(5, 5)).plot()[0]
    assert len(line.get_xdata()) == 1
    assert line.get_marker() == "."


def test_it_draws_into_the_axes_it_is_given(sol):
    _, axes = plt.subplots(1, 2)
    assert [line.axes for line in sol.plot(ax=axes)] == list(axes)
    assert len(plt.get_fignums()) == 1
    rod = pc.Scene(links=[pc.Link(mass=1, length=1)])
    (line,) = pc.simulate(rod, q0=1.0, t_span=(0, 1)).plot()
    assert line.axes.get_ylabel() == "$q_{1}$ (deg)"
    assert len(line.figure.axes) == 1


@pytest.mark.parametrize("ax", ["axes", 5, [None, None]], ids=repr)
def test_what_is_no_axes_is_refused_by_name(sol, ax):
    with pytest.raises(TypeError, match=r"^ax = .*: must be matplotlib Axes, one, or 2"):
        sol.plot(ax=ax)


def test_a_wrong_number_of_axes_is_refused(sol):
    with pytest.raises(ValueError, match=r"^ax: 3 axes: must be one, or 2"):
        sol.plot(ax=plt.subplots(3, 1)[1])


def test_solutions_on_the_same_axes_can_be_told_apart(sol):
    first = sol.plot(label="rtol 1e-9")
    second = run().plot(ax=[line.axes for line in first], label="another start")
    for one, other in zip(first, second, strict=True):
        assert one.get_linestyle() != other.get_linestyle()
        assert legend(one.axes) == ["rtol 1e-9", "another start"]


def test_one_axes_takes_all_curves_of_all_solutions_and_names_them(sol):
    _, ax = plt.subplots()
    sol.plot(ax=ax)
    assert ax.get_ylabel() == "$q$ (deg)"
    assert legend(ax) == ["$q_{1}$", "$q_{2}$"]
    _, ax = plt.subplots()
    lines = [line for label in "abc" for line in sol.plot(ax=ax, label=label)]
    assert {line.axes for line in lines} == {ax}
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == 6
    assert set(legend(ax)) == {f"$q_{{{i}}}$, {run}" for run in "abc" for i in (1, 2)}


@pytest.mark.parametrize("names", [("color", "linestyle", "linewidth"), ("c", "ls", "lw")])
def test_lines_are_drawn_as_asked(sol, names):
    asked = dict(zip(names, ("tab:green", ":", 3.0), strict=True))
    for line in sol.plot(**asked):
        assert to_rgb(line.get_color()) == to_rgb("tab:green")
        assert (line.get_linestyle(), line.get_linewidth()) == (":", 3.0)


def test_rest_looks_like_rest_and_what_is_drawn_after_it_is_seen_whole(sol):
    hanging = run(q0=np.pi / 2).plot()
    axes = hanging[0].axes
    assert np.ptp(axes.get_ylim()) == pytest.approx(0.1)
    axes.figure.canvas.draw()
    assert axes.yaxis.get_major_formatter().get_offset() == ""
    sol.plot(ax=[line.axes for line in hanging])
    low, high = axes.get_ylim()
    angles = np.rad2deg(sol.q[:, 0])
    assert low < angles.min() < angles.max() < high


def test_late_times_are_written_out():
    """They do not appear as the last digits of an offset in the corner."""
    line = pc.simulate(SCENE, q0=1.0, t_span=(2e4, 2e4 + 1)).plot()[0]
    line.figure.canvas.draw()
    assert line.axes.xaxis.get_major_formatter().get_offset() == ""
