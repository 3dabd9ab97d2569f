"""In the figures of the handout arrows point the right way, and names lie on nothing."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from handed_out_cases import CASES, drawn
from matplotlib.figure import Figure
from matplotlib.path import Path as MarkedPath
from matplotlib.text import Text
from pendcore.derive.report.motion import empty_axes, whole_ticks
from pendcore.plotting import sketch

pytestmark = pytest.mark.unsanitized

effects = pc.effects


@pytest.mark.parametrize("n", [1, 2, 3])
def test_arrows_point_the_way_that_counts_as_positive(
    n: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On link 1 F_01 and F_21 point along +x and +y; on link 2 F_21 is the other way round."""
    sheets: list[list[tuple[str, list[float]]]] = []
    sheet, arrow = sketch.Sketch, sketch.Sketch.arrow

    def begun(*given: Any) -> Any:
        sheets.append([])
        return sheet(*given)

    def looked_at(on: Any, start: Any, along: Any, text: str = "", *more: Any, **how: Any) -> None:
        sheets[-1].append((text, np.sign(np.round(along, 9)).tolist()))
        arrow(on, start, along, text, *more, **how)

    monkeypatch.setattr("pendcore.derive.report.bodies.Sketch", begun)
    monkeypatch.setattr(sheet, "arrow", looked_at)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * n)
    drawn("free_bodies", scene, [0.5] * n)
    for i, arrows in enumerate(sheets, start=1):
        near, far = ("01" if i == 1 else f"{i}{i - 1}"), f"{i + 1}{i}"
        sign = 1.0 if i == 1 else -1.0
        expected = {f"$m_{{{i}}} g$": [0.0, 1.0]}
        expected |= {f"$F_{{{near}x}}$": [sign, 0.0], f"$F_{{{near}y}}$": [0.0, sign]}
        if i < n:
            expected |= {f"$F_{{{far}x}}$": [1.0, 0.0], f"$F_{{{far}y}}$": [0.0, 1.0]}
        assert dict(arrows) == expected
    assert len(sheets) == n


def test_free_bodies_have_names_and_the_couple_that_turns_a_payload() -> None:
    payload = effects.Payload(mass=0.2, inertia=0.01)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * 2, effects=[payload])
    figure = drawn("free_bodies", scene, [0.5, 0.7])
    names = [{text.get_text() for text in axes.texts} for axes in figure.axes]
    couple = r"$I_{p} \ddot{q}_{2}$"
    assert couple not in names[0]
    assert names[1] >= {"link 2", "$C_{2}$", "$B$", "$D$", "$F_{p2x}$", "$F_{p2y}$", couple}
    assert names[2] >= {"payload", "$D$", "$m_{p} g$", "$F_{p2x}$", "$F_{p2y}$", couple}


@pytest.mark.parametrize("angle", [0.3, 2.0, -1.2, -2.9])
def test_a_couple_is_drawn_on_the_side_that_is_asked_for(angle: float) -> None:
    on = sketch.Sketch(Figure().subplots(), 1.0)
    on.couple(np.zeros(2), sketch.direction(angle), "$M$")
    ((points, _),) = on.drawn
    assert np.arctan2(*points.mean(axis=0)[::-1]) == pytest.approx(angle, abs=0.1)


@pytest.mark.parametrize("name", CASES)
def test_the_mechanism_is_drawn_as_it_starts_with_y_down(name: str) -> None:
    case = CASES[name]
    (axes,) = drawn("mechanism", case.scene, case.q0).axes
    assert axes.yaxis_inverted()
    names = {text.get_text() for text in axes.texts}
    assert {"$A$", "$x$", "$y$", "$0$"} <= names
    assert ("$m_p$" in names) == any(one.kind == "payload" for one in case.scene.effects)
    assert {f"$q_{{{i}}}$" for i in range(1, len(case.q0) + 1)} <= names
    pins = [p.center for p in axes.patches if getattr(p, "radius", 0) and p.get_zorder() == 6]
    expected = case.simulate().positions()[0]
    np.testing.assert_allclose(pins, expected, atol=1e-12)


