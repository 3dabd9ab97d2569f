"""The steps of a derivation: every equation that is printed holds, and reads well.

The equations are gone through in their order with the numbers of a true motion of the core. One
that names something new defines it; any other has to hold.
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
from pendcore.derive import Derivation, Equation, Formula, line_breaks
from symbolic_scenes import SETS, derivation, derived, scene, states

pytestmark = pytest.mark.unsanitized

every_chain = pytest.mark.parametrize(
    ("name", "n"), [(name, n) for n in (1, 2, 3) for name in SETS]
)
TEXTBOOK = derivation(pc.Scene.textbook())
NUMBERS = [f"2.{k}" for k in range(1, 12)]
ROD = pc.Link(mass=1.0, length=1.0)
fx = pc.effects


def equations(derivation: Derivation) -> list[Equation]:
    return [equation for step in derivation.steps for equation in step.equations]


def scalars(derivation: Derivation) -> list[Equation]:
    return [e for e in equations(derivation)
            if not isinstance(e.lhs, Formula) and not isinstance(e.rhs, Formula)]  # fmt: skip


def motion(name: str, n: int, seed: int) -> tuple[dict[Any, float], pc.Solution]:
    """Return what the core says of a state, by the derivation's symbols, and its solution."""
    drawn = scene(name, n, seed)
    (state,) = states(drawn, seed, count=1)
    now = pc.simulate(drawn, q0=state.q, qd0=state.qd, t_span=(state.t, state.t), store="steps")
    of = derived(name, n)
    s = of.symbols
    known = dict(derivation(drawn).values)
    known |= {s.t: state.t, **dict(zip(s.q, state.q, strict=True))}
    known |= dict(zip(s.qd, state.qd, strict=True))
    known |= dict(zip(s.qdd, now.accelerations()[0], strict=True))
    for k, (pair, force) in enumerate(zip(of.equations.forces, now.reactions()[0], strict=True)):
        known |= dict(zip(pair, force if k == 0 else -force, strict=True))
    for joint, couple in of.holding_couples.items():
        known[of.equations.holding[joint]] = value(couple, known)
    return known, now


def value(expression: Any, known: dict[Any, float]) -> float:
    with mpmath.workdps(30):
        symbols = sorted(expression.free_symbols, key=str)
        function = sympy.lambdify(symbols, expression, modules="mpmath")
        return float(function(*(mpmath.mpf(known[symbol]) for symbol in symbols)))


@pytest.mark.few_cases
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
    rate = value(derivation.chain.rate(sum(derivation.energies_by_definitions)), known)
    size = abs(rate) + sum(abs(x) for name, x in named.items() if re.fullmatch(r"P\d", name))
    assert abs(named["d(T + V)/dt"] - rate) <= 1e-11 * (1 + size)


def test_the_textbook_s_equations_have_its_numbers_and_remarks_on_what_it_prints() -> None:
    found = equations(TEXTBOOK)
    assert [e.number for e in found if e.number] == NUMBERS
    remarked = {e.number for e in found if e.remark}
    assert remarked == {"2.2", "2.5", None, "2.7", "2.8", "2.9", "2.10", "2.11"}  # None: y of (2.5)
    others = [e for n in (1, 3) for e in equations(derived("none", n))]
    assert not any(e.remark or e.number for e in others)


@pytest.mark.parametrize("name", SETS)
def test_a_number_is_that_of_the_textbook_s_equation(name: str) -> None:
    """A fixed pivot has (2.1), (2.2), (2.10), link 2 has all others; (2.5) is the determinant."""
    derivation = derived(name, 2)
    numbered = [e for e in equations(derivation) if e.number]
    found = {e.number: str(e) for e in numbered}
    assert len(found) == len(numbered)
    of_a_fixed_pivot = set() if derivation.chain.pivot_is_fixed else {"2.1", "2.2", "2.10"}
    assert found.keys() == {*NUMBERS} - of_a_fixed_pivot
    assert found["2.3"].startswith("m2 a_C2 = F12")
    assert found["2.4"].startswith("I_C2 alpha2 = r_C2B x F12")
    assert "k = det[i, j, k; x_B - x_C2, y_B - y_C2, 0; -F21x, -F21y, 0]" in found["2.5"]


