"""The Newton-Euler equations of every link: vectors, components, written out."""

from __future__ import annotations

from sympy import expand

from pendcore.derive.chain import cross, minus
from pendcore.derive.narration import errata
from pendcore.derive.narration.page import Page, total
from pendcore.derive.newton_euler import LinkEquations, PayloadEquations
from pendcore.derive.step import Equation, Formula
from pendcore.derive.writing import MASS


def newton_euler(page: Page) -> None:
    """Write the equations of every link."""
    for i, link in enumerate(page.equations.links, start=1):
        _first(page, link) if link.about_pivot else _other(page, i, link)
        page.links[i] = len(page.steps)
    if page.equations.payload is not None:
        _payload(page, page.equations.payload)


def _forces(page: Page, i: int) -> tuple[Formula, Formula | None]:
    """Return the force where link i begins, and the force where it ends, if there is one."""
    near = page.vector("F", f"{i - 1}{i}")
    if i < page.n:
        return near, page.vector("F", f"{i + 1}{i}")
    return near, None if page.equations.payload is None else page.vector("F", f"p{i}")


def _newton(page: Page, i: int, number: str | None) -> Equation:
    """Return Newton's equation, m a_C = F + F + G + loads."""
    near, far = _forces(page, i)
    acting = [near, *([far] if far else []), page.vector("G", i)]
    acting += [page.load(load) for load in page.equations.loads if load.link == i]
    mass = page.s.masses[i - 1]
    left = page.scaled(mass, page.vector("a", page.center(i)))
    return page.equation(left, total(acting), number)


def _euler(page: Page, i: int, about: Formula, number: str | None) -> Equation:
    """Return I alpha = sum of r x F + couples, about A or the mass centre."""
    begin, end, center = page.joint(i - 1), page.joint(i), page.center(i)
    near, far = _forces(page, i)
    acting = []
    if about != center:
        acting.append(page.cross(page.position(center, about), page.vector("G", i)))
    if about != begin:
        acting.append(page.cross(page.position(begin, about), near))
    if far is not None:
        acting.append(page.cross(page.position(end, about), far))
    for load in page.equations.loads:
        if load.link == i:
            acting.append(page.along("k", load.moment))
            if about != begin:
                acting.append(page.cross(page.position(begin, about), page.load(load)))
    couples = page.equations.joint_couple(i) - page.equations.joint_couple(i + 1)
    if i == page.n and page.equations.payload is not None:
        couples -= page.equations.payload.inertia * page.s.qdd[i - 1]
    if couples != 0:
        acting.append(page.along("k", couples))
    about_pivot = page.symbol("I_A", "I_{A}", MASS)
    resistance = page.moment_of_inertia(i) if about == center else about_pivot
    left = page.scaled(resistance, page.vector("alpha", i))
    return page.equation(left, total(acting), number)


def _components(page: Page, i: int, link: LinkEquations) -> list[Equation]:
    """Return Newton's equations along x and y, with accelerations as symbols."""
    mass = page.s.masses[i - 1]
    ax, ay = (page.coordinate(axis, page.center(i), 2) for axis in "xy")
    remark = errata.REMARKS["y of 2.5"] if i == 2 else ""
    return [
        page.equation(mass * ax, link.newton[0].acting),
        page.equation(mass * ay, link.newton[1].acting, None, remark),
    ]


def _opposite(i: int) -> str:
    if i == 1:
        return " $\\mathbf{F}_{01}$ is the joint reaction of the ground 0 on link 1 at $A$."
    pair, back = f"{i - 1}{i}", f"{i}{i - 1}"
    return (
        f" $\\mathbf{{F}}_{{{pair}}} = -\\mathbf{{F}}_{{{back}}}$ is the joint reaction of link "
        f"{i - 1} on link {i}."
    )


def _turning_with(page: Page, i: int) -> str:
    """Return the sentence on the couple that a payload with inertia takes from the last link."""
    payload = page.equations.payload
    if i < page.n or payload is None or payload.inertia == 0:
        return ""
    couple = page.s.latex(expand(payload.inertia * page.s.qdd[i - 1]))
    return (
        f" The payload turns with link {i}; the couple that this takes, ${couple}$, acts back on "
        "the link."
    )


