"""The constants of the core's own functions are those that their derivation gives."""

from __future__ import annotations

from pathlib import Path

import pytest
from mpmath import log, mp
from reference import minimax

pytestmark = pytest.mark.unsanitized

CPP = Path(__file__).parents[2] / "cpp"
SINE_COSINE = CPP / "src/arithmetic/sine_cosine.hpp"
POWER = CPP / "src/arithmetic/power.hpp"


def hexadecimal(x) -> str:
    """A double as C++ writes it, without trailing zeros."""
    mantissa, exponent = float(x).hex().split("p")
    return f"{mantissa.rstrip('0')}p{exponent}"


def constants(path: Path) -> set[str]:
    words = path.read_text().replace(",", " ").replace("{", " ").replace("}", " ").split()
    found = (word.rstrip(";") for word in words if word.lstrip("-").startswith("0x"))
    return {hexadecimal(float.fromhex(word)) for word in found if "p" in word}


@pytest.fixture(scope="module")
def fits():
    with mp.workdps(50):
        return minimax.fits()


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
    coefficients, error = fits[name]
    assert {hexadecimal(c) for c in coefficients} <= constants(path)
    assert error < 2.0**-bits


def test_the_parts_of_half_pi_add_up():
    with mp.workdps(60):
        parts = minimax.half_pi_parts()
        assert {hexadecimal(part) for part in parts} <= constants(SINE_COSINE)
        assert log(abs(mp.pi / 2 - sum(parts)), 2) < -140


def test_the_bits_of_two_over_pi_are_all_there():
    source = (CPP / "src/arithmetic/sine_cosine.cpp").read_text()
    with mp.workprec(1400):
        assert all(f"0x{word:016x}" in source for word in minimax.two_over_pi_words(20))
