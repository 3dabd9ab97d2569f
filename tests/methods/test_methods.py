"""Every method of the list: order conditions in exact fractions, convergence, dense output."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore.methods import known_methods, most_accurate
from reference.order_conditions import Quadratic, StageWeights, misses, order_of, trees
from reference.trajectories import trajectory

METHODS = {method["name"]: method for method in _core.methods()}
EXPLICIT = [method for method in METHODS.values() if method["kind"] == "explicit"]
# tolerances choose the order of "taylor": tests/methods/test_taylor.py
OF_ONE_ORDER = [method for name, method in METHODS.items() if not name.startswith("taylor")]
BOOK = pc.Scene.textbook()
START = [np.pi / 4, np.pi / 3]


def name_of(method):
    return method["name"]


@pytest.fixture(params=METHODS.values(), ids=name_of)
def method(request):
    return request.param


@pytest.fixture(params=OF_ONE_ORDER, ids=name_of)
def of_one_order(request):
    return request.param


@pytest.fixture(params=EXPLICIT, ids=name_of)
def explicit(request):
    return request.param


# Order conditions -------------------------------------------------------------------------------


def exact(rows):
    """Turn (numerator, denominator, root of 6) into numbers, in tuples as deep as they are."""
    if isinstance(rows[0], int):
        numerator, denominator, root = rows
        rational = Fraction(numerator, denominator)
        return Quadratic(rational, Fraction(root, denominator)) if root else rational
    return tuple(exact(row) for row in rows)


@pytest.fixture
def tableau(explicit):
    table = {key: exact(rows) for key, rows in _core.tableau(explicit["name"]).items()}
    stages = range(len(table["a"]))
    # the coefficients of theta, theta^2, ... for each stage
    functions = list(zip(table.pop("functions"), table.pop("basis"), strict=True))
    powers = range(len(functions))
    table["interpolant"] = [
        [sum(weights[s] * basis[p] for weights, basis in functions) for p in powers] for s in stages
    ]
    return table


def test_the_weights_have_the_order_of_the_method_and_the_nodes_are_the_row_sums(explicit, tableau):
    assert order_of(tableau["a"], tableau["b"]) == explicit["order"]
    for i, row in enumerate(tableau["a"]):
        assert sum(row) == tableau["c"][i]
        assert not any(row[i:])


def test_the_embedded_weights_have_the_order_of_the_error(explicit, tableau):
    if explicit["error_order"] == 0:
        assert not any(tableau["e"])
        return
    first, second = (
        order_of(tableau["a"], tuple(b - e for b, e in zip(tableau["b"], row, strict=True)))
        for row in (tableau["e"], tableau["d"])
    )
    if any(tableau["d"]):  # |e|^2 / |d|
        assert 2 * (first + 1) - (second + 1) == explicit["error_order"] + 1
    else:
        assert first == explicit["error_order"]


def test_the_interpolant_has_its_order_all_along_the_step_and_no_more(explicit, tableau):
    weights_of, rows = StageWeights(tableau["a"]), tableau["interpolant"]

    def is_of_order(p):
        # The conditions up to order p are polynomials of degree p, or that of the interpolant.
        for theta in (Fraction(k, 9) for k in range(10)):
            weights = [sum(c * theta ** (k + 1) for k, c in enumerate(row)) for row in rows]
            of_order = (tree for nodes in range(1, p + 1) for tree in trees(nodes))
            if any(misses(weights_of, weights, tree, theta) for tree in of_order):
                return False
        return True

    assert is_of_order(explicit["interpolant_order"])
    assert not is_of_order(explicit["interpolant_order"] + 1)
    ends, stages = [sum(row) for row in rows], len(tableau["b"])
    assert tuple(ends[:stages]) == tableau["b"]  # at the new state
    assert not any(ends[stages:])


# Convergence ------------------------------------------------------------------------------------


def order_seen(method, counts, times):
    """Return the slope of the error over the last four decades above rounding.

    The error is the largest at the reference's ``times`` of the first half second, which a run
    takes in ``counts`` equal steps.
    """
    case = trajectory("textbook")
    t, exact = case.t[times], np.hstack([case.q, case.qd])[times].T
    # The tolerances say how far an implicit method solves its equations.
    how = {"method": method["name"], "compensated": True, "rtol": 1e-13, "atol": 1e-16}
    runs = [pc.simulate(BOOK, (0, 0.5), START, step=0.5 / n, **how) for n in counts]
    errors = np.array([np.abs(run(t) - exact).max() for run in runs])
    decades = np.log10(errors[: np.argmax(errors < 2.5e-14)] if min(errors) < 2.5e-14 else errors)
    assert decades[0] - decades[-1] > 4
    first = np.flatnonzero(decades - decades[-1] > 4)[-1]
    kept = slice(first, len(decades))
    return float(-np.polyfit(np.log10(counts)[kept], decades[kept], 1)[0])


def test_the_error_falls_at_the_order_over_four_decades(of_one_order):
    # Each time, a tenth of a second apart, is a step's end: the error is the steps' alone.
    counts = [5 * k for k in (2, 3, 4, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160)]
    seen = order_seen(of_one_order, counts, [2, 4, 6, 8, 10])
    assert seen == pytest.approx(of_one_order["order"], abs=0.2)


def test_the_dense_output_converges_at_its_order_between_the_steps(of_one_order):
    # Each time lies at the same share of a step, 0.2, 0.4, 0.6 or 0.8, in all runs.
    counts = [10 * k + 8 for k in (0, 1, 2, 3, 4, 6, 9, 14, 19, 29, 39, 59, 79, 159)]
    expected = min(of_one_order["order"], of_one_order["interpolant_order"] + 1)
    seen = order_seen(of_one_order, counts, [1, 2, 3, 4, 6, 7, 8, 9])
    assert seen == pytest.approx(expected, abs=0.4)


BETWEEN = np.array([0.15, 0.35, 0.55, 0.85])


def last_slope(errors):
    return -np.diff(np.log2(errors))[-1]


def test_the_slope_of_the_dense_output_has_the_order_of_the_interpolant(of_one_order):
    """Within one step, of the rates and of what the equations say; at its ends there is no error.

    The slope is that of the polynomial through nine points of the step.
    """
    points = (1 - np.cos(np.pi * np.arange(9) / 8)) / 2
    worst, fine = [], {"rtol": 1e-13, "atol": 1e-15}
    for h in (0.04, 0.02, 0.01):
        how = {"method": of_one_order["name"], "rtol": 1e-13, "atol": 1e-16, "step": h}
        run = pc.simulate(BOOK, (0.0, 1.5 * h), START, [1.0, -0.5], **how)
        fit = np.polynomial.chebyshev.Chebyshev.fit
        curves = [fit(points, curve, 8).deriv() for curve in run(points * h)]
        slopes = np.array([curve([0.0, *BETWEEN, 1.0]) / h for curve in curves])
        for column, state in ((0, run.y[:, 0]), (-1, run.y[:, 1])):
            q, qd = np.split(state, 2)
            expected = [*qd, *BOOK.accelerations(0, q, qd)]
            np.testing.assert_allclose(slopes[:, column], expected, atol=1e-10)
        exact = pc.simulate(BOOK, (0.0, h), START, [1.0, -0.5], t_eval=BETWEEN * h, **fine)
        expected = np.hstack([exact.qd, exact.accelerations()]).T
        worst.append(np.abs(slopes[:, 1:-1] - expected).max())
    assert last_slope(worst) == pytest.approx(of_one_order["interpolant_order"], abs=0.2)


def test_the_dense_output_is_continuous_and_meets_the_steps(method):
    run = pc.simulate(BOOK, (0.0, 5.0), START, method=method["name"], step=0.01)
    assert np.array_equal(run(run.t), run.y)
    before = run(run.t[1:] * (1 - 1e-15))
    assert np.abs(before - run.y[:, 1:]).max() < 1e-12


# The description of each method -----------------------------------------------------------------


def test_a_method_without_an_error_estimate_takes_fixed_steps_and_says_so(method):
    """Nor has it a tolerance to choose: ``error=`` never takes it."""
    how = {"method": method["name"]}
    if method["error_order"]:
        assert len(set(np.diff(pc.simulate(BOOK, (0, 1), START, **how).t))) > 2
    else:
        message = f'step: none given: method "{method["name"]}" estimates no error'
        with pytest.raises(ValueError, match=message):
            pc.simulate(BOOK, (0, 1), START, **how)
    sol = pc.simulate(BOOK, (0, 1), START, step=0.0625, **how)
    assert sol.t.tolist() == [k / 16 for k in range(17)]
    assert (sol.stats.accepted, sol.stats.rejected) == (16, 0)
    known = known_methods()[method["name"]]
    assert (known["error_over_rtol"] > 0) == (known["error_order"] > 0)
    for name in (method["name"], *method["aliases"]):
        assert f'``"{name}"``' in pc.simulate.__doc__


def test_no_two_methods_share_a_name_or_a_place_among_second_opinions():
    names = [name for m in METHODS.values() for name in (m["name"], *m["aliases"])]
    assert len(set(names)) == len(names)
    places = [one["second_opinion"] for one in known_methods().values() if one["second_opinion"]]
    assert sorted(places) == [*range(1, len(places) + 1)]
    assert len(most_accurate()) == len(places)
    lines = [tuple(one["line"]) for one in known_methods().values()]
    assert len({*lines}) == len(lines)
    assert all(one["citation"] for one in known_methods().values())