@every_chain
def test_no_reaction_and_every_couple_of_a_lock_is_in_the_equations_of_motion(
    name: str, n: int
) -> None:
    derivation = derived(name, n)
    reactions = {symbol for pair in derivation.equations.forces for symbol in pair}
    if derivation.equations.payload is not None:
        reactions |= set(derivation.equations.payload.force)
    steps = [step for step in derivation.steps if step.title.startswith("Equations of motion")]
    assert len(steps) == (2 if n == 2 else 1)
    assert not any(reactions & e.rhs.free_symbols for step in steps for e in step.equations)
    text = " ".join(step.text for step in derivation.steps)
    assert (r"$M \ddot{q} = f$" in text) is not bool(derivation.equations.locked)
    assert (r"$M \ddot{q} = f + \lambda$" in text) is bool(derivation.equations.locked)
    named, holding = {str(e.lhs): e.rhs for e in steps[-1].equations}, derivation.equations.holding
    for i in range(1, n + 1):
        assert named.get(f"lambda{i}", 0) == holding.get(i, 0) - holding.get(i + 1, 0)


def test_two_drags_on_a_rod_are_told_apart() -> None:
    drag = fx.RodDrag(link=2, drag_coefficient=1.0, diameter=0.1)
    found = equations(derivation(pc.Scene(links=[ROD] * 2, effects=[drag, drag])))
    assert [e.lhs.text for e in found if str(e.lhs).startswith(r"\mathbf{D}")] == ["D2", "D2^(2)"]
    of = {e.number: e.rhs.text for e in found if e.number in ("2.3", "2.4")}
    assert of["2.3"] == "F12 + G2 + D2 + D2^(2)"
    assert "r_C2B x D2 + T" in of["2.4"]
    assert of["2.4"].endswith("r_C2B x D2^(2)")


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_payload_with_inertia_takes_a_couple_from_the_last_link(n: int) -> None:
    def payload(**own: float) -> tuple[list[str], str]:
        made = derivation(pc.Scene(links=[ROD] * n, effects=[fx.Payload(mass=0.5, **own)]))
        (step,) = (s for s in made.steps if s.title.endswith("of the payload"))
        return list(map(str, step.equations)), made.latex()

    turning, told = payload(inertia=0.1)
    assert turning[-1] == f"I_p alpha{n} = T_p"
    assert rf"$I_{{p}} \ddot{{q}}_{{{n}}}$" in told
    point, told = payload()
    assert len(point) == 3
    assert "I_{p}" not in told


@pytest.mark.parametrize(
    ("number", "text"),
    [
        ("2.1", "I_A alpha1 = r_AC1 x G1 + r_AB x F21"),
        ("2.2", "m1*L1**2*qdd1/3 = F21y*L1*cos(q1) - F21x*L1*sin(q1) + m1*g*L1*cos(q1)/2"),
        ("2.3", "m2 a_C2 = F12 + G2"),
        (
            "2.6",
            "m2*(-L1*qdd1*sin(q1) - L1*qd1**2*cos(q1) - L2*qdd2*sin(q2)/2 "
            "- L2*qd2**2*cos(q2)/2) = -F21x",
        ),
    ],
)
def test_an_equation_reads_as_the_textbook_s(number: str, text: str) -> None:
    (equation,) = (e for e in equations(TEXTBOOK) if e.number == number)
    assert str(equation) == f"{text}    ({number})"


def test_latex_is_written_as_the_textbook_prints() -> None:
    (equation,) = (e for e in equations(TEXTBOOK) if e.number == "2.2")
    assert equation.latex() == (
        r"\frac{m_{1} L_{1}^{2}}{3} \ddot{q}_{1} &= F_{21y} L_{1} \cos {q_{1}} "
        r"- F_{21x} L_{1} \sin {q_{1}} + \frac{m_{1} g L_{1}}{2} \cos {q_{1}}"
    )
    assert r"\tag{2.2}" in equation._repr_latex_()


