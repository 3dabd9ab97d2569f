"""The errata once more, in symbols: what stands printed, minus what the derivation gives.

docs/reference/errata.md has these differences in a table; they hold for all masses, lengths and
angles.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pendcore as pc
import pytest
import sympy
from pendcore.derive.newton_euler import Balance
from reference import printed_equations as printed
from reference.printed_equations import ALL_REPAIRS, AS_PRINTED, Instant, Pendulum, Repairs
from symbolic_scenes import derivation

PAGE = Path(__file__).parents[2] / "docs/reference/errata.md"
BOOK = derivation(pc.Scene.textbook())
S = BOOK.symbols
(m1, m2), (L1, L2), g = S.masses, S.lengths, S.gravity
(q1, q2), (w1, w2), (a1, a2) = S.q, S.qd, S.qdd


@pytest.fixture(autouse=True)
def _sines_of_symbols(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let the printed equations be written with symbols."""
    monkeypatch.setattr(printed, "cos", sympy.cos)
    monkeypatch.setattr(printed, "sin", sympy.sin)
    return


PENDULUM: Any = Pendulum(m1=m1, m2=m2, L1=L1, L2=L2, g=g)
F21x, F21y = BOOK.equations.forces[1]
INSTANT: Any = Instant(q1=q1, q2=q2, w1=w1, w2=w2, a1=a1, a2=a2, F21=(F21x, F21y))


def with_forces(line: Balance) -> Balance:
    """Put in F21 from Newton's equations, as the program does; the text keeps it unknown."""
    return Balance(line.inertia, line.acting.xreplace(BOOK.equations.solved_forces))


ON_LINK_1, ON_LINK_2 = BOOK.equations.links
WITHOUT_1, WITHOUT_2 = BOOK.equations.without_reactions
SOLVED = [Balance(force, BOOK.equations.solved_forces[force]) for force in (F21x, F21y)]
TABLE = [
    ("determinants under (2.1)", printed.determinant_of_2_1, ON_LINK_1.moment),
    ("(2.2)", printed.equation_2_2, ON_LINK_1.moment),
    ("(2.5), x line; (2.6)", printed.x_line_of_2_5, ON_LINK_2.newton[0]),
    ("(2.5), y line; (2.7)", printed.y_line_of_2_5, ON_LINK_2.newton[1]),
    ("(2.5), determinant", printed.determinant_of_2_5, ON_LINK_2.moment),
    ("(2.8)", printed.equation_2_8, ON_LINK_2.moment),
    ("(2.9), x line", printed.x_line_of_2_9, SOLVED[0]),
    ("(2.9), y line", printed.y_line_of_2_9, SOLVED[1]),
    ("(2.10)", printed.equation_2_10, WITHOUT_1),
    ("(2.11)", printed.equation_2_11, WITHOUT_2),
    (
        "the program, `EqA`",
        lambda p, s: -printed.program_link_1(p, s),
        with_forces(ON_LINK_1.moment),
    ),
    (
        "the program, `Eq2`",
        lambda p, s: -printed.program_link_2(p, s),
        with_forces(ON_LINK_2.moment),
    ),
]


@pytest.mark.parametrize(("name", "equation", "derived"), TABLE, ids=[row[0] for row in TABLE])
def test_what_is_printed_differs_from_what_is_derived_by_what_the_page_says(
    name: str, equation: printed.Equation, derived: Balance
) -> None:
    difference = derived.inertia - derived.acting - equation(PENDULUM, INSTANT)
    (told,) = re.findall(rf"^\| {re.escape(name)} \| `(.*?)` \|$", PAGE.read_text(), re.MULTILINE)
    symbols = (m1, m2, L1, L2, g, q1, q2, a1, a2, F21x, F21y)
    names = {str(symbol): symbol for symbol in symbols} | {"R": derived.acting}
    assert sympy.expand(difference - sympy.sympify(told, names)) == 0


def system(repairs: Repairs) -> tuple[Any, Any]:
    """Return the mass matrix and right side of the printed (2.10) and (2.11)."""
    lines = [
        sympy.expand(equation(PENDULUM, INSTANT, repairs))
        for equation in (printed.equation_2_10, printed.equation_2_11)
    ]
    matrix = sympy.Matrix([[sympy.simplify(line.coeff(a)) for a in (a1, a2)] for line in lines])
    rest = sympy.Matrix([-line.subs({a1: 0, a2: 0}) for line in lines])
    return matrix, rest


def test_the_printed_determinant_is_that_of_the_page_for_all_masses_and_lengths() -> None:
    matrix, _ = system(AS_PRINTED)
    told = (m2 * L1 * L2) ** 2 * (sympy.cos(q1 - q2) ** 2 / 4 - sympy.Rational(2, 9))
    assert sympy.simplify((matrix.det() - told).rewrite(sympy.exp)) == 0


def test_the_derived_determinant_is_never_zero() -> None:
    ratio = BOOK.mass_matrix.det() / (m2 * L1 * L2) ** 2
    told = m1 / (9 * m2) + sympy.Rational(1, 3) - sympy.cos(q1 - q2) ** 2 / 4
    assert sympy.simplify(ratio - told) == 0


@pytest.mark.parametrize(("repairs", "same"), [(ALL_REPAIRS, True), (AS_PRINTED, False)])
def test_the_three_repairs_make_the_printed_system_the_derived_one(
    repairs: Repairs, same: bool
) -> None:
    matrix, rest = system(repairs)
    off = (matrix - BOOK.mass_matrix).applyfunc(sympy.simplify)
    left = (rest - BOOK.forcing).applyfunc(sympy.simplify)
    assert (off == sympy.zeros(2, 2) and left == sympy.zeros(2, 1)) == same
