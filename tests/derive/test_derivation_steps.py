"""The steps of a derivation: every equation that is printed holds, and reads well.

The equations are gone through in their order with the numbers of a true motion of the core. One
that names something new defines it; any other has to hold. So no sign in the prose of a step can
differ from what is computed.
"""

from __future__ import annotations

import pickle
import re
from typing import Any

import mpmath
import numpy as np
import pendcore as pc
import pytest
import sympy
from pendcore.derive import Derivation, Equation, Formula
from symbolic_scenes import SETS, derived, scene, states

pytestmark = pytest.mark.unsanitized

every_chain = pytest.mark.parametrize(
    ("name", "n"), [(name, n) for n in (1, 2, 3) for name in SETS]
)
TEXTBOOK = Derivation.textbook()
NUMBERS = ["2.1", "2.2", "2.3", "2.4", "2.5", "2.6", "2.7", "2.8", "2.9", "2.10", "2.11"]


def equations(derivation: Derivation) -> list[Equation]:
    return [equation for step in derivation.steps for equation in step.equations]


def scalars(derivation: Derivation) -> list[Equation]:
    return [
        e for e in equations(derivation) if not isinstance(e.lhs, Formula | tuple)
        and not isinstance(e.rhs, Formula)
    ]  # fmt: skip


def motion(name: str, n: int, seed: int) -> tuple[dict[Any, float], pc.Solution]:
    """Return what the core says of a state, by the derivation's symbols, and its solution."""
    drawn = scene(name, n, seed)
    (state,) = states(drawn, seed, count=1)
    now = pc.simulate(drawn, q0=state.q, qd0=state.qd, t_span=(state.t, state.t), store="steps")
    derivation = derived(name, n)
    s = derivation.symbols
    known = dict(Derivation(drawn).values)
    known |= {s.t: state.t, **dict(zip(s.q, state.q, strict=True))}
    known |= dict(zip(s.qd, state.qd, strict=True))
    known |= dict(zip(s.qdd, now.accelerations()[0], strict=True))
    for k, (pair, force) in enumerate(
        zip(derivation.equations.forces, now.reactions()[0], strict=True)
    ):
        known |= dict(zip(pair, force if k == 0 else -force, strict=True))
    couples = {
        derivation.equations.holding[joint]: couple
        for joint, couple in derivation.holding_couples.items()
    }
    known |= {symbol: value(couple, known) for symbol, couple in couples.items()}
    return known, now


def value(expression: Any, known: dict[Any, float]) -> float:
    with mpmath.workdps(30):
        symbols = sorted(expression.free_symbols, key=str)
        function = sympy.lambdify(symbols, expression, modules="mpmath")
        return float(function(*(mpmath.mpf(known[symbol]) for symbol in symbols)))


@every_chain
def test_every_printed_equation_holds_on_a_motion_of_the_core(name: str, n: int) -> None:
    known, now = motion(name, n, seed=1)
    size = 1 + np.abs(now.reactions()).max() + np.abs(now.accelerations()).max()
    held = 0
    payload = derived(name, n).equations.payload
    for symbol, law in derived(name, n).chain.path.items():
        known[symbol] = value(law, known)
    if payload is not None:  # the core does not tell the payload's force
        solved = derived(name, n).equations.solved_forces
        known |= {x: value(solved[x].xreplace(known), known) for x in payload.force}
    for equation in scalars(derived(name, n)):
        right = value(sympy.sympify(equation.rhs), known)
        if equation.lhs.is_Symbol and equation.lhs not in known:
            known[equation.lhs] = right
            continue
        assert abs(value(equation.lhs, known) - right) <= 1e-11 * size, str(equation)
        held += 1
    assert held >= 5 * n  # Newton's and Euler's alone are 3 n; as many again are solved
    check_first_order(n, known, now)
    check_energy(derived(name, n), known, now)


