"""A scene is refused where its mass matrix is singular somewhere, and only there."""

from __future__ import annotations

import itertools
import warnings
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pendcore import effects as fx
from reference.newton_euler import Body, uniform_rod

EMPTY, SHORT = Body(0.0, 1.2, 0.6, 0.0), Body(0.0, 0.5, 0.0, 0.0)
POINT = Body(1.5, 0.8, 0.8, 0.0)
ROD = uniform_rod(1.1, 0.9)
AT_THE_JOINT = Body(1.3, 0.7, 0.0, 0.0)


def mass_matrix(links: list[Body], effects: list[Any], q: NDArray[np.float64]) -> Any:
    """Sum the Jacobians of all that has a mass or an inertia, for the bodies that locks leave."""
    n = len(links)
    across = np.stack([-np.sin(q), np.cos(q)])
    m = np.zeros((n, n))
    arm = np.zeros((2, n))

    def add(mass: float, at: NDArray[np.float64]) -> None:
        nonlocal m
        m = m + mass * at.T @ at

    for i, link in enumerate(links):
        center = arm.copy()
        center[:, i] += link.center * across[:, i]
        add(link.mass, center)
        m[i, i] += link.inertia
        arm[:, i] += link.length * across[:, i]
    body = (
        np.cumsum(
            [
                not any(isinstance(e, fx.Lock) and e.joint == i + 1 for e in effects)
                for i in range(n)
            ]
        )
        - 1
    )
    for e in effects:
        if isinstance(e, fx.Payload):
            add(e.mass, arm)
            m[-1, -1] += e.inertia
        if isinstance(e, fx.RotorInertia):
            row = np.eye(n)[e.joint - 1] - (np.eye(n)[e.joint - 2] if e.joint > 1 else 0.0)
            m = m + e.armature * np.outer(row, row)
    count = body[-1] + 1
    together = (body[:, None] == np.arange(count)).astype(float)
    return together.T @ m @ together


def least(links: list[Body], effects: list[Any]) -> float:
    """Descend to the least eigenvalue of the mass matrix wherever the joints can go."""
    n = len(links)
    locked = {e.joint: e.angle for e in effects if isinstance(e, fx.Lock)}
    ranges = {e.joint: e.range for e in effects if isinstance(e, fx.JointStop)}
    free = [j for j in range(2, n + 1) if j not in locked]

    def value(angles: Any) -> float:
        phi = np.zeros(n)
        for j, x in zip(free, angles, strict=True):
            phi[j - 1] = np.clip(x, *ranges.get(j, (-np.inf, np.inf)))
        for j, x in locked.items():
            phi[j - 1] = x
        m = mass_matrix(links, effects, np.cumsum(phi))
        return float(np.linalg.eigvalsh(m)[0]) if m.size else 1.0

    lined_up = [[0.0, np.pi, 1.3, -2.0] for _ in free]
    best = np.inf
    for start in sorted(itertools.product(*lined_up), key=value)[:6]:
        x, step = np.array(start), 0.5
        here = value(x)
        while step > 1e-8:  # along one axis and along the diagonals of two
            ways = [np.array(d) for d in itertools.product((-1, 0, 1), repeat=len(free)) if any(d)]
            near = min(((value(x + step * d), tuple(x + step * d)) for d in ways), default=None)
            # What falls by rounding alone could lead on and on through a valley.
            if near is not None and near[0] < here - 1e-14:
                here, x = near[0], np.array(near[1])
            else:
                step /= 2
        best = min(best, here)
    return best


bodies = st.sampled_from([EMPTY, SHORT, POINT, ROD, AT_THE_JOINT, Body(0.9, 1.0, 0.4, 0.0)])


@st.composite
def drawn(draw: st.DrawFn) -> tuple[list[Body], list[Any]]:
    links = draw(st.lists(bodies, min_size=1, max_size=4))
    effects: list[Any] = []
    for joint in range(1, len(links) + 1):
        kind = draw(st.sampled_from(["", "", "lock", "rotor", "stop"]))
        if kind == "lock":
            effects.append(fx.Lock(joint=joint, angle=draw(st.sampled_from([0.0, 0.7, np.pi]))))
        if kind == "rotor":
            effects.append(fx.RotorInertia(joint=joint, armature=0.4))
        if kind == "stop" and joint > 1:
            effects.append(
                fx.JointStop(
                    joint=joint, range=draw(st.sampled_from([(0.4, 2.5), (-0.5, 1.0), (2.0, 4.0)]))
                )
            )
    if draw(st.booleans()):
        effects.append(fx.Payload(mass=0.6))
    return links, effects


@pytest.mark.unsanitized  # the search for the smallest mass matrix is NumPy's
@settings(max_examples=60, deadline=None)
@given(drawn())
def test_a_scene_is_refused_where_and_only_where_its_mass_matrix_is_singular(
    given_: tuple[list[Body], list[Any]],
) -> None:
    links, effects = given_
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        reason = ""
        try:
            pc.Scene(links=[pc.Link(**one._asdict()) for one in links], effects=effects)
            is_taken = True
        except ValueError as refused:
            is_taken = False
            reason = str(refused)
    assert is_taken or reason.startswith("link ")
    smallest = least(links, effects)
    assert smallest > 1e-6 if is_taken else smallest < 1e-9, (is_taken, smallest)
