"""The Newton-Euler equations of every link: vectors, components, written out."""

from __future__ import annotations

from sympy import expand

from pendcore.derive.chain import cross, minus
from pendcore.derive.narration.page import Page, total
from pendcore.derive.newton_euler import LinkEquations, PayloadEquations
from pendcore.derive.step import Equation, Formula


def newton_euler(page: Page) -> None:
    """Write the equations of every link."""
    for i, link in enumerate(page.equations.links, start=1):
        _first(page, link) if link.about_pivot else _other(page, i, link)
    if page.equations.payload is not None:
        _payload(page, page.equations.payload)


def _forces(page: Page, i: int) -> tuple[Formula, Formula | None]:
    """Return the force where link i begins, and the force where it ends, if there is one."""
    near = page.vector("F", f"{i - 1}{i}")
    if i < page.n:
        return near, page.vector("F", f"{i + 1}{i}")
    return near, None if page.equations.payload is None else page.vector("F", f"p{i}")


def _newton(page: Page, i: int, number: str | None = None) -> Equation:
    """Return Newton's equation, m a_C = F + F + G + loads."""
    near, far = _forces(page, i)
    acting = [near, *([far] if far else []), page.vector("G", i)]
    acting += [page.load(load) for load in page.equations.loads if load.link == i]
    left = page.scaled(page.s.masses[i - 1], page.vector("a", page.center(i)))
    return page.equation(left, total(acting), number)


def _euler(page: Page, i: int, about: Formula, number: str | None = None) -> Equation:
    """Return I alpha = sum of r x F + couples, about A or the mass centre."""
    begin, end, center = page.joint(i - 1), page.joint(i), page.center(i)
    near, far = _forces(page, i)
    acting = [
        page.moment(about + at, force)
        for at, force in ((center, page.vector("G", i)), (begin, near), (end, far))
        if at != about and force is not None
    ]
    for load in page.equations.loads:
        if load.link == i:
            acting.append(page.along("k", load.moment))
            if about != begin:
                acting.append(page.moment(about + begin, page.load(load)))
    couples = page.equations.couples(i)
    if couples != 0:
        acting.append(page.along("k", couples))
    resistance = page.moment_of_inertia(i if about == center else 0)
    left = page.scaled(resistance, page.vector("alpha", i))
    return page.equation(left, total(acting), number)


def _components(page: Page, i: int, link: LinkEquations) -> list[Equation]:
    """Return Newton's equations along x and y, with accelerations as symbols."""
    return [
        page.equation(
            page.s.masses[i - 1] * page.coordinate(axis, page.center(i), 2), line.acting,
            erratum=f"{axis} of 2.5" if i == 2 else "",
        )
        for axis, line in zip("xy", link.newton, strict=True)
    ]  # fmt: skip


def _far_in_words(page: Page, i: int) -> str:
    """Say whose force acts where the link ends, and what couple turns a payload."""
    far, payload = _forces(page, i)[1], page.equations.payload
    if far is None:
        return ""
    whose = f"link {i + 1}" if i < page.n else "the payload"
    text = f" ${far}$ is the force of {whose} on link {i} at ${page.joint(i)}$."
    if i == page.n and payload is not None and payload.inertia != 0:
        couple = page.s.latex(expand(payload.inertia * page.s.qdd[i - 1]))
        text += (
            f" The payload turns with link {i}; the couple that this takes, ${couple}$, acts back "
            "on the link."
        )
    return text


