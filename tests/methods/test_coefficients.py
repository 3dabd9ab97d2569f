"""The constants of methods and of the core's own functions are those of their definitions."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt
from pathlib import Path

import mpmath
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import log, mp
from pendcore import _core
from reference import minimax
from reference.order_conditions import StageWeights, misses, order, trees
from reference.radau_iia import coefficients

# Polynomials of the core's own functions --------------------------------------------------------

CPP = Path(__file__).parents[2] / "cpp/src/arithmetic"
SINE_COSINE, POWER = CPP / "sine_cosine.hpp", CPP / "power.hpp"


def hexadecimal(x):
    """A double as C++ writes it, without trailing zeros."""
    mantissa, exponent = float(x).hex().split("p")
    return f"{mantissa.rstrip('0')}p{exponent}"


def constants(path):
    words = path.read_text().replace(",", " ").replace("{", " ").replace("}", " ").split()
    found = (word.rstrip(";") for word in words if word.lstrip("-").startswith("0x"))
    return {hexadecimal(float.fromhex(word)) for word in found if "p" in word}


@pytest.fixture(scope="module")
def fits():
    with mp.workdps(50):
        return minimax.fits()


@pytest.mark.unsanitized
@pytest.mark.parametrize(
    ("name", "path", "bits"),
    [
        ("sine", SINE_COSINE, 57),
        ("cosine", SINE_COSINE, 62),
        ("exp2", POWER, 34),
        ("log2", POWER, 29.9),
    ],
)
def test_polynomials_are_minimax_fits(name, path, bits, fits):
    fitted, error = fits[name]
    assert {hexadecimal(c) for c in fitted} <= constants(path)
    assert error < 2.0**-bits


@pytest.mark.unsanitized
def test_the_parts_of_half_pi_add_up_and_the_bits_of_two_over_pi_are_all_there():
    with mp.workdps(60):
        parts = minimax.half_pi_parts()
        assert {hexadecimal(part) for part in parts} <= constants(SINE_COSINE)
        assert log(abs(mp.pi / 2 - sum(parts)), 2) < -140
    source = (CPP / "sine_cosine.cpp").read_text()
    with mp.workprec(1400):
        assert all(f"0x{word:016x}" in source for word in minimax.two_over_pi_words(20))


# Explicit methods: each coefficient is the nearest double, whatever a long double is ------------
# That comes from whole numbers alone: sqrt(6) as a fraction of 2^400, whose error is far below half
# of the distance of any of these values from the middle of two doubles.

SQRT_6 = Fraction(isqrt(6 << 800), 1 << 400)
WHOLE = st.integers(-(2**62), 2**62)


def nearest(numerator, denominator, root):
    return float((numerator + root * SQRT_6) / denominator)


def triples(rows):
    if isinstance(rows[0], int):
        yield rows
    else:
        for row in rows:
            yield from triples(row)


@pytest.mark.parametrize("method", [m["name"] for m in _core.methods() if m["kind"] == "explicit"])
def test_every_coefficient_is_the_nearest_double(method):
    table = _core.tableau(method)
    assert all(_core.nearest_double(*one) == nearest(*one) for one in triples(list(table.values())))


@given(WHOLE, st.integers(1, 2**62), st.one_of(st.just(0), st.integers(-(2**53), 2**53)))
def test_any_fraction_is_rounded_to_the_nearest_double(numerator, denominator, root):
    exact = numerator + root * SQRT_6
    assume(abs(exact) > 2**-40 * (abs(numerator) + 1))  # tables have no such cancellation
    found = _core.nearest_double(numerator, denominator, root)
    assert found == nearest(numerator, denominator, root)


# Radau ------------------------------------------------------------------------------------------

EXACT = coefficients()
RADAU = {name: name for name in ("c", "a", "real", "alpha", "beta", "interpolant", "correction")}
RADAU |= {"t": "transformation", "t_inverse": "inverse"}


def rounded(value):
    return [rounded(x) for x in value] if isinstance(value, list) else float(value)


@pytest.mark.parametrize("name", RADAU)
def test_radau5_has_the_exact_numbers_rounded_once(name):
    assert _core.tableau("radau5")[RADAU[name]] == rounded(EXACT[name])


def test_the_weights_of_radau5_have_order_five_and_no_more():
    with mpmath.workdps(60):
        weights = StageWeights(EXACT["a"])
        largest = [
            max(float(abs(misses(weights, EXACT["a"][2], tree))) for tree in trees(nodes))
            for nodes in range(1, 7)
        ]
    assert max(largest[:5]) < 1e-50
    assert largest[5] > 1e-5
    assert order(trees(6)[0]) == 6


def test_the_nodes_of_radau5_are_zeros_and_its_transformation_turns_the_inverse_into_a_rotation():
    t, a = mpmath.matrix(EXACT["t"]), mpmath.matrix(EXACT["a"])
    real, alpha, beta = EXACT["real"], EXACT["alpha"], EXACT["beta"]
    assert EXACT["c"][2] == 1
    with mpmath.workdps(60):
        for x in EXACT["c"]:  # d^2/dx^2 (x^2 (x - 1)^3) / (2 (x - 1))
            assert abs((x - 1) * (10 * x**2 - 8 * x + 1)) < mpmath.mpf(10) ** -55
        found = mpmath.matrix(EXACT["t_inverse"]) * a**-1 * t
        wanted = mpmath.matrix([[real, 0, 0], [0, alpha, -beta], [0, beta, alpha]])
        assert mpmath.mnorm(found - wanted, 1) < mpmath.mpf(10) ** -50
