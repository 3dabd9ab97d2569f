"""The accelerations' derivatives agree with the reference's, differentiated in many digits.

The reference has no derivatives of its own: it is differentiated by central differences of 10^-30
in eighty digits, which leaves fifty of them. An error is measured against the size of what the
derivative is made of: the sum over the terms of each equation, sent through the magnitude of the
inverse matrix (Skeel's condition, as in test_right_hand_side_of_effects.py), per unit of angle or
rate. The derivatives of the terms, sent through it in the same way, are added, because they may be
present, and cancel, where the terms themselves are absent.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from reference.arithmetic import multiple_precision
from reference.effects import Described, law
from reference.newton_euler import Body
from reference.random_rigs import DrawnRig, rigs
from reference.rig import Rig
from sweeps import random_examples

TOLERANCE = 1e-12
ROUNDING_OF_THE_REFERENCE = 1e-26  # that of its differences too, where a law has a corner
MANY = multiple_precision(80)
STEP = MANY.number(10) ** -30
OF_USERS = {"user", "compiled_user"}  # their functions are differentiated by differences
KINDS = sorted(set(pc.effects.kinds()) - OF_USERS - {"joint_stop"})  # stops have no torque


def computed(drawn: DrawnRig) -> NDArray[np.float64]:
    """Return d qdd / d (q, qd), (n, 2n)."""
    bodies, gravity, described, (t, q, qd) = drawn
    scene: Any = scene_of(bodies, gravity, described)
    return np.hstack(scene.jacobian(t, q, qd))


def exact_and_size(drawn: DrawnRig) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bodies, gravity, described, (t, q, qd) = drawn
    n, number = len(bodies), MANY.number
    laws = [law(one) for one in described]
    rig = Rig(bodies=bodies, gravity=gravity, effects=laws, arithmetic=MANY)
    state = [number(x) for x in (*q, *qd)]
    exact, terms = np.zeros((n, 2 * n)), np.zeros((n, 2 * n))
    here = rig.equations(rig.instant(t, q, qd))
    unknowns = here.solve(MANY)
    sizes = here.sizes(unknowns)[:n]
    for j in range(2 * n):
        moved = [[x + sign * STEP * (i == j) for i, x in enumerate(state)] for sign in (1, -1)]
        ahead, behind = (rig.equations(rig.instant(number(t), one[:n], one[n:])) for one in moved)
        exact[:, j] = derivatives(ahead.solve(MANY), behind.solve(MANY))[:n]
        # In K x' = r' - K' x terms of different equations cancel.
        of_matrix = list(map(derivatives, ahead.matrix, behind.matrix))
        of_right = derivatives(*([side.value for side in one.right] for one in (ahead, behind)))
        changes = np.abs(of_matrix) @ np.abs(np.array(unknowns, dtype=float)) + np.abs(of_right)
        terms[:, j] = here.reach(changes)[:n]
    # Sizes are per radian, or per unit of the fastest rate; a force quadratic in the rates has a
    # factor 2, and the inverse of the mass matrix changes by its condition.
    per = np.array([1.0] * n + [1.0 / max(1e-3, *np.abs(qd))] * n)
    matrix = np.array(rig.mass_matrix(state[:n]), dtype=float)
    size = np.sqrt(np.diag(matrix))
    gain = float(np.linalg.cond(matrix / np.outer(size, size)))
    return exact, gain * (np.outer(sizes, per) + np.abs(exact) + terms)


def derivatives(ahead: Sequence[Any], behind: Sequence[Any]) -> NDArray[np.float64]:
    """Return the derivatives from the values a step further and a step back."""
    return np.array([float((a - b) / (2 * STEP)) for a, b in zip(ahead, behind, strict=True)])


def check(drawn: DrawnRig, tolerance: float = TOLERANCE) -> None:
    exact, size = exact_and_size(drawn)
    assert np.all(np.abs(computed(drawn) - exact) <= tolerance * size + ROUNDING_OF_THE_REFERENCE)


def check_drawn(kinds: Sequence[str], n: int, examples: int, tolerance: float = TOLERANCE) -> None:
    @settings(max_examples=random_examples(examples), deadline=None)
    @given(rigs(kinds, st.just(n)))
    def check_one(drawn: DrawnRig) -> None:
        check(drawn, tolerance)

    check_one()


@pytest.mark.parametrize("n", [1, 2, 3, 10])
def test_no_effect_at_all(n: int) -> None:
    check_drawn([], n, examples=3)


@pytest.mark.few_cases
@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_an_effect_alone(kind: str, n: int) -> None:
    check_drawn([kind], n, examples=6)


@pytest.mark.parametrize(("n", "examples"), [(1, 12), (2, 12), (3, 12), (10, 2)])
def test_all_effects_together_with_locks_and_without(n: int, examples: int) -> None:
    check_drawn(KINDS, n, examples)
    check_drawn([kind for kind in KINDS if kind != "lock"], n, examples)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_functions_of_the_users_are_differentiated_by_differences(n: int) -> None:
    # a compiled function takes doubles alone, from the reference as well
    check_drawn(["user", "viscous_joint"], n, examples=6, tolerance=1e-9)


@pytest.mark.parametrize("joints", [(2, 3), (1, 3)])
def test_what_cancels_leaves_its_rounding_and_no_more(joints: tuple[int, ...]) -> None:
    """The chain lies along x, without gravity; turn a link, and centripetal forces have moments.

    The locks add these moments up to zero; no term of the accelerations tells their size.
    """
    links = [Body(1.9, 0.6, 0.13, 0.013), Body(4.2, 2.6, 1.5, 4.8), Body(1.2, 2.7, 1.9, 0.2)]
    locks: list[Described] = [("lock", {"joint": joint}) for joint in joints]
    rates = [0.0 if 1 in joints else 0.3, 0.3, 0.3]
    drawn = links, 0.0, locks, (0.5, [0.0] * 3, rates)
    exact, size = exact_and_size(drawn)
    assert np.abs(exact).max() < ROUNDING_OF_THE_REFERENCE
    assert TOLERANCE * size.max() < 1e-10 * rates[1] ** 2  # a small mistake would not pass
    check(drawn)
