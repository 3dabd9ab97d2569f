"""A derivation's expressions are written in each language, and what they share is found."""

from __future__ import annotations

import pytest
import sympy
from pendcore.derive.code.layout import identifiers, wrapped
from pendcore.derive.code.printer import Cpp, NumPy, Octave, number
from pendcore.derive.code.shared import share

q1, q2, m, L, c = sympy.symbols("q1 q2 m L c1", real=True)
third = sympy.Rational(1, 3)


@pytest.mark.parametrize(
    ("expression", "octave", "numpy", "cpp"),
    [
        (m * L**2 / 12, "L^2*m/12", "L**2*m/12", "square(L)*m/12.0"),
        (third + m, "m + 1/3", "m + 1/3", "m + 1.0/3.0"),
        (-m / 2, "-m/2", "-m/2", "-m/2.0"),
        (m / L**2, "m/L^2", "m/L**2", "m/square(L)"),
        (m / (q1 + L) ** 3, "m/(L + q1)^3", "m/(L + q1)**3", "m/cube(L + q1)"),
        (L**4, "L^4", "L**4", "std::pow(L, 4.0)"),
        (1 / m, "1/m", "1/m", "1.0/m"),
        (sympy.Abs(q1) * q1, "q1*abs(q1)", "q1*abs(q1)", "q1*std::abs(q1)"),
        (sympy.cos(q1 - q2), "cos(q1 - q2)", "np.cos(q1 - q2)", "std::cos(q1 - q2)"),
        (sympy.Float(9.807) * m, "9.807*m", "9.807*m", "9.807*m"),
    ],
)
def test_an_expression_is_written_as_the_language_computes_it(
    expression: object, octave: str, numpy: str, cpp: str
) -> None:
    written = [language({}).doprint(expression) for language in (Octave, NumPy, Cpp)]
    assert written == [octave, numpy, cpp]


def test_symbols_have_the_names_that_a_file_gives_them() -> None:
    assert Octave({q1: "x(1)"}).doprint(sympy.sin(q1) * q2) == "q2*sin(x(1))"


@pytest.mark.parametrize("language", [Octave, NumPy, Cpp])
def test_a_function_that_a_language_has_no_name_for_is_refused(language: type) -> None:
    with pytest.raises(NotImplementedError, match="tan"):
        language({}).doprint(sympy.tan(q1))
    with pytest.raises(NotImplementedError, match="Piecewise"):
        language({}).doprint(sympy.Piecewise((m, q1 > 0), (L, True)))


def test_numbers_read_back_as_the_same_doubles() -> None:
    for value in (1.0, 9.807, 0.1, 1e-100, 1e300, -2.0, 1 / 3):
        assert float(number(value)) == value
    assert number(2.0) == "2"


def test_what_is_shared_is_computed_once_before_it_is_needed() -> None:
    f = sympy.Symbol("f", real=True)
    found = share([f * sympy.sin(q1), f + L**2 * m], [(f, L**2 * m * sympy.cos(q1 - q2))])
    known = {q1, q2, m, L}
    for symbol, value in found.assignments:
        assert value.free_symbols <= known
        known.add(symbol)
    assert {str(symbol) for symbol in known} > {"f", "sin_q1", "cos_q1_q2", "e1"}
    assert found.needs == {q1, q2, m, L}
    values = dict(found.assignments)
    results = [*found.results]
    for symbol, value in reversed(values.items()):
        results = [result.xreplace({symbol: value}) for result in results]
    once = L**2 * m
    assert results == [once * sympy.cos(q1 - q2) * sympy.sin(q1), once * sympy.cos(q1 - q2) + once]


def test_assignments_that_nothing_uses_are_left_out() -> None:
    f, h = sympy.symbols("f h")
    found = share([f + 1], [(f, q1 * m), (h, q2 * f)])
    assert [symbol for symbol, _ in found.assignments] == [f]


def test_names_that_are_taken_are_not_given_again() -> None:
    taken = share([(q1 + m) ** 2 + (q1 + m) * L], taken=["e1"])
    assert [str(symbol) for symbol, _ in taken.assignments] == ["e2"]
    again = sympy.Symbol("c1__2"), sympy.Symbol("lambda"), sympy.Symbol("t"), sympy.Symbol("c1_2")
    assert [*identifiers(again, ["t"]).values()] == ["c1_2", "lambda_", "t_", "c1_2_"]


def test_long_statements_go_on_further_in() -> None:
    lines = wrapped(" + ".join(["quantity"] * 20), "  ", " ...")
    assert len(lines) > 1
    assert all(len(line) <= 100 and line.endswith(" ...") for line in lines[:-1])
    assert lines[1].startswith("      ")
    assert "".join(line.removesuffix(" ...") for line in lines).count("quantity") == 20
