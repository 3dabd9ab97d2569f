"""The equations of motion solved, and as a first-order system."""

from __future__ import annotations

from pendcore.derive.narration.page import Page
from pendcore.derive.writing import ANGLE, RATE


def first_order(page: Page) -> None:
    """Write the solution and the first-order form."""
    solution = page.derivation.solution
    several = page.n > 1
    text = "The equations of motion are linear in the accelerations"
    if not several:
        text = "The equation of motion is divided by the factor of the acceleration"
    if page.n > 1 and not page.equations.locked:
        text += "; Cramer's rule solves them"
    if page.equations.locked:
        text += (
            "; the equations of the links that a lock makes turn as one are added, which takes "
            "its couple out of them"
        )
    page.step(
        f"Solution for the angular acceleration{'s' if several else ''}",
        f"{text}.",
        *(
            page.equation(a, value)
            for a, value in zip(page.s.qdd, solution.by_entries, strict=True)
        ),
        *(
            page.equation(page.equations.holding[joint], couple)
            for joint, couple in solution.holding.items()
        ),
    )
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
        if several
        else "The equation of second order becomes a system of first order, with two states.",
        *names,
        *rates,
    )
