"""No crossing of the tip's line by the interpolant is missed, whatever moves."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from numpy.typing import NDArray
from pendcore import events as ev
from unit_rods import rod

Array = NDArray[np.float64]
SWAY = pc.effects.DrivenPivot(
    x=pc.effects.Sinusoid(amplitude=0.3, angular_frequency=5.0),
    y=pc.effects.Sinusoid(amplitude=0.1, angular_frequency=11.0, phase=1.0),
)
ALONG = pc.effects.DrivenPivot(
    spline=pc.effects.Spline(t=[0, 1, 2, 4], x=[0.0, 0.5, -0.5, 0.0], y=[0.0, 0.2, 0.1, -0.3])
)
BOOK = pc.Scene.textbook()


def distance(sol: pc.Solution, line: ev.TipLine, t: Array) -> Array:
    """Return normal . (tip - point), from the states between the steps."""
    n = len(sol.scene.links)
    tips = sol.scene._compiled.positions(t, np.ascontiguousarray(sol(t)[:n].T))[:, -1]
    return (tips - np.array(line.point)) @ np.array(line.normal)


@pytest.mark.parametrize("step", [1.0, 0.25, 0.1])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_spinning_tip_crosses_a_line_twice_a_turn(step: float, sense: int, method: str) -> None:
    """As q = 7 t exactly, x = 0.3 where cos(7 t) = 0.3, several times in a step."""
    line = ev.TipLine((0.3, 5.0), (2.0, 0.0))
    sol = pc.simulate(
        rod(), q0=0.0, qd0=7.0, t_span=(0, 10 * sense), method=method, step=step, events=[line]
    )
    turns = 2 * np.pi * np.arange(14)
    exact = np.sort(np.concatenate([turns + np.arccos(0.3), turns - np.arccos(0.3)]))
    exact = exact[(exact > 0) & (exact <= 70)] / 7
    (found,) = sol.events
    assert [one.t for one in found] == pytest.approx(sense * exact, abs=1e-13)
    assert [one.direction for one in found] == [-1, 1] * (len(found) // 2) + [-1] * (len(found) % 2)


def test_a_tip_that_touches_a_line_is_told_as_touching(method: str) -> None:
    """The rod's tip is lowest, y = 1, at q = pi/2; the line just below is never reached."""
    lines = [ev.TipLine((0.0, 1.0 + gap), (0.0, 1.0)) for gap in (0.0, 1e-13, -1e-13)]
    sol = pc.simulate(rod(), q0=0.0, qd0=1.0, t_span=(0, 4), method=method, step=4.0, events=lines)
    touches, clear, crosses = sol.events
    assert [one.direction for one in touches] == [0]
    assert touches[0].t == pytest.approx(np.pi / 2, abs=1e-7)
    assert clear == []
    assert [one.direction for one in crosses] == [1, -1]


@pytest.mark.parametrize("effect", [None, SWAY, ALONG], ids=["fixed", "sway", "along"])
@pytest.mark.parametrize("start", [[-1.4, -1.1, 0.3], [0.8, 1.0, 1.2], [0.1, -2.0, 3.0]])
def test_no_crossing_that_samples_see_is_missed(
    effect: pc.effects.Effect | None, start: list[float], method: str
) -> None:
    links = [pc.Link(mass=1, length=length) for length in (0.7, 0.5, 0.3)]
    scene = pc.Scene(links=links, effects=[effect] if effect else [])
    lines = [
        ev.TipLine((0.1, 0.2), (1.0, 0.0)), ev.TipLine((0.0, 0.9), (0.3, 1.0)),
        ev.TipLine((-0.4, 0.3), (1.0, -2.0)), ev.TipLine((5.0, 5.0), (1.0, 0.0)),
    ]  # fmt: skip
    sol = pc.simulate(scene, q0=start, qd0=0, t_span=(0, 4), method=method, rtol=1e-6, events=lines)
    t = np.linspace(0, 4, 100_001)
    for line, found in zip(lines, sol.events, strict=True):
        times = np.array([one.t for one in found])
        assert np.all(np.diff(times) >= 0)
        signs = np.sign(distance(sol, line, t))
        seen = np.flatnonzero(np.diff(signs))
        between = np.histogram(times, t)[0]
        assert np.all(between[seen] % 2 == 1)
        assert np.all(np.delete(between, seen) % 2 == 0)
        assert np.abs(distance(sol, line, times)).max(initial=0.0) < 1e-13
        rising = [one.direction for one in found]
        assert rising == [1 if k % 2 == (signs[0] > 0) else -1 for k in range(len(found))]
    assert sum(map(len, sol.events)) > 4
    assert sol.events[3] == []


def test_a_pivot_alone_takes_a_tip_across(method: str) -> None:
    """The rod is locked where it hangs, and the pivot sways: x = 0.3 sin 5 t crosses 0.2."""
    scene = rod(SWAY, pc.effects.Lock(joint=1))
    line = ev.TipLine((0.2, 0.0), (1.0, 0.0))
    sol = pc.simulate(
        scene, q0=np.pi / 2, qd0=0, t_span=(0, 2), method=method, step=1.0, events=[line]
    )
    phase = np.arcsin(0.2 / 0.3)
    exact = np.array([phase, np.pi - phase, 2 * np.pi + phase, 3 * np.pi - phase]) / 5
    assert [one.t for one in sol.events[0]] == pytest.approx(exact, abs=1e-15)