@pytest.mark.few_cases
@every_chain
def test_text_and_latex_are_read_back(name: str, n: int) -> None:
    """SymPy reads the text as what it was; LaTeX is balanced, and has no name that is not one."""
    derivation = derived(name, n)
    for equation in scalars(derivation):
        for side in (equation.lhs, equation.rhs):
            side = sympy.sympify(side)
            shown = derivation.symbols.arranged(side, has_bars=True)  # as LaTeX has it
            assert sympy.expand(shown.doit() - side) == 0
            names = {symbol.name: symbol for symbol in side.free_symbols}
            if all(name.isidentifier() for name in names):
                again = sympy.sympify(derivation.symbols.text(side), locals=names)
                assert sympy.expand(again - side) == 0
    for equation in equations(derivation):
        latex = equation.latex()
        assert latex.count("{") == latex.count("}")
        assert latex.count(r"\left") == latex.count(r"\right")
        assert latex.count("&=") == 1
        assert not re.search(r"\}\^\{[^{}]*\}\^", latex), latex  # no superscript on another
        words = set(re.findall(r"(?<![\\A-Za-z])[A-Za-z]{2,}", re.sub(r"\\begin.*?}", "", latex)))
        assert words <= {"vmatrix", "AB", "AC", "AP"}, latex


@pytest.mark.few_cases
@every_chain
def test_the_steps_are_whole_in_every_form(name: str, n: int) -> None:
    derivation = derived(name, n)
    latex, shown = derivation.latex(), derivation._repr_markdown_()
    assert str(derivation) == "\n\n".join(map(str, derivation.steps)) + "\n"
    for k, step in enumerate(derivation.steps, start=1):
        assert step.number == k
        assert f"\\subsection*{{{k}. {step.title}}}" in latex
        assert f"### {k}. {step.title}\n" in shown
        text = str(step)
        assert not {"$", "\\"} & {*text}
        assert step.text.count("$") % 2 == 0
        pieces = text.replace("\n        ", " ")
        assert all(f"    {equation}" in pieces for equation in step.equations)
        assert all(len(line) <= 100 or " " not in line.strip() for line in text.splitlines())
    assert latex.count(r"\begin{aligned}") == latex.count(r"\end{aligned}") > n


def test_a_long_equation_is_broken_at_its_terms_and_loses_none() -> None:
    derivation = derived("all", 3)
    total = derivation.kinetic_energy
    rows = line_breaks.rows("T", derivation.symbols.latex(total))
    assert len(rows) > 3
    assert all(line_breaks.width(row) < line_breaks.LINE + 1 for row in rows)
    joined = "".join(row.replace("&=", "=").replace(r"&\quad ", "") for row in rows)
    assert joined.replace(" ", "") == f"T={derivation.symbols.latex(total)}".replace(" ", "")


def test_a_bracket_that_is_wider_than_a_line_is_opened() -> None:
    inside = " + ".join(rf"a_{{{k}}} \left(b_{{{k}}} - c\right)" for k in range(12))
    first, *more = line_breaks.rows("x", rf"m \left({inside}\right)^{{2}} - d")
    assert first.startswith(r"x &= m \bigl[a_{0} \left(b_{0} - c\right)")
    assert len(more) > 1
    assert more[-1].endswith(r"\bigr]^{2} - d")
    for row in (first, *more):
        assert row.count(r"\left") == row.count(r"\right")


def test_four_links_and_more_are_solved_by_elimination_on_less_than_a_page() -> None:
    for n, effects in ((4, []), (5, []), (5, [fx.Lock(joint=2)])):
        made = derivation(pc.Scene(links=[ROD] * n, effects=effects))
        (step,) = (s for s in made.steps if s.title.startswith("Solution for"))
        assert "L D L^{T}" in step.text
        known: dict[Any, Any] = {}
        for equation in step.equations[: -len(effects) or None]:
            assert len(equation.rows()) <= 2, equation
            known[equation.lhs] = equation.rhs.xreplace(known)
        numbers = {x: k % 7 + 30.0 * (str(x)[1] == str(x)[-1])
                   for k, x in enumerate(made.named.entries)}  # fmt: skip
        if n == 4:
            by_cramer = zip(made.symbols.qdd, made.by_entries, strict=True)
            for a, expression in by_cramer:
                found = float(known[a].xreplace(numbers))
                assert found == pytest.approx(float(expression.xreplace(numbers)), rel=1e-12)


def test_a_derivation_pickles_by_its_scene() -> None:
    again = pickle.loads(pickle.dumps(TEXTBOOK))
    assert again.accelerations == TEXTBOOK.accelerations
    assert str(pickle.loads(pickle.dumps(TEXTBOOK.steps))) == str(TEXTBOOK.steps)
    assert repr(TEXTBOOK) == f"Derivation({TEXTBOOK.scene!r})"