def check_first_order(n: int, known: dict[Any, float], now: pc.Solution) -> None:
    """Check the textbook's order of states: x(1) = q1, x(2) = qd1, and so on."""
    named = {symbol.name: x for symbol, x in known.items()}
    order = np.arange(2 * n).reshape(2, n).T.ravel()
    rates = np.concatenate([now.qd[0], now.accelerations()[0]])[order]
    assert [named[f"x({k + 1})"] for k in range(2 * n)] == list(now.y[order, 0])
    assert [named[f"d[x({k + 1})]/dt"] for k in range(2 * n)] == list(rates)


def check_energy(derivation: Derivation, known: dict[Any, float], now: pc.Solution) -> None:
    """Check that the energies are the core's, and that their change is the sum of the powers."""
    named = {symbol.name: x for symbol, x in known.items()}
    kinetic, potential = now.energy().kinetic[0], now.energy().potential[0]
    assert named["T"] == pytest.approx(kinetic, rel=1e-13)
    assert named["V"] == pytest.approx(potential, rel=1e-13, abs=1e-13)
    total = derivation.energy.kinetic + derivation.energy.potential
    rate = value(derivation.chain.rate(total), known)
    size = abs(rate) + sum(abs(x) for name, x in named.items() if re.fullmatch(r"P\d", name))
    assert abs(named["d(T + V)/dt"] - rate) <= 1e-11 * (1 + size)


def test_the_textbook_s_equations_have_its_numbers_once_each_and_in_order() -> None:
    assert [e.number for e in equations(TEXTBOOK) if e.number] == NUMBERS


def test_what_the_textbook_prints_otherwise_is_remarked_on_where_it_is() -> None:
    remarked = {e.number for e in equations(TEXTBOOK) if e.remark}
    assert remarked == {"2.2", "2.5", None, "2.7", "2.8", "2.9", "2.10", "2.11"}  # None: y of (2.5)
    others = [e for n in (1, 3) for e in equations(derived("none", n))]
    assert not any(e.remark or e.number for e in others)


def test_two_drags_on_a_rod_are_told_apart() -> None:
    drag = pc.effects.RodDrag(link=2, drag_coefficient=1.0, diameter=0.1)
    rod = pc.Link(mass=1.0, length=1.0)
    both = Derivation(pc.Scene(links=[rod, rod], effects=[drag, drag.replace(diameter=0.2)]))
    found = equations(both)
    assert [str(e.lhs) for e in found if str(e.lhs).startswith("D2")] == ["D2", "D2__2"]
    (newton,) = (e for e in found if e.number == "2.3")
    assert str(newton.rhs) == "F12 + G2 + D2 + D2__2"
    (euler,) = (e for e in found if e.number == "2.4")
    assert str(euler.rhs).endswith("r_C2B x D2 + Td_2__2 k + r_C2B x D2__2")


def by_number(number: str) -> Equation:
    return next(e for e in equations(TEXTBOOK) if e.number == number)


@pytest.mark.parametrize(
    ("number", "text"),
    [
        ("2.1", "I_A alpha1 = r_AC1 x G1 + r_AB x F21"),
        ("2.2", "m1*L1**2/3*qdd1 = F21y*L1*cos(q1) - F21x*L1*sin(q1) + m1*g*L1/2*cos(q1)"),
        ("2.3", "m2 a_C2 = F12 + G2"),
        ("2.4", "I_C2 alpha2 = r_C2B x F12"),
        (
            "2.6",
            "m2*(-L1*qdd1*sin(q1) - L1*qd1**2*cos(q1) - L2/2*qdd2*sin(q2) "
            "- L2/2*qd2**2*cos(q2)) = -F21x",
        ),
        ("2.8", "m2*L2**2/12*qdd2 = F21y*L2/2*cos(q2) - F21x*L2/2*sin(q2)"),
    ],
)
def test_an_equation_reads_as_the_textbook_s(number: str, text: str) -> None:
    assert str(by_number(number)) == f"{text}    ({number})"


