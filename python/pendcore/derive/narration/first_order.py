"""The equations of motion solved, and as a first-order system."""

from __future__ import annotations

from pendcore.derive.narration.page import Page
from pendcore.derive.step import Equation
from pendcore.derive.writing import ANGLE, RATE

BY_ELIMINATION = 4
"""The number of unknown accelerations from which determinants are longer than a page."""


def first_order(page: Page) -> None:
    """Write the solution and the first-order form."""
    _solution(page)
    _states(page)


def _solution(page: Page) -> None:
    solution, motion = page.derivation.solution, page.motion
    unknowns = motion.turning_together.cols
    text = "The equations of motion are linear in the accelerations"
    if page.n == 1:
        text = "The equation of motion is divided by the factor of the acceleration"
    if page.equations.locked:
        text = _without_couples(page, text)
        matrix, right, first = "B^{T} M B", "B^{T} f", ""
    else:
        matrix, right, first = "M", "f", ", with $D_{1} = M_{11}$ and $h_{1} = f_{1}$"
    found = list[Equation]()
    if unknowns >= BY_ELIMINATION:
        kept = "links that turn as one share an unknown, $\\dot{q} = B r$, and " * bool(
            page.equations.locked
        )
        text += (
            f"; {kept}elimination solves them: ${matrix} = L D L^{{T}}$, where $L$ has ones on its "
            "diagonal, its entries $\\ell_{ij}$ below and zeros above, and $D$ is diagonal"
            f"{first}. Then $L h = {right}$ gives $h$, and $L^{{T}} a = D^{{-1}} h$ gives the "
            "accelerations $a$, the last one first"
        )
        found = [page.equation(*assignment) for assignment in solution.by_elimination]
        accelerations = solution.shared_accelerations
    else:
        accelerations = solution.by_entries
    if unknowns < BY_ELIMINATION and page.n > 1 and not page.equations.locked:
        text += "; Cramer's rule solves them"
    if page.equations.locked:
        text += f". {_condition(page)}"
    page.step(
        f"Solution for the angular acceleration{'s' if page.n > 1 else ''}",
        f"{text}.",
        *found,
        *(page.equation(a, value) for a, value in zip(page.s.qdd, accelerations, strict=True)),
        *(
            page.equation(page.equations.holding[joint], couple)
            for joint, couple in solution.holding.items()
        ),
    )


def _without_couples(page: Page, text: str) -> str:
    """Say how the couples of locks are taken out of the equations."""
    locked = page.equations.locked
    held = [joint for k, joint in enumerate(locked, start=1) if joint == k]
    if page.n == len(held):
        whose = "The link is" if page.n == 1 else "All links are"
        return f"{whose} held by the ground: no equation is needed to find that nothing turns"
    links = " and ".join(filter(None, [", ".join(map(str, held[:-1])), *map(str, held[-1:])]))
    left_out = (
        f"link {links} is held by the ground, and its equation is left out"
        if len(held) == 1
        else f"links {links} are held by the ground, and their equations are left out"
    )
    added = "the equations of the links that a lock makes turn as one are added"
    told = [left_out] * bool(held) + [added] * (len(locked) > len(held))
    whose = "the couple of the lock" if len(locked) == 1 else "the couples of the locks"
    return f"{text}; {'; '.join(told)}, which takes {whose} out of them"


def _condition(page: Page) -> str:
    """Say what the couples of locks are found from."""
    couples = [page.s.latex(symbol) for symbol in page.equations.holding.values()]
    conditions = [
        page.s.latex(page.chain.joint_acceleration(joint)) + " = 0"
        for joint in page.equations.locked
    ]
    one = len(couples) == 1
    return (
        f"The condition of the lock, ${conditions[0]}$, is the equation that finds "
        f"${couples[0]}$: it is what the lock must add to $f$ so that ${page.motion.law}$ holds "
        "with these accelerations"
        if one
        else f"The conditions of the locks, {_listed(conditions)}, are the equations that find "
        f"{_listed(couples)}: they are what the locks must add to $f$ so that "
        f"${page.motion.law}$ holds with these accelerations"
    )


def _listed(formulas: list[str]) -> str:
    *most, last = (f"${formula}$" for formula in formulas)
    return f"{', '.join(most)} and {last}"


def _states(page: Page) -> None:
    names, rates = [], []
    for i, (q, qd, qdd) in enumerate(zip(page.s.q, page.s.qd, page.s.qdd, strict=True)):
        k = 2 * i + 1
        x = page.symbol(f"x({k})", f"x_{{{k}}}", ANGLE)
        xd = page.symbol(f"x({k + 1})", f"x_{{{k + 1}}}", RATE)
        names += [page.equation(x, q), page.equation(xd, qd)]
        for name, value in ((x, xd), (xd, qdd)):
            rate = page.symbol(f"d[{name}]/dt", rf"\dot{{x}}_{{{str(name)[2:-1]}}}")
            rates.append(page.equation(rate, value))
    page.step(
        "First-order form",
        "The equations of second order become a system of first order, with two states for each "
        "link."
        if page.n > 1
        else "The equation of second order becomes a system of first order, with two states.",
        *names,
        *rates,
    )
