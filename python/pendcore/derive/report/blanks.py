"""What a worksheet shows of an equation: a left side that gives no other blank away."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from sympy import Expr

from pendcore.derive import narration
from pendcore.derive.algebra import Algebra
from pendcore.derive.narration.page import Page
from pendcore.derive.step import Equation, Formula, Step

ROOM = r"\qquad" * 7
"""Room in which an acceleration is written by hand."""


def concealed(derivation: Algebra) -> tuple[Step, ...]:
    """Return the steps, with names in the left sides for what other steps find.

    In the solution, left sides are ``m2 L2^2/12 qdd2``, say, and m2 times the acceleration of C_2
    written out; here they are ``I_C2 qdd2`` and ``m2 xdd_C2``.
    """
    names = _names(derivation)
    return tuple(_concealed(step, names) for step in narration.steps(derivation))


def _concealed(step: Step, names: dict[Any, Any]) -> Step:
    equations = tuple(
        replace(equation, lhs=names.get(equation.lhs, equation.lhs)) for equation in step.equations
    )
    return replace(step, equations=tuple(_without_repetition(equations)))


def _without_repetition(equations: tuple[Equation, ...]) -> list[Equation]:
    """Leave room in a left side that was there before: now the acceleration is to be put in.

    Where nothing is to be put in, the second is the first with its value: one blank will do.
    """
    found: list[Equation] = []
    for equation in equations:
        left = equation.lhs
        if equation.number and isinstance(left, Expr) and left in [e.lhs for e in found]:
            *factors, last = (equation.side_latex(factor) for factor in left.as_ordered_factors())
            room = rf"\underbrace{{{ROOM}}}_{{{last}}}"
            known = Formula(f"{left}, put in", rf"{' '.join(factors)} \, {room}")
            equation = replace(equation, lhs=known)
        elif left in [e.lhs for e in found]:
            continue
        found.append(equation)
    return found


def _names(derivation: Algebra) -> dict[Any, Any]:
    """Return what stands for each left side that would give something away."""
    page, found = Page(derivation), dict[Any, Any]()
    for i, link in enumerate(derivation.equations.links, start=1):
        inertia = page.moment_of_inertia(i)
        if link.about_pivot:
            inertia = page.symbol("I_A", "I_{A}")
        turning = inertia * page.s.qdd[i - 1]
        found[link.moment.inertia] = turning
        found[page.along("k", link.moment.inertia)] = page.along("k", turning)
        for axis, line in zip("xy", link.newton, strict=True):
            acceleration = page.coordinate(axis, page.center(i), 2)
            found[line.inertia] = page.s.masses[i - 1] * acceleration
    return found