@pytest.mark.few_cases
@pytest.mark.parametrize("seed", range(30))
def test_names_in_figures_lie_on_nothing(seed: int) -> None:
    """Names lie neither on each other nor on a link, as measured where they are drawn."""
    rng = np.random.default_rng(seed)
    n = 1 + seed % 4
    q = np.radians(rng.choice([0.0, 15.0, 30.0, 70.0, 90.0, 110.0, 180.0, -40.0], n))
    q = q + rng.uniform(-0.2, 0.2, n) * (seed % 2)
    links = [pc.Link(mass=1.0, length=rng.uniform(0.3, 1.0)) for _ in range(n)]
    acting: list[Any] = [effects.Payload(mass=0.2, inertia=0.01 * (seed % 2))] * (seed % 3 == 0)
    acting += [effects.ViscousJoint(joint=j, damping=0.1) for j in range(1, n + 1)]
    if seed % 5 == 0:
        acting += [effects.DrivenPivot(y=effects.Sinusoid(0.02, 80.0))]
        acting += [effects.RodDrag(link=n, drag_coefficient=1.2, diameter=0.03)]
    scene = pc.Scene(links=links, effects=acting * (seed % 4 != 3))
    chain = scene.positions(0.0, q)
    chain -= chain[0]
    for what in ("mechanism", "free_bodies"):
        figure = drawn(what, scene, q)
        figure.draw_without_rendering()
        for i, axes in enumerate(figure.axes):
            boxes = [text.get_window_extent() for text in axes.texts if text.get_text()]
            for k, box in enumerate(boxes):
                assert not any(box.overlaps(other) for other in boxes[:k]), axes.texts[k]
            pairs = list(pairwise(chain))
            if what == "free_bodies":
                pairs = [(start - start, end - start) for start, end in pairs][i : i + 1]
            for ends in pairs:
                rod = MarkedPath(axes.transData.transform(np.array(ends)))
                for text, box in zip(filter(Text.get_text, axes.texts), boxes, strict=True):
                    assert not rod.intersects_bbox(box, filled=False), text


@pytest.mark.parametrize("name", CASES)
def test_names_of_mass_centres_lie_beside_them(name: str) -> None:
    case = CASES[name]
    figure = drawn("mechanism", case.scene, case.q0)
    figure.draw_without_rendering()
    (axes,) = figure.axes
    names = {text.get_text(): text.get_window_extent() for text in axes.texts}
    for i, center in enumerate(case.scene.mass_centers(0.0, case.q0), start=1):
        (left, low), (right, high) = names[f"$C_{{{i}}}$"].get_points()
        x, y = axes.transData.transform(center)
        gap = np.hypot(max(left - x, x - right, 0.0), max(low - y, y - high, 0.0))
        assert gap * 72 / figure.dpi < 20  # points


def test_empty_axes_name_each_angle_and_span_the_run() -> None:
    figure = empty_axes(pc.simulate(pc.Scene.textbook(), (0.5, 2.0), [0.1, 0.2])).figure
    assert [axes.get_ylabel() for axes in figure.axes] == ["$q_{1}$ (deg)", "$q_{2}$ (deg)"]
    assert [axes.get_xlim() for axes in figure.axes] == [(0.5, 2.0)] * 2
    assert not any(axes.lines for axes in figure.axes)


def test_empty_axes_have_few_ticks_at_whole_angles() -> None:
    for turns in ([0.1, 80.0], [-200.0, 300.0], [-30.0, 100.0], [40.0, 5000.0], [-1e6, 0.0]):
        low, high, step = whole_ticks(np.array(turns))
        assert low <= min(turns)
        assert high >= max(turns)
        assert step % 30 == 0 or step % 45 == 0
        assert low % step == 0
        assert 3 <= round((high - low) / step) + 1 <= 7
