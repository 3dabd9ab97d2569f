"""What follows from the equations of the links: reactions, motion, its solution, energy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from sympy import Dummy, Expr, Integer, Pow, expand

from pendcore.derive.narration.page import Page, Sides
from pendcore.derive.notation import ANGLE, RATE
from pendcore.messages import in_a_row

BY_ELIMINATION = 4
"""The number of unknown accelerations from which determinants are longer than a page."""


def equations_of_motion(page: Page) -> None:
    """Write the reactions, and what is left without them."""
    text = "Newton's equations give the joint reactions, from the tip inwards."
    page.step("Joint reactions", text, *_reactions(page))
    if page.n == 2:
        _put_in(page)
    law, locked = page.derivation.law, page.derivation.locking
    text = (
        "The reactions are put into the moment equations, and the terms with accelerations are "
        f"collected on the left: ${law}$, with a symmetric matrix $M$, whose entries are short by "
        "the formulas for the sine and cosine of a difference."
    )
    if locked:
        text += (
            " The unknown couples of locks are in $\\lambda$, and everything else is in $f$: such "
            "a couple acts on the link beyond its joint, and the opposite couple on the link "
            "before it."
        )
    title = "Equations of motion" + ", collected" * (page.n == 2)
    page.step(title, text, *(page.derivation.named.entries | locked).items())


def _reactions(page: Page) -> Iterator[Sides]:
    """Yield F_p, F_21 and so on, with accelerations put in where the textbook does."""
    for i, body in reversed([*enumerate(page.equations.bodies, start=1)]):
        for k, axis in enumerate("xy"):
            acceleration = page.coordinate(axis, page.center(i), 2)
            if i == page.n == 2:
                acceleration = body.acceleration[k]
            force = body.solved(k, body.mass * acceleration)
            yield body.force[k], force, "2.9" if i == 2 and axis == "y" else ""


def _put_in(page: Page) -> None:
    """Write (2.10) and (2.11): the reactions put into both moment equations."""
    equations = page.equations
    known: dict[Expr, Expr] = {}
    brackets: dict[Expr, Expr] = {}  # m (a - g): the bracket's contents stay together
    for axis in (0, 1):
        for body in reversed(equations.bodies):
            bracket, weight = Dummy(), equations.weight(body.mass)[axis]
            brackets[bracket] = body.acceleration[axis] - equations.weight(Integer(1))[axis]
            force = body.solved(axis, body.mass * bracket + weight)
            known[body.force[axis]] = expand(force.xreplace(known))
    page.step(
        "Equations of motion",
        "The joint reactions are put into the moment equations of both links.",
        *(
            (
                link.moment.inertia,
                expand(link.moment.acting.xreplace(known)).xreplace(brackets),
                number if number == "2.11" or link.about_pivot else "",
            )
            for link, number in zip(equations.links, ("2.10", "2.11"), strict=True)
        ),
    )


def solution(page: Page) -> None:
    """Write the accelerations, and the couples of locks."""
    motion, locked = page.derivation, page.equations.locked
    text = "The equations of motion are linear in the accelerations."
    accelerations, found = motion.by_entries, list[Sides]()
    if locked:
        text += (
            " The equations of links that turn as one are added, which takes the couple of their "
            "lock out of them: $\\dot{q} = B r$ with as many unknowns $r$ as are left. A link that "
            "is locked to the ground needs no equation."
        )
    if motion.turning_together.cols >= BY_ELIMINATION:
        matrix, right = ("B^{T} M B", "B^{T} f") if locked else ("M", "f")
        text += (
            f" Elimination solves them: ${matrix} = L D L^{{T}}$, where $L$ has ones on its "
            "diagonal, its entries $\\ell_{ij}$ below and zeros above, and $D$ is diagonal. Then "
            f"$L h = {right}$ gives $h$, and $L^{{T}} a = D^{{-1}} h$ gives the accelerations $a$, "
            "the last one first. Here $D_{1}$ and $h_{1}$ are the first entries of both sides."
        )
        found = [*motion.by_elimination]
        accelerations = motion.shared_accelerations
    elif motion.turning_together.cols > 1:
        text += " Cramer's rule solves them, with the determinant $\\Delta$."
        delta = page.s.symbol("Delta", r"\Delta")
        found = [(delta, motion.determinant)]
        inverse = {Pow(motion.determinant, -1): 1 / delta}
        accelerations = tuple(a.xreplace(inverse) for a in accelerations)
    if locked:
        write = page.s.latex
        conditions = (f"${write(page.chain.joint(j)[2])} = 0$" for j in locked)
        couples = (f"${write(symbol)}$" for symbol in page.equations.holding.values())
        text += (
            f" The condition of each lock, {in_a_row(conditions)}, is the equation that finds "
            f"{in_a_row(couples)}: what the lock must add to $f$ so that ${motion.law}$ holds with "
            "these accelerations."
        )
    page.step(
        f"Solution for the angular acceleration{'s' if page.n > 1 else ''}",
        text,
        *found,
        *zip(page.s.qdd, accelerations, strict=True),
        *((page.equations.holding[joint], couple) for joint, couple in motion.holding.items()),
    )


def first_order(page: Page) -> None:
    """Write the first-order form, with the states in the textbook's order."""
    names, rates = [], []
    for i, (q, qd, qdd) in enumerate(zip(page.s.q, page.s.qd, page.s.qdd, strict=True)):
        k = 2 * i + 1
        x = page.s.symbol(f"x({k})", f"x_{{{k}}}", ANGLE)
        xd = page.s.symbol(f"x({k + 1})", f"x_{{{k + 1}}}", RATE)
        names += [(x, q), (xd, qd)]
        for name, value in ((x, xd), (xd, qdd)):
            rate = page.s.symbol(f"d[{name}]/dt", rf"\dot{{x}}_{{{str(name)[2:-1]}}}")
            rates.append((rate, value))
    text = "Equations of second order become a system of first order, with two states for each "
    text += "link."
    page.step("First-order form", text, *names, *rates)


def energy(page: Page) -> None:
    """Write energies, powers and their balance: the check that the equations of motion allow."""
    energies = zip("TV", page.derivation.energies_by_definitions, strict=True)
    powers = page.derivation.powers_by_forces
    names = [page.s.symbol(f"P{i}", f"P_{{{i}}}") for i in range(1, len(powers) + 1)]
    pairs = zip(names, powers, strict=True)
    told = (f"${page.s.latex(name)}$ is that of the {_named(effect)}" for name, effect in pairs)
    text = "The motion conserves the energy; no step above has used this."
    if names:
        text = "Only the effects change the energy, at the rate of the sum of their powers: "
        text += f"{', '.join(told)}."
    rate = page.s.symbol("d(T + V)/dt", r"\frac{\mathrm{d}}{\mathrm{d}t} (T + V)")
    found = [(page.s.symbol(name, name), value) for name, value in energies]
    found += zip(names, powers.values(), strict=True)
    page.step("Energy", text, *found, (rate, sum(names)))


def _named(effect: Any) -> str:
    """Return what an effect is and where: ``motor at joint 2``."""
    words = {"viscous_joint": "damping"}.get(effect.kind, effect.kind.replace("_", " "))
    for place, where in (("joint", "at joint"), ("link", "on link")):
        if hasattr(effect, place):
            words += f" {where} {getattr(effect, place)}"
    return str(words)
