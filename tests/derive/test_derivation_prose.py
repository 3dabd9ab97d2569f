"""What the steps refer to is there: numbers of the textbook, reactions, couples of locks."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pendcore as pc
import pytest
from pendcore.derive import Derivation, Equation
from pendcore.derive.report import motion, report
from pendcore.derive.report.document import Displayed
from symbolic_scenes import SETS, derived

pytestmark = pytest.mark.unsanitized

fx = pc.effects
every_chain = pytest.mark.parametrize(
    ("name", "n"), [(name, n) for n in (1, 2, 3) for name in SETS]
)
ROD = pc.Link(mass=1.0, length=1.0)


def equations(derivation: Derivation) -> list[Equation]:
    return [equation for step in derivation.steps for equation in step.equations]


@every_chain
def test_numbers_of_the_textbook_are_given_once_and_what_is_referred_to_is_there(
    name: str, n: int
) -> None:
    derivation = derived(name, n)
    numbers = [e.number for e in equations(derivation) if e.number]
    assert len(set(numbers)) == len(numbers)
    for step in derivation.steps:
        told = " ".join([step.text, *(e.remark for e in step.equations)])
        assert set(re.findall(r"\((2\.\d+)\)", told)) <= set(numbers), told
        for link, k in re.findall(r"link (\d+) \(step (\d+)\)", told):
            title = f"Newton-Euler equations of link {link}"
            assert derivation.steps[int(k) - 1].title == title


@pytest.mark.parametrize("name", SETS)
def test_a_number_is_that_of_the_textbook_s_equation(name: str) -> None:
    """A fixed pivot has (2.1), (2.2), (2.10), link 2 has all others; (2.5) is the determinant."""
    derivation = derived(name, 2)
    found = {e.number: str(e) for e in equations(derivation) if e.number}
    of_a_fixed_pivot = {"2.1", "2.2", "2.10"}
    own = {f"2.{k}" for k in range(1, 12)}
    assert found.keys() == (own if derivation.chain.pivot_is_fixed else own - of_a_fixed_pivot)
    assert found["2.3"].startswith("m2 a_C2 = F12")
    assert found["2.4"].startswith("I_C2 alpha2 = r_C2B x F12")
    assert "k = det[i, j, k; x_B - x_C2, y_B - y_C2, 0; -F21x, -F21y, 0]" in found["2.5"]


@every_chain
def test_no_reaction_is_left_in_the_equations_of_motion(name: str, n: int) -> None:
    derivation = derived(name, n)
    reactions = {symbol for pair in derivation.equations.forces for symbol in pair}
    if derivation.equations.payload is not None:
        reactions |= set(derivation.equations.payload.force)
    steps = [step for step in derivation.steps if step.title.startswith("Equations of motion")]
    assert len(steps) == (2 if n == 2 else 1)
    for step in steps:
        assert all(not reactions & equation.rhs.free_symbols for equation in step.equations)


@every_chain
def test_the_couple_of_a_lock_is_in_the_equations_of_motion(name: str, n: int) -> None:
    derivation = derived(name, n)
    text = " ".join(step.text for step in derivation.steps)
    locked = derivation.equations.locked
    assert (r"$M \ddot{q} = f$" in text) is (not locked)
    assert (r"$M \ddot{q} = f + \lambda$" in text) is bool(locked)
    if locked:
        assert re.search(r"The conditions? of the locks?, \$.* = 0\$", text)
        named = {str(e.lhs): e.rhs for e in equations(derivation)}
        for i in range(1, n + 1):
            holding = derivation.equations.holding
            assert named.get(f"lambda{i}", 0) == holding.get(i, 0) - holding.get(i + 1, 0)


def test_four_links_and_more_are_solved_by_elimination_on_less_than_a_page() -> None:
    for n, effects in ((4, []), (5, []), (5, [fx.Lock(joint=2)])):
        derivation = Derivation(pc.Scene(links=[ROD] * n, effects=effects))
        (step,) = (s for s in derivation.steps if s.title.startswith("Solution for"))
        assert "Cramer" not in step.text
        assert "L D L^{T}" in step.text
        known: dict[Any, Any] = {}
        for equation in step.equations[: -len(effects) or None]:
            assert len(equation.rows()) <= 2, equation
            known[equation.lhs] = equation.rhs.xreplace(known)
        numbers = {x: k % 7 + 30.0 * (str(x)[1] == str(x)[-1]) for k, x in enumerate(
            derivation.motion.named.entries)}  # fmt: skip
        if n == 4:
            by_cramer = zip(derivation.symbols.qdd, derivation.solution.by_entries, strict=True)
            for a, expression in by_cramer:
                found = float(known[a].xreplace(numbers))
                assert found == pytest.approx(float(expression.xreplace(numbers)), rel=1e-12)


@pytest.mark.parametrize("kind", [str, Path])
def test_a_folder_is_given_as_text_or_as_a_path(
    kind: type, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    case = pc.Case(scene=pc.Scene(links=[ROD]), q0=0.3, t_span=(0, 1))
    files = Derivation(case.scene).report(case, kind(tmp_path / "new"))
    assert files[0] == tmp_path / "new" / "report.md"


def test_no_equation_of_a_long_chain_is_longer_than_a_page() -> None:
    case = pc.Case(scene=pc.Scene(links=[ROD] * 5), q0=0.3, t_span=(0, 0.2))
    document = report(Derivation(case.scene), case, motion.solved(case))
    rows = [b.latex.count(r"\\") + 1 for b in document.blocks if isinstance(b, Displayed)]
    assert max(rows) <= 26