def test_latex_is_written_as_the_textbook_prints() -> None:
    assert by_number("2.2").latex() == (
        r"\frac{m_{1} L_{1}^{2}}{3} \ddot{q}_{1} &= F_{21y} L_{1} \cos q_{1} "
        r"- F_{21x} L_{1} \sin q_{1} + \frac{m_{1} g L_{1}}{2} \cos q_{1}"
    )
    assert by_number("2.1").latex() == (
        r"I_{A} \boldsymbol{\alpha}_{1} &= \mathbf{r}_{AC_{1}} \times \mathbf{G}_{1} "
        r"+ \mathbf{r}_{AB} \times \mathbf{F}_{21}"
    )


@every_chain
def test_text_is_read_back_as_what_it_was(name: str, n: int) -> None:
    derivation = derived(name, n)
    for equation in scalars(derivation):
        for side in (equation.lhs, equation.rhs):
            side = sympy.sympify(side)
            names = {symbol.name: symbol for symbol in side.free_symbols}
            if all(name.isidentifier() for name in names):
                again = sympy.sympify(derivation.symbols.text(side), locals=names)
                assert sympy.expand(again - side) == 0


@every_chain
def test_latex_is_balanced_and_knows_every_symbol(name: str, n: int) -> None:
    derivation = derived(name, n)
    for equation in equations(derivation):
        latex = equation.latex()
        assert latex.count("{") == latex.count("}")
        assert latex.count(r"\left") == latex.count(r"\right")
        assert latex.count("&=") == 1
        assert not re.search(r"\}\^\{[^{}]*\}\^", latex), latex  # no superscript on another
        words = set(re.findall(r"(?<![\\A-Za-z])[A-Za-z]{2,}", re.sub(r"\\begin.*?}", "", latex)))
        assert words <= {"vmatrix", "AB", "AC", "AP"}, latex
    whole = derivation.latex()
    assert whole.count(r"\begin{align}") == whole.count(r"\end{align}") > n


@every_chain
def test_the_steps_are_numbered_and_told_in_sentences(name: str, n: int) -> None:
    for k, step in enumerate(derived(name, n).steps, start=1):
        assert step.number == k
        assert step.text.endswith(".")
        assert step.text.count("$") % 2 == 0
        assert "$" not in str(step)
        assert "\\" not in str(step)
        assert ".." not in step.text
        assert "  " not in step.text


def test_a_step_and_a_derivation_show_themselves_in_a_notebook() -> None:
    step = TEXTBOOK.steps[-3]
    shown = step._repr_markdown_()
    assert shown.startswith(f"### {step.number}. {step.title}\n")
    assert "$$\n\\begin{align}" in shown
    assert step._repr_markdown_() in TEXTBOOK._repr_markdown_()
    assert step.equations[0]._repr_latex_().startswith(r"$\displaystyle ")
    assert r"\tag{2.2}" in by_number("2.2")._repr_latex_()


@every_chain
def test_text_fits_a_terminal_and_loses_nothing(name: str, n: int) -> None:
    for step in derived(name, n).steps:
        shown = str(step)
        pieces = shown.replace("\n        ", " ")
        assert all(f"    {equation}" in pieces for equation in step.equations)
        for line in shown.splitlines():
            assert len(line) <= 100 or " " not in line.strip()  # only one factor may be longer


def test_a_derivation_pickles_by_its_scene() -> None:
    again = pickle.loads(pickle.dumps(TEXTBOOK))
    assert again.accelerations == TEXTBOOK.accelerations
    assert str(pickle.loads(pickle.dumps(TEXTBOOK.steps))) == str(TEXTBOOK.steps)


def test_a_derivation_prints_its_steps_and_tells_of_its_scene() -> None:
    assert str(TEXTBOOK) == "\n\n".join(map(str, TEXTBOOK.steps)) + "\n"
    assert repr(TEXTBOOK) == f"Derivation({TEXTBOOK.scene!r})"
