"""A report tells laws, start, locks, method and largest reactions, and no rounding of 0."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore.derive import Derivation
from pendcore.derive.report import motion, report
from pendcore.derive.report.document import Document
from pendcore.derive.report.numbers import Start

pytestmark = pytest.mark.unsanitized

fx = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)


def case(n: int, *effects: Any, q0: Any = (0.3, 0.4, 0.6), **more: Any) -> pc.Case:
    scene = pc.Scene(links=[ROD] * n, effects=effects)
    return pc.Case(scene=scene, q0=q0[:n], t_span=(0, 2), **more)


def document(of: pc.Case) -> Document:
    return report(Derivation(of.scene), of, motion.solved(of))


def part(text: str, heading: str) -> str:
    return text.split(f"### {heading}\n")[1].split("\n##")[0]


@pytest.mark.parametrize(
    ("effect", "told"),
    [
        (
            fx.DrivenPivot(x=fx.Sinusoid(0.1, 3.0)),
            r"\ddot{x}_{A} = -0.9 \sin \left(3 t\right)\;\text{m}/\text{s}^{2}",
        ),
        (
            fx.RodDrag(link=2, drag_coefficient=1.2, diameter=0.1),
            r"F_{d,2} &= -\frac{0.0245 \left(w_{0,2} + w_{1,2}\right)",
        ),
        (fx.Motor(joint=1, constant=2.0), r"\tau_{1} = 2\;\text{N}\,\text{m}"),
    ],
)
def test_every_symbol_of_f_has_its_numbers_where_f_has_them(effect: Any, told: str) -> None:
    of = case(2, effect)
    text = part(document(of).markdown(), "The equations of motion with numbers")
    assert told.replace(r"\, ", "") in text.replace(r"\, ", "")
    derivation = Derivation(of.scene)
    s, write = derivation.symbols, derivation.symbols.latex
    free = set().union(*(x.free_symbols for x in derivation.motion.named.entries.values()))
    left = free - {s.t, *s.q, *s.qd, *derivation.values}
    assert left
    assert all(re.search(re.escape(write(x)) + " &?= ", text) for x in left)


def test_the_couple_of_a_lock_is_told_of_wherever_the_equations_are() -> None:
    of = case(3, fx.Lock(joint=2), fx.Lock(joint=3), fx.Payload(mass=0.5, inertia=0.01))
    text = document(of).markdown()
    told = part(text, "The equations of motion with numbers")
    assert r"\mathbf{f} + \boldsymbol{\lambda}" in told
    assert r"$\lambda_{2} = \Lambda_{2} - \Lambda_{3}$" in told
    assert r"M \ddot{q} = f$" not in text
    assert r"\ddot{\mathbf{q}} = \mathbf{f}$" not in text
    rows = {name: both for name, _, *both in Start(Derivation(of.scene), of).rows()}
    for name in (r"\Lambda_{2}", r"\Lambda_{3}"):
        own, core = rows[name]
        assert own == pytest.approx(core, rel=1e-13)
        assert abs(own) > 0.1
        assert f"| ${name}$ | " in text
    assert "the condition that a locked joint does not turn" in told


@pytest.mark.parametrize("degrees", [(90.0, 90.0), (180.0, 90.0), (-90.0, -90.0), (90.0, 0.0)])
def test_rounding_of_0_is_not_printed_at_the_start(degrees: tuple[float, float]) -> None:
    text = part(document(case(2, q0=np.radians(degrees))).markdown(), "At the start")
    before, after = text.split("The two differ by at most")
    assert not re.search(r"10\^\{-(1[2-9]|[2-9]\d)\}", before), before
    assert text.count("printed as 0") == 1
    assert "is what rounding leaves of 0" in after


def test_what_is_small_but_not_rounding_is_printed() -> None:
    small = pc.Link(mass=1e-8, length=1e-3)
    scene = pc.Scene(links=[ROD, small])
    text = document(pc.Case(scene=scene, q0=0.3, t_span=(0, 0.01))).markdown()
    assert r"M_{22} &= 3.33333 \times 10^{-15}" in part(text, "At the start")


def test_a_run_at_rest_is_said_to_be_one() -> None:
    text = document(case(2, q0=np.radians([90.0, 90.0]))).markdown()
    assert "of the largest kinetic energy" not in text
    assert "within $0" not in text
    assert "$-0.0000$" not in text
    assert re.search(r"and it (does not change in any digit|stays within .*; nothing moves)", text)
    assert r"|\mathbf{F}_{01}| = 19.61\;\text{N}$ throughout" in text


def size_at(solution: pc.Solution, t: Any) -> Any:
    states, n = solution(t).T, len(solution.scene.links)
    forces = solution.scene._compiled.reactions(t, states[:, :n], states[:, n:])
    return np.linalg.norm(forces, axis=-1)


@pytest.mark.parametrize(
    "of",
    [
        pc.Case.textbook(),
        case(3, fx.DrivenPivot(y=fx.Sinusoid(0.02, 80.0)), q0=(-1.4, -1.5, 0.2)),
        case(2, options={"method": "rk4", "step": 1e-3}),
    ],
    ids=["textbook", "shaken", "rk4"],
)
def test_the_largest_reactions_are_those_of_a_fine_grid_to_four_digits(of: pc.Case) -> None:
    solution = motion.solved(of)
    t = np.linspace(*of.t_span, 40_001)
    sizes = size_at(solution, t)
    step = t[1] - t[0]
    told = document(of).markdown()
    for i, peak in enumerate(solution.largest_reactions()):
        assert peak.force >= sizes[:, i].max()
        k = int(sizes[:, i].argmax())
        assert abs(peak.t - t[k]) <= step
        near = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 4_001)
        assert peak.force == pytest.approx(size_at(solution, near)[:, i].max(), rel=1e-9)
        at_peak = size_at(solution, np.array([peak.t]))[0, i]
        assert at_peak == pytest.approx(peak.force, rel=1e-13)
        assert rf"= {peak.force:.4g}\;\text{{N}}$ at $t = {peak.t:.4g}\;" in told
