"""The reactions from Newton's equations, and the moment equations without them."""

from __future__ import annotations

from sympy import Dummy, Expr, Integer, expand

from pendcore.derive.chain import Vector
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
    """Write (2.10) and (2.11): the reactions put into both moment equations."""
    known, accelerations = _in_brackets(page)
    fixed = page.chain.pivot_is_fixed
    numbers = "2.10" if fixed else None, "2.11"  # the equation about C_1 is not (2.10)
    force = "The force between the links is" if fixed else "The joint reactions are"
    if page.equations.payload is not None:
        force = "The force between the links and that of the payload are" if fixed else force
    of_link_1 = "equations (2.2)" if fixed else f"equation of link 1 (step {page.links[1]})"
    page.step(
        "Equations of motion",
        f"{force} put into the moment {of_link_1} and {'' if fixed else 'into '}(2.8).",
        *(
            page.equation(
                link.moment.inertia,
                expand(link.moment.acting.xreplace(known)).xreplace(accelerations),
                number,
                errata.REMARKS[number] if number else "",
            )
            for link, number in zip(page.equations.links, numbers, strict=True)
        ),
    )


def _in_brackets(page: Page) -> tuple[dict[Expr, Expr], dict[Expr, Expr]]:
    """Return the reactions in m (a - g) with brackets as symbols, and the brackets' contents."""
    equations, chain = page.equations, page.chain
    known: dict[Expr, Expr] = {}
    brackets: dict[Expr, Expr] = {}

    def bracket(acceleration: Vector, axis: int) -> Expr:
        symbol = Dummy()
        brackets[symbol] = acceleration[axis] - equations.weight(Integer(1))[axis]
        return symbol

    for axis in (0, 1):
        if equations.payload is not None:
            mass = equations.payload.mass
            force = equations.payload.force[axis]
            known[force] = expand(-mass * bracket(chain.tip_acceleration, axis))
        for i in range(page.n, 0, -1):
            mass = page.s.masses[i - 1]
            near = mass * bracket(chain.center_accelerations[i - 1], axis)
            near -= equations.far_force(i)[axis].xreplace(known)
            near -= sum(load.force[axis] for load in equations.loads if load.link == i)
            known[equations.forces[i - 1][axis]] = expand(near if i == 1 else -near)
    return known, brackets


def _collected(page: Page) -> None:
    """Write M qdd = f, entry by entry."""
    text = "" if page.n == 2 else "The reactions are put into the moment equations. "
    law, locked = page.motion.law, page.motion.locking
    if page.n > 1:
        text += (
            "The terms with accelerations are collected on the left, using $\\sin^{2} + "
            "\\cos^{2} = 1$ and the formulas for the sine and cosine of a difference: "
            f"${law}$, with a symmetric matrix $M$."
        )
    else:
        text += f"The terms with the acceleration are collected on the left: ${law}$."
    if locked:
        text += (
            " The unknown couples of locks are in $\\lambda$, and everything else is in $f$: such "
            "a couple acts on the link beyond its joint, and the opposite couple on the link "
            "before it."
        )
    named = page.motion.named.entries | locked
    page.step(
        "Equations of motion, collected" if page.n == 2 else "Equations of motion",
        text,
        *(page.equation(name, value) for name, value in named.items()),
    )