def _first(page: Page, link: LinkEquations) -> None:
    """Link 1, about the fixed point A: (2.1) and (2.2)."""
    begin, end, center = page.joint(0), page.joint(1), page.center(1)
    _, far = _forces(page, 1)

    def at(point: Formula) -> tuple[object, object]:
        return page.coordinate("x", point), page.coordinate("y", point)

    moments = [page.determinant(at(center), page.equations.weight(page.s.masses[0]))]
    if far is not None:
        moments.append(page.determinant(at(end), page.equations.far_force(1)))
    written = [page.equation(page.along("k", link.moment.inertia), total(moments))]
    page.step(
        "Newton-Euler equations of link 1",
        "$\\mathbf{F}_{01}$ is the joint reaction of the ground 0 on link 1 at $A$."
        f"{_far_in_words(page, 1)} As link 1 turns about the fixed point $A$, the sum of the "
        "moments about $A$ equals the moment of inertia about $A$ times the angular acceleration, "
        "and $\\mathbf{F}_{01}$ has no moment.",
        _newton(page, 1),
        _euler(page, 1, center),
        _euler(page, 1, begin, "2.1"),
        *([] if page.equations.laws else written),
        page.equation(link.moment.inertia, link.moment.acting, "2.2"),
        *_components(page, 1, link),
    )


def _other(page: Page, i: int, link: LinkEquations) -> None:
    """Write a link about its mass centre; link 2 is that of (2.3) to (2.8)."""
    center, mass = page.center(i), page.s.masses[i - 1]
    own = i == 2  # the textbook numbers the equations of link 2
    pair, back = f"{i - 1}{i}", f"{i}{i - 1}"
    joint = (
        " $\\mathbf{F}_{01}$ is the joint reaction of the ground 0 on link 1 at $A$."
        if i == 1
        else f" $\\mathbf{{F}}_{{{pair}}} = -\\mathbf{{F}}_{{{back}}}$ is the joint reaction of "
        f"link {i - 1} on link {i}."
    )
    out: list[Equation] = []
    if own and page.n == 2:
        accelerations = page.chain.center_accelerations[i - 1]
        out = [_determinant(page, link)] + [
            page.equation(mass * a, line.acting, number)
            for a, line, number in zip(accelerations, link.newton, ("2.6", "2.7"), strict=True)
        ]
    page.step(
        f"Newton-Euler equations of link {i}",
        "Mass times acceleration is the sum of the forces, and moment of inertia times angular "
        f"acceleration is the sum of the moments about ${center}$.{joint}"
        f"{_far_in_words(page, i) if i in (1, page.n) else ''}",
        _newton(page, i, "2.3" if own else None),
        _euler(page, i, center, "2.4" if own else None),
        *_components(page, i, link),
        *out,
        page.equation(link.moment.inertia, link.moment.acting, "2.8" if own else None),
    )


def _determinant(page: Page, link: LinkEquations) -> Equation:
    """Return (2.5): the moment of F_12 about C_2 as a determinant, and what effects add to it."""
    begin, center, force = page.joint(1), page.center(2), page.equations.near_force(2)
    x, y = (page.coordinate(axis, begin) - page.coordinate(axis, center) for axis in "xy")
    known = minus(page.chain.joints[1], page.chain.centers[1])
    rest = expand(link.moment.acting - cross(known, force))
    more = [page.along("k", term) for term in page.s.terms(rest) if term != 0]
    left = page.along("k", link.moment.inertia)
    return page.equation(left, total([page.determinant((x, y), force), *more]), "2.5")


def _payload(page: Page, payload: PayloadEquations) -> None:
    """Write the equations of the payload."""
    tip, force, couple = page.joint(page.n), page.vector("F", f"p{page.n}"), page.vector("T", "p")
    mass, turning, moment = payload.mass, "", list[Equation]()
    if payload.inertia != 0:
        turning = (
            f" The couple ${couple}$ of link {page.n} turns the payload: the forces on it "
            "have no moment about its mass centre."
        )
        alpha = page.vector("alpha", page.n)
        moment = [page.equation(page.scaled(payload.inertia, alpha), couple)]
    page.step(
        "Newton-Euler equations of the payload" if moment else "Newton's equations of the payload",
        f"The opposite of ${force}$ acts on the payload, whose mass centre is at "
        f"${tip}$.{turning}",
        page.equation(
            page.scaled(mass, page.vector("a", tip)), total([Formula(f"-{force}"), page.vector("G", "p")])
        ),
        *(
            page.equation(mass * page.coordinate(axis, tip, 2), line.acting)
            for axis, line in zip("xy", payload.newton, strict=True)
        ),
        *moment,
    )
