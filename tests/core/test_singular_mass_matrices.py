"""A scene is refused where its mass matrix is singular somewhere, and only there."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pendcore import effects as fx
from sweeps import random_examples

ROD, EMPTY = pc.Link(mass=1.0, length=1.0), pc.Link(mass=0.0, length=1.0)
POINT = pc.Link.point_mass(mass=1.0, length=1.0)
AT_THE_JOINT = pc.Link(mass=1.3, length=0.7, center=0.0, inertia=0.0)
SHORT, LONG = pc.Link(mass=0.0, length=0.5), pc.Link(mass=0.0, length=1.2)
OFF_ITS_END = pc.Link(mass=0.9, length=1.0, center=0.4, inertia=0.0)
INERTIA = "inertia about its joint"
NEITHER = f"has neither mass nor {INERTIA}: the mass matrix is singular when it lines"
REFUSED = {
    "a mass in its joint": ([AT_THE_JOINT], [], f"link 1: {INERTIA}, with what it carries"),
    "a mass in the last joint": ([EMPTY, AT_THE_JOINT], [], f"link 2: {INERTIA}"),
    "nothing at all": ([EMPTY], [], "link 1: mass = 0.0: must be finite and > 0 .kg."),
    "nothing at the end": ([ROD, EMPTY], [], "link 2: mass = 0.0: must be finite and > 0 .kg."),
    "a point on a massless link": ([EMPTY, POINT], [], f"link 1: {NEITHER} up with link 2"),
    "the same further out": ([ROD, EMPTY, POINT], [], f"link 2: {NEITHER}"),
    "massless links in a row": ([EMPTY, EMPTY, ROD], [], f"link 1: {NEITHER}"),
    "a payload on two": ([EMPTY, EMPTY], [fx.Payload(1.0)], f"link 1: {NEITHER}"),
    "a stop that is passed": ([EMPTY, POINT], [fx.JointStop(2, (-1, 1))], f"link 1: {NEITHER}"),
    "held for a while": ([EMPTY, POINT], [fx.DryJointFriction(2, 1e9)], f"link 1: {NEITHER}"),
    "a lock before": ([ROD, EMPTY, POINT], [fx.Lock(1)], f"link 2: {NEITHER}"),
    "beyond a lock that takes the start": ([EMPTY, POINT, EMPTY], [fx.Lock(2)], "link 3: mass ="),
    "a mass that a lock folds into the joint": (
        [EMPTY, POINT], [fx.Lock(2, np.pi)], f"link 1: {INERTIA}"),
    "a rotor between links as long": (
        [EMPTY, POINT], [fx.RotorInertia(2, 0.3)], f"link 1: {NEITHER}"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_a_mass_matrix_that_is_not_positive_definite_is_refused_by_link_and_reason(case):
    links, effects, message = REFUSED[case]
    with pytest.raises(ValueError, match=f"^{message}.*Link.point_mass"):
        pc.Scene(links=links, effects=effects)


def mass_matrix(links: list[pc.Link], effects: list[Any], q: NDArray[np.float64]) -> Any:
    """Sum the Jacobians of all that has a mass or an inertia, for the bodies that locks leave."""
    n = len(links)
    across = np.stack([-np.sin(q), np.cos(q)])
    arm = np.zeros((2, n))
    m = np.zeros((n, n))
    for i, link in enumerate(links):
        center = arm.copy()
        center[:, i] += link.center * across[:, i]
        m += link.mass * center.T @ center
        m[i, i] += link.inertia
        arm[:, i] += link.length * across[:, i]
    is_free = np.ones(n, dtype=int)
    for e in effects:
        if isinstance(e, fx.Lock):
            is_free[e.joint - 1] = 0
        if isinstance(e, fx.Payload):
            m += e.mass * arm.T @ arm
            m[-1, -1] += e.inertia
        if isinstance(e, fx.RotorInertia):
            relative = np.eye(n)[e.joint - 1] - (np.eye(n)[e.joint - 2] if e.joint > 1 else 0.0)
            m += e.armature * np.outer(relative, relative)
    body = np.cumsum(is_free) - 1
    together = (body[:, None] == np.arange(body[-1] + 1)).astype(float)
    return together.T @ m @ together


def least(links: list[pc.Link], effects: list[Any]) -> float:
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

    # along one axis and along the diagonals of two
    ways = [np.array(d) for d in itertools.product((-1, 0, 1), repeat=len(free)) if any(d)]
    lined_up = [[0.0, np.pi, 1.3, -2.0] for _ in free]
    best = np.inf
    for start in sorted(itertools.product(*lined_up), key=value)[:6]:
        x, step = np.array(start), 0.5
        here = value(x)
        while step > 1e-8:
            near = min(((value(x + step * d), tuple(x + step * d)) for d in ways), default=None)
            # What falls by rounding alone could lead on and on through a valley.
            if near is not None and near[0] < here - 1e-14:
                here, x = near[0], np.array(near[1])
            else:
                step /= 2
        best = min(best, here)
    return best


@st.composite
def scenes(draw: st.DrawFn) -> tuple[list[pc.Link], list[Any]]:
    rod, point = pc.Link(mass=1.1, length=0.9), pc.Link.point_mass(mass=1.5, length=0.8)
    some = st.sampled_from([LONG, SHORT, point, rod, AT_THE_JOINT, OFF_ITS_END])
    links = draw(st.lists(some, min_size=1, max_size=4))
    effects: list[Any] = []
    for joint in range(1, len(links) + 1):
        kind = draw(st.sampled_from(["", "", "lock", "rotor", "stop"]))
        if kind == "lock":
            effects.append(fx.Lock(joint, draw(st.sampled_from([0.0, 0.7, np.pi]))))
        if kind == "rotor":
            effects.append(fx.RotorInertia(joint, 0.4))
        if kind == "stop" and joint > 1:
            ranges = st.sampled_from([(0.4, 2.5), (-0.5, 1.0), (2.0, 4.0)])
            effects.append(fx.JointStop(joint, draw(ranges)))
    if draw(st.booleans()):
        effects.append(fx.Payload(0.6))
    return links, effects


@pytest.mark.unsanitized  # the search for the smallest mass matrix is NumPy's
@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
@settings(max_examples=random_examples(60), deadline=None)
@given(scenes())
def test_a_scene_is_refused_where_and_only_where_its_mass_matrix_is_singular(drawn) -> None:
    links, effects = drawn
    refused = ""
    try:
        pc.Scene(links=links, effects=effects)
    except ValueError as error:
        refused = str(error)
    smallest = least(links, effects)
    assert smallest < 1e-9 if refused else smallest > 1e-6, (refused, smallest)
    assert refused.startswith("link ") or not refused
