"""Figures of ensembles take the axes, the scale and the properties that fit, and refuse others."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

BOOK = pc.Scene.textbook()


@pytest.fixture(scope="module")
def swept():
    """Twenty starts, of which the first falls through an angle 10^4 times as soon as the last."""
    below = pc.events.LinkAngle(1, 0.5)
    starts = [[0.5 - x, 1.0] for x in np.geomspace(1e-8, 0.5, 20)]
    return pc.ensemble(BOOK, (0, 2), starts, keep=pc.reducers.FirstEvent(below))


@pytest.fixture(scope="module")
def plane():
    starts = np.stack(np.meshgrid([0.5, 1.0, 1.5], [0.0, 1.0], indexing="ij"), axis=-1)
    return pc.ensemble(BOOK, (0, 1), starts)


def axes(count: int = 1) -> list[Axes]:
    return [*Figure().subplots(1, count, squeeze=False)[0]]


def test_a_curve_of_times_of_many_magnitudes_has_a_logarithmic_scale(swept):
    [line] = swept.plot("first_event", axes())
    assert np.nanmax(line.get_ydata()) > 1e3 * np.nanmin(line.get_ydata())
    assert line.axes.get_yscale() == "log"
    assert swept.plot("q[1]", axes())[0].axes.get_yscale() == "linear"


def test_a_curve_names_the_marks_of_what_is_not_resolved(swept):
    line, _ = swept.plot("q[1]", axes(), resolved=np.arange(20) < 12)
    legend = line.axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["not resolved"]


def test_a_map_marks_what_is_not_resolved_and_says_how_much_it_is(plane):
    ax, mask = axes(), np.array([[True, True], [True, False], [True, True]])
    image, marked = plane.plot("q[1]", ax, resolved=mask)
    assert image.axes is marked.axes is ax[0]
    (square,) = marked.get_path().to_polygons()
    assert square[:4].mean(axis=0) == pytest.approx([1.0, 1.0])
    assert [text.get_text() for text in ax[0].get_legend().get_texts()] == ["not resolved: 16.67%"]


def test_a_map_says_why_a_pixel_has_no_value():
    starts = np.stack(np.meshgrid([0.4, 1.5], [0.4, 1.0], indexing="ij"), axis=-1)
    over = pc.reducers.FirstEvent(pc.events.LinkAngle(1, 2.0))
    found = pc.ensemble(BOOK, (0, 0.6), starts, keep=over, max_steps=11, on_failure="ignore")
    image, *_ = found.plot(ax=axes())
    told = [text.get_text() for text in image.axes.get_legend().get_texts()]
    blank, failed = np.isnan(found["first_event"]), ~found.success
    assert (blank & ~failed).any()
    assert failed.any()
    assert told == [
        f"did not happen: {(blank & ~failed).mean():.2%}", f"the run failed: {failed.mean():.2%}"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("given", "error", "told"),
    [
        ({"ax": "q[1]"}, TypeError, "ax = 'q\\[1\\]': must be matplotlib Axes, one$"),
        ({"ax": axes(2)}, ValueError, "ax: 2 axes: must be one"),
        ({"what": axes()[0]}, TypeError, "what: is of type Axes: must name what is drawn; axes"),
        ({"colr": "r"}, TypeError, r"Ensemble\.plot has no parameter 'colr': did you mean"),
        ({"resolvd": 1}, TypeError, r"has no parameter 'resolvd': did you mean 'resolved'"),
        ({"array": [1.0]}, TypeError, "has no parameter 'array'"),
    ],
)
def test_what_a_figure_cannot_show_is_refused(plane, swept, given, error, told):
    for found in (plane, swept):
        with pytest.raises(error, match=told):
            found.plot(**given)


def test_properties_are_those_of_lines_or_of_a_mesh_by_any_of_their_names(plane, swept):
    [line] = swept.plot(ax=axes(), c="tab:green", lw=3.0)
    assert (line.get_color(), line.get_linewidth()) == ("tab:green", 3.0)
    [image] = plane.plot(ax=axes(), cmap="magma", vmin=-1.0, ec="k")
    assert (image.get_cmap().name, image.get_clim()[0]) == ("magma", -1.0)
    assert image.get_edgecolor().tolist()[0] == [0.0, 0.0, 0.0, 1.0]
