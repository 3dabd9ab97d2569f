"""The house's colours hold for every eye and in grey print; no text is cut off or lies on another.

Colours as eyes see them that lack one kind of cone: G. M. Machado, M. M. Oliveira, L. A. F.
Fernandes, "A physiologically-based model for simulation of color vision deficiency", IEEE Trans.
Vis. Comput. Graph. 15 (2009), with severity 1. Distances are those of CIELAB 1976, of which 2.3 can
just be noticed. Contrast is that of WCAG 2.2.
"""

from __future__ import annotations

from itertools import combinations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from pendcore.plotting import DARK, KINDS, LIGHT, css_variables, sheet, theme_of

EYES = {
    "all cones": np.eye(3),
    "no long": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998]],
    "no middle": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                  [-0.011820, 0.042940, 0.968881]],
    "no short": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                 [0.004733, 0.691367, 0.303900]],
}  # fmt: skip
TO_XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                   [0.0193339, 0.1191920, 0.9503041]])  # fmt: skip


def linear(color):
    rgb = np.array(to_rgb(color))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(light):
    """Return L*, a*, b* of linear sRGB."""
    x, y, z = (
        np.cbrt(one) if one > 216 / 24389 else (24389 / 27 * one + 16) / 116
        for one in TO_XYZ @ np.clip(light, 0, 1) / TO_XYZ.sum(axis=1)
    )
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def contrast(one, other):
    low, high = sorted(float(TO_XYZ[1] @ linear(color)) for color in (one, other))
    return (high + 0.05) / (low + 0.05)


@pytest.fixture(autouse=True)
def usual_settings():
    """Begin with matplotlib's own settings: what other tests draw with may have set a style."""
    with plt.rc_context():
        plt.rcdefaults()
        yield
    plt.close("all")


@pytest.fixture(params=[LIGHT, DARK], ids=["light", "dark"])
def theme(request):
    return request.param


@pytest.mark.parametrize("eyes", EYES)
def test_curves_can_be_told_apart(theme, eyes):
    seen = [lab(np.array(EYES[eyes]) @ linear(color)) for color in theme.links]
    assert min(np.hypot.reduce(one - other) for one, other in combinations(seen, 2)) > 15


def test_the_first_links_can_be_told_apart_in_grey(theme):
    greys = [lab(linear(color))[0] for color in theme.links[:3]]
    assert abs(greys[0] - greys[1]) > 15
    assert min(abs(one - other) for one, other in combinations(greys, 2)) > 7


def test_what_is_read_has_contrast(theme):
    for ground in (theme.ground, theme.panel):
        texts = theme.ink, theme.quiet, theme.red, theme.blue, theme.force, theme.couple
        assert min(contrast(color, ground) for color in texts) > 4.5
        assert min(contrast(color, ground) for color in theme.links) > 3.0


def test_the_sheet_is_a_style_of_matplotlib_and_dark_axes_have_bright_curves():
    sol = pc.Case.textbook().simulate()
    with plt.style.context(sheet(DARK)):
        axes = sol.plot()[0].axes
    assert axes.get_facecolor()[:3] == pytest.approx(to_rgb(DARK.ground))
    assert axes.lines[0].get_color() == DARK.red
    assert theme_of(plt.figure().subplots()) is LIGHT


def test_a_dark_ground_of_the_users_has_texts_that_can_be_read():
    with plt.style.context("dark_background"):
        axis = pc.Case.textbook().simulate().plot()[0].axes
    ticks = axis.yaxis.get_tick_params()["labelcolor"]
    assert min(contrast(color, "black") for color in (ticks, axis.yaxis.label.get_color())) > 4.5
    clear = plt.figure().subplots()
    clear.set_facecolor("none")  # the ground is the figure's
    assert theme_of(clear) is LIGHT


