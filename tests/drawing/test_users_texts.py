"""Any text of a user's can be drawn: a legend shows every run, and dollars raise nothing."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from pendcore.plotting import as_drawn
from runs_that_kept_little import stage

UNREADABLE = ["Ba$$in", r"$\nonsense$", "$a_{$ b", r"\$ $$"]
NAMES = [*UNREADABLE, "_a", "__", "_$$", "5 $", r"$\theta$ sweep", "plain", "#%&{}^~"]


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 0.5))


def drawn(text, **properties):
    """Return the pixels of a text."""
    figure = Figure(figsize=(3, 0.5))
    canvas = FigureCanvasAgg(figure)
    figure.text(0.1, 0.3, text, **properties)
    canvas.draw()
    return np.array(canvas.buffer_rgba())


@pytest.mark.parametrize("text", UNREADABLE)
def test_what_is_no_mathematics_is_drawn_as_it_is_written(text):
    with pytest.raises(ValueError, match=r"Expected|Unknown"):
        drawn(text)
    assert np.array_equal(drawn(as_drawn(text)), drawn(text, parse_math=False))


@pytest.mark.parametrize("text", [r"$\theta$ sweep", "plain", "5 $", "_a"])
def test_other_texts_are_drawn_as_matplotlib_draws_them(text):
    assert np.array_equal(drawn(as_drawn(text)), drawn(text))


def test_a_film_shows_the_name_of_every_run(sol):
    film = stage(*[sol] * len(NAMES), names=NAMES)
    *texts, _ = (x.get_text().strip() for x in film.show(0) if isinstance(x, Text))
    assert texts == [as_drawn(name) for name in NAMES]
    film.figure.draw_without_rendering()


@pytest.mark.few_cases
@pytest.mark.parametrize("what", ["angles", "reactions", "energy", "path", "phase"])
@pytest.mark.parametrize("name", NAMES)
def test_a_figure_shows_its_label(sol, what, name):
    figure = Figure()
    axes = figure.subplots(2 if what in ("angles", "reactions") else 1, 1)
    sol.plot(what, axes, label=name)
    legend = figure.axes[0].get_legend()
    assert legend is not None
    shown = [one.get_text() for one in legend.get_texts()]
    assert shown
    assert all(one.endswith(as_drawn(name)) for one in shown)
    figure.draw_without_rendering()


@pytest.mark.parametrize("name", UNREADABLE)
def test_a_comparison_and_a_map_can_be_drawn_under_any_name(name):
    book = pc.Case.textbook()
    cost = pc.accuracy_cost(
        book.scene, q0=book.q0, t_span=(0, 0.1), methods="dopri5", rtol=[1e-3], repeats=1, name=name
    )
    figure = Figure()
    cost.plot(figure.subplots())
    found = pc.ensemble(
        book.scene, q0=np.linspace(0, 1, 4)[:, None] * [1.0, 0.5], t_span=(0, 0.1),
        keep={name: pc.reducers.EnergyDrift()},
    )  # fmt: skip
    found.plot(name, ax=figure.add_subplot())
    figure.draw_without_rendering()
