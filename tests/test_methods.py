"""Every method of the list: order conditions in exact fractions, convergence, dense output."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from reference.order_conditions import holds, order_of, trees
from reference.trajectories import trajectory

METHODS = {method["name"]: method for method in _core.methods()}
EXPLICIT = [name for name, method in METHODS.items() if method["kind"] == "explicit"]
BOOK = pc.Scene.textbook()
START = [np.pi / 4, np.pi / 3]


def fractions(rows: list[Any]) -> list[Any]:
    """Turn pairs into fractions, in lists as deep as they are."""
    if isinstance(rows[0], int):
        return Fraction(*rows)
    return [fractions(row) for row in rows]


@pytest.fixture(params=METHODS)
def method(request: pytest.FixtureRequest) -> dict[str, Any]:
    return METHODS[request.param]


@pytest.fixture(params=EXPLICIT)
def explicit(request: pytest.FixtureRequest) -> dict[str, Any]:
    return METHODS[request.param]


@pytest.fixture
def tableau(explicit: dict[str, Any]) -> dict[str, Any]:
    return {key: fractions(rows) for key, rows in _core.tableau(explicit["name"]).items()}


def test_the_weights_have_the_order_of_the_method(explicit, tableau):
    assert order_of(tableau["a"], tableau["b"]) == explicit["order"]


def test_the_embedded_weights_have_the_order_of_the_error(explicit, tableau):
    if explicit["error_order"] == 0:
        assert not any(tableau["e"])
        return
    embedded = [b - e for b, e in zip(tableau["b"], tableau["e"], strict=True)]
    assert order_of(tableau["a"], embedded) == explicit["error_order"]


def test_the_nodes_are_the_row_sums_and_the_stages_explicit(tableau):
    for i, row in enumerate(tableau["a"]):
        assert sum(row) == tableau["c"][i]
        assert not any(row[i:])


def test_the_interpolant_has_its_order_all_along_the_step_and_no_more(explicit, tableau):
    thetas = [Fraction(k, 7) for k in range(8)]

    def is_of_order(p: int) -> bool:
        for theta in thetas:
            weights = [
                sum(c * theta ** (k + 1) for k, c in enumerate(row))
                for row in tableau["interpolant"]
            ]
            if not all(
                holds(tableau["a"], weights, t, theta) for n in range(p + 1)[1:] for t in trees(n)
            ):
                return False
        return True

    assert is_of_order(explicit["interpolant_order"])
    assert not is_of_order(explicit["interpolant_order"] + 1)


def test_the_interpolant_ends_at_the_new_state(tableau):
    assert [sum(row) for row in tableau["interpolant"]] == tableau["b"]


def errors(method: str, steps: list[int], t: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Largest errors over the times t of runs in 1, 2, 4, ... times as many steps."""
    span = (0.0, float(t[-1]))
    # The tolerances say how far an implicit method solves its equations.
    how = {"method": method, "rtol": 1e-13, "atol": 1e-16}
    runs = [pc.simulate(BOOK, START, 0, span, step=span[1] / n, **how) for n in steps]
    return np.array([np.abs(run(t) - exact).max() for run in runs])


def test_the_error_falls_at_the_order_over_four_decades(method):
    case = trajectory("textbook")
    exact = np.hstack([case.q, case.qd]).T
    doublings = max(6, 1 + int(np.ceil(np.log2(1e4) / method["order"])))
    # Each time of the grid is a step's end: the error is the steps', not the interpolant's.
    error = errors(method["name"], [200 * 2**k for k in range(doublings + 1)], case.t, exact)
    kept = error[error > 1e-12]  # below, rounding
    slopes = -np.diff(np.log2(kept))
    assert kept[0] / kept[-1] > 1e4
    assert np.mean(slopes[1:]) == pytest.approx(method["order"], abs=0.2)
    assert slopes[-1] == pytest.approx(method["order"], abs=0.2)