def test_what_the_user_has_set_in_matplotlib_stays():
    sol = pc.Case.textbook().simulate()
    with plt.rc_context({"font.size": 17.0, "axes.spines.top": True}):
        assert plt.rcParams["font.size"] == 17.0
        assert sol.plot()[0].axes.yaxis.label.get_size() == 17.0
    assert sol.plot()[0].axes.yaxis.label.get_size() == 10.0
    assert plt.rcParams["axes.spines.right"]  # and nothing of ours is left behind


def test_pages_have_the_same_colours():
    told = css_variables()
    light, dark = told.split("@media (prefers-color-scheme: dark)")
    assert f"--link-2: {LIGHT.blue};" in light
    assert f"--link-2: {DARK.blue};" in dark
    assert dark.startswith(" {\n:root {\n")  # the query holds a rule
    chosen = css_variables("html[data-theme=dark]")
    assert chosen.partition("\nhtml[data-theme=dark] {\n")[2].count(f"--link-2: {DARK.blue};") == 1


RUN = pc.simulate(
    pc.Scene.textbook().replace(effects=[pc.effects.ViscousJoint(joint=1, damping=0.3)]),
    (0, 6), [0.8, -0.4], ledger=True, events=[pc.events.LinkAngle(1, np.pi / 2)],
)  # fmt: skip
CHAOS = pc.simulate(pc.Scene.textbook(), (0, 30), 0.0)


@pytest.fixture
def written(monkeypatch):
    """Return the boxes of the texts that are drawn from now on, by text."""
    found = {}
    draw = Text.draw

    def told(self, renderer):
        if self.get_visible() and self.get_text():
            found[self] = self.get_window_extent(renderer)
        draw(self, renderer)

    monkeypatch.setattr(Text, "draw", told)
    return found


def require_in(figure, written):
    """Raise an AssertionError if a text is cut off."""
    for text, box in written.items():
        assert (box.min >= -0.5).all(), text
        assert (box.max <= figure.bbox.max + 0.5).all(), text


@pytest.mark.parametrize("y", ["time", "nfev"])
def test_no_text_of_what_accuracy_costs_is_cut_off(y, written):
    cost = pc.accuracy_cost(RUN.scene, (0, 1), 0.8, repeats=1, rtol=[1e-3, 1e-6])
    figure = cost.plot(y=y)[0].axes.figure
    for size in (4.0, 3.4), (7.6, 4.6), (11.0, 7.5):
        figure.set_size_inches(*size)
        figure.draw_without_rendering()
        written.clear()
        figure.canvas.draw()
        assert len(written) > 8
        require_in(figure, written)


@pytest.mark.parametrize("size", [(4.0, 3.4), (6.4, 4.8), (12.0, 8.0)])
@pytest.mark.parametrize(
    ("what", "horizon"),
    [*((kind, None) for kind in KINDS), ("angles", 0.1), ("energy", 0.1), ("path", 0.1),
     ("phase", 0.1), ("reactions", 0.1)],
)  # fmt: skip
def test_no_text_is_cut_off_or_lies_on_another_or_on_a_curve(what, horizon, size, written):
    run = CHAOS if horizon else RUN
    ax = plt.figure(figsize=size).subplots() if what == "free_bodies" else None
    figure = run.plot(what, ax, horizon=horizon)[0].axes.figure
    figure.set_size_inches(*size)
    figure.draw_without_rendering()
    written.clear()
    figure.canvas.draw()
    assert len(written) > 5
    require_in(figure, written)
    inner = {text: box.padded(-1) for text, box in written.items()}
    for (text, box), (other, there) in combinations(inner.items(), 2):
        assert not box.overlaps(there), (text, other)
    for axes in figure.axes:
        for line in axes.lines:
            path = line.get_transform().transform_path(line.get_path())
            for text, box in inner.items():
                # A line of pieces that meet is looked at piece by piece: bodies are not filled.
                assert not path.intersects_bbox(box, filled=False), (text, line)