def _first(page: Page, link: LinkEquations) -> None:
    """Link 1, about the fixed point A: (2.1) and (2.2)."""
    begin, end, center = page.joint(0), page.joint(1), page.center(1)
    _, far = _forces(page, 1)
    text = "$\\mathbf{F}_{01}$ is the joint reaction of the ground 0 on link 1 at $A$"
    if far is not None:
        whose = "link 2" if page.n > 1 else "the payload"
        text += f", and ${far.latex}$ is the force of {whose} on link 1 at ${end.latex}$"
    weight = page.equations.weight(page.s.masses[0])
    arm = page.coordinate("x", center), page.coordinate("y", center)
    moments = [page.determinant(arm, weight)]
    if far is not None:
        arm = page.coordinate("x", end), page.coordinate("y", end)
        moments.append(page.determinant(arm, page.equations.far_force(1)))
    written = [page.equation(page.along("k", link.moment.inertia), total(moments))]
    has_more = len(page.equations.laws) > 0
    page.step(
        "Newton-Euler equations of link 1",
        f"{text}. As link 1 turns about the fixed point $A$, the sum of the moments about $A$ "
        "equals the moment of inertia about $A$ times the angular acceleration, and "
        f"$\\mathbf{{F}}_{{01}}$ has no moment.{_turning_with(page, 1)}",
        _newton(page, 1, None),
        _euler(page, 1, center, None),
        _euler(page, 1, begin, "2.1"),
        *([] if has_more else written),
        page.equation(link.moment.inertia, link.moment.acting, "2.2", errata.REMARKS["2.2"]),
        *_components(page, 1, link),
    )


def _other(page: Page, i: int, link: LinkEquations) -> None:
    """Write a link about its mass centre; link 2 is that of (2.3) to (2.8)."""
    center = page.center(i)
    accelerated = page.chain.center_accelerations[i - 1]
    mass = page.s.masses[i - 1]
    out: list[Equation] = []
    own = i == 2  # the textbook numbers the equations of link 2
    payload = ""
    if i == page.n and (far := _forces(page, i)[1]) is not None:
        payload = f" ${far.latex}$ is the force of the payload on link {i}, at "
        payload += f"${page.joint(i).latex}$."
        payload += _turning_with(page, i)
    if own and page.n == 2:
        out = [
            page.equation(mass * a, line.acting, number, errata.REMARKS.get(number, ""))
            for a, line, number in zip(accelerated, link.newton, ("2.6", "2.7"), strict=True)
        ]
    determinant = [_determinant(page, link)] if own and page.n == 2 else []
    page.step(
        f"Newton-Euler equations of link {i}",
        "Mass times acceleration is the sum of the forces, and moment of inertia times angular "
        f"acceleration is the sum of the moments about ${center.latex}$."
        f"{_opposite(i)}{payload}",
        _newton(page, i, "2.3" if own else None),
        _euler(page, i, center, "2.4" if own else None),
        *_components(page, i, link),
        *determinant,
        *out,
        page.equation(
            link.moment.inertia,
            link.moment.acting,
            "2.8" if own else None,
            errata.REMARKS["2.8"],
        ),
    )


def _determinant(page: Page, link: LinkEquations) -> Equation:
    """Return (2.5): the moment of F_12 about C_2 as a determinant, and what effects add to it."""
    begin, center, force = page.joint(1), page.center(2), page.equations.near_force(2)
    arm = (
        page.coordinate("x", begin) - page.coordinate("x", center),
        page.coordinate("y", begin) - page.coordinate("y", center),
    )
    known = minus(page.chain.joints[1], page.chain.centers[1])
    rest = expand(link.moment.acting - cross(known, force))
    more = [page.along("k", term) for term in page.s.terms(rest) if term != 0]
    return page.equation(
        page.along("k", link.moment.inertia),
        total([page.determinant(arm, force), *more]),
        "2.5",
        errata.REMARKS["2.5"],
    )


def _payload(page: Page, payload: PayloadEquations) -> None:
    """Write the equations of the payload."""
    tip, force = page.joint(page.n), page.vector("F", f"p{page.n}")
    opposite, mass = Formula(f"-{force.text}", f"-{force.latex}"), payload.mass
    couple, turning, moment = page.vector("T", "p"), "", []
    if payload.inertia != 0:
        turning = (
            " The forces on the payload have no moment about its mass centre: the couple "
            f"${couple.latex}$ of link {page.n} turns the payload, and the opposite couple acts on "
            "the link."
        )
        alpha = page.vector("alpha", page.n)
        moment = [page.equation(page.scaled(payload.inertia, alpha), couple)]
    page.step(
        "Newton-Euler equations of the payload" if moment else "Newton's equations of the payload",
        f"${force.latex}$ is the force of the payload on link {page.n}, at ${tip.latex}$; the "
        f"opposite force acts on the payload, whose mass centre is there.{turning}",
        page.equation(
            page.scaled(mass, page.vector("a", tip)), total([opposite, page.vector("G", "p")])
        ),
        *(
            page.equation(mass * page.coordinate(axis, tip, 2), line.acting)
            for axis, line in zip("xy", payload.newton, strict=True)
        ),
        *moment,
    )