def test_the_dense_output_converges_at_its_order_between_the_steps(method):
    case = trajectory("textbook")
    exact = np.hstack([case.q, case.qd]).T
    # 5 s in 64 .. 1024 steps: a time of the grid that is a step's end says nothing of the between
    steps = [64 * 2**k for k in range(5)]
    between = [k for k in range(101) if (k * 64) % 100 != 0 and k < 100]
    error = errors(
        method["name"], steps, np.append(case.t[between], 5.0), exact[:, [*between, 100]]
    )
    slopes = -np.diff(np.log2(error))
    expected = min(method["order"], method["interpolant_order"] + 1)
    assert slopes[-3:].mean() == pytest.approx(expected, abs=0.4)


def test_a_step_between_the_knots_shows_the_order_of_the_interpolant_itself(method):
    # one step of h from an exact state, the reference inside it from a run in steps of h/64
    theta = np.array([0.15, 0.35, 0.55, 0.85])
    local = []
    for h in (0.04, 0.02, 0.01):
        coarse = pc.simulate(
            BOOK, START, [1.0, -0.5], (0.0, 1.5 * h), method=method["name"], step=h
        )
        fine = pc.simulate(
            BOOK, START, [1.0, -0.5], (0.0, 1.5 * h), method=method["name"], step=h / 64
        )
        local.append(np.abs(coarse(theta * h) - fine(theta * h)).max())
    slopes = -np.diff(np.log2(local))
    assert slopes[-1] == pytest.approx(method["interpolant_order"] + 1, abs=0.2)


def test_the_slope_of_the_dense_output_has_the_order_of_the_interpolant(method):
    """Within one step, of the rates and of what the equations say; at its ends there is no error.

    The slope is that of the polynomial through nine points of the step.
    """
    points = (1 - np.cos(np.pi * np.arange(9) / 8)) / 2
    between = [0.15, 0.35, 0.55, 0.85]
    worst = []
    for h in (0.04, 0.02, 0.01):
        how = {"method": method["name"], "rtol": 1e-13, "atol": 1e-16, "step": h}
        run = pc.simulate(BOOK, START, [1.0, -0.5], (0.0, 1.5 * h), **how)
        step = np.polynomial.chebyshev.Chebyshev.fit
        curves = [step(points, curve, 8).deriv() for curve in run(points * h)]
        slopes = np.array([curve([0.0, *between, 1.0]) / h for curve in curves])
        for column, state in ((0, run.y[:, 0]), (-1, run.y[:, 1])):
            q, qd = np.split(state, 2)
            expected = [*qd, *BOOK.accelerations(0, q, qd)]
            np.testing.assert_allclose(slopes[:, column], expected, atol=1e-10)
        fine = {"rtol": 1e-13, "atol": 1e-15, "t_eval": np.multiply(between, h)}
        exact = pc.simulate(BOOK, START, [1.0, -0.5], (0.0, h), **fine)
        expected = np.hstack([exact.qd, exact.accelerations()]).T
        worst.append(np.abs(slopes[:, 1:-1] - expected).max())
    assert -np.diff(np.log2(worst))[-1] == pytest.approx(method["interpolant_order"], abs=0.2)


def test_the_dense_output_is_continuous_and_meets_the_steps(method):
    run = pc.simulate(BOOK, START, 0, (0.0, 5.0), method=method["name"], step=0.01)
    assert np.array_equal(run(run.t), run.y)
    before = run(run.t[1:] * (1 - 1e-15))
    assert np.abs(before - run.y[:, 1:]).max() < 1e-12


def test_the_docstring_of_simulate_names_every_method(method):
    for name in (method["name"], *method["aliases"]):
        assert f'``"{name}"``' in pc.simulate.__doc__


def test_no_two_methods_share_a_name():
    names = [name for m in _core.methods() for name in (m["name"], *m["aliases"])]
    assert len(set(names)) == len(names)
