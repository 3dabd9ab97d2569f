"""The reactions from Newton's equations, and the moment equations without them."""

from __future__ import annotations

from sympy import Expr

from pendcore.derive.narration import errata
from pendcore.derive.narration.page import Page
from pendcore.derive.step import Equation


def elimination(page: Page) -> None:
    """Write the reactions, and what is left without them."""
    found: list[Equation] = []
    payload = page.equations.payload
    if payload is not None:
        for letter, symbol, line in zip("xy", payload.force, payload.newton, strict=True):
            inertia = payload.mass * page.coordinate(letter, page.joint(page.n), 2)
            found.append(page.equation(symbol, line.acting + symbol - inertia))
    for i in range(page.n, 0, -1):
        for axis in (0, 1):
            symbol = page.equations.forces[i - 1][axis]
            number = "2.9" if i == 2 and axis == 1 else None
            remark = errata.REMARKS["2.9"] if number else ""
            found.append(page.equation(symbol, force(page, i, axis), number, remark))
    order = ", from the tip inwards" if page.n > 1 else ""
    page.step(
        "Joint reactions",
        f"Newton's equations give the joint reactions{order}.",
        *found,
    )
    if page.n == 2:
        _put_in(page)
    _collected(page)


def force(page: Page, link: int, axis: int) -> Expr:
    """Return F_01, or F_21 and so on, with accelerations put in where the textbook does."""
    equations = page.equations
    line = equations.links[link - 1].newton[axis]
    symbol = equations.forces[link - 1][axis]
    rest = line.acting.subs(symbol, 0)
    written_out = link == page.n == 2
    if written_out:
        inertia = page.s.masses[link - 1] * page.chain.center_accelerations[link - 1][axis]
    else:
        name = page.coordinate("xy"[axis], page.center(link), 2)
        inertia = page.s.masses[link - 1] * name
    return inertia - rest if link == 1 else rest - inertia


def _put_in(page: Page) -> None:
    """Write (2.10) and (2.11): the force between the links put into both moment equations."""
    mass = page.s.masses[1]
    known = {}
    for axis in (0, 1):
        acceleration = page.chain.center_accelerations[1][axis]
        weight = page.s.gravity if axis == 1 else 0
        rest = force(page, 2, axis) + mass * acceleration - mass * weight
        known[page.equations.forces[1][axis]] = -mass * (acceleration - weight) + rest
    page.step(
        "Equations of motion",
        "The force between the links is put into the moment equations (2.2) and (2.8).",
        *(
            page.equation(
                link.moment.inertia,
                link.moment.acting.xreplace(known),
                number,
                errata.REMARKS[number],
            )
            for link, number in zip(page.equations.links, ("2.10", "2.11"), strict=True)
        ),
    )


def _collected(page: Page) -> None:
    """Write M qdd = f, entry by entry."""
    text = "" if page.n == 2 else "The reactions are put into the moment equations. "
    if page.n > 1:
        text += (
            "What they have of the accelerations is collected on the left, with $\\sin^{2} + "
            "\\cos^{2} = 1$ and the sine and cosine of a difference: $M \\ddot{q} = f$, with a "
            "symmetric matrix $M$."
        )
    else:
        text += "What they have of the acceleration is collected on the left: $M \\ddot{q} = f$."
    if page.equations.locked:
        text += " The unknown couples of locks are left out of $f$; they follow later."
    page.step(
        "Equations of motion, collected" if page.n == 2 else "Equations of motion",
        text,
        *(page.equation(name, value) for name, value in page.motion.named.entries.items()),
    )
