"""The Newton-Euler equations of every link: vectors, components, written out."""

from __future__ import annotations

from sympy import expand

from pendcore.derive.chain import cross, minus
from pendcore.derive.narration.page import Page, Sides, total
from pendcore.derive.newton_euler import BodyEquations
from pendcore.derive.step import Formula


def newton_euler(page: Page) -> None:
    """Write the equations of every link."""
    for i, link in enumerate(page.equations.links, start=1):
        _link(page, i, link)
    if page.equations.payload is not None:
        _payload(page, page.equations.payload)


def _forces(page: Page, i: int) -> tuple[Formula, Formula | None]:
    """Return the force where link i begins, and the force where it ends, if there is one."""
    near = page.vector("F", f"{i - 1}{i}")
    if i < page.n:
        return near, page.vector("F", f"{i + 1}{i}")
    return near, None if page.equations.payload is None else page.vector("F", f"p{i}")


def _newton(page: Page, i: int) -> Sides:
    """Return Newton's equation, m a_C = F + F + G + loads."""
    near, far = _forces(page, i)
    acting = [near, *([far] if far else []), page.vector("G", i)]
    acting += [page.load(load) for load in page.equations.loads if load.link == i]
    left = page.scaled(page.s.masses[i - 1], page.vector("a", page.center(i)))
    return left, total(acting), "2.3" if i == 2 else ""


def _euler(page: Page, i: int, about: Formula, number: str) -> Sides:
    """Return I alpha = sum of r x F + couples, about A or the mass centre."""
    begin, end, center = page.joint(i - 1), page.joint(i), page.center(i)
    near, far = _forces(page, i)

    def moment(at: Formula, force: Formula) -> Formula:
        return Formula(rf"{page.vector('r', about + at)} \times {force}")

    acting = [
        moment(at, force)
        for at, force in ((center, page.vector("G", i)), (begin, near), (end, far))
        if at != about and force is not None
    ]
    for load in page.equations.loads:
        if load.link == i:
            acting.append(page.along("k", load.moment))
            acting += [moment(begin, page.load(load))] if about != begin else []
    couples = page.equations.couples(i)
    acting += [page.along("k", couples)] if couples != 0 else []
    resistance = page.moment_of_inertia(i if about == center else 0)
    return page.scaled(resistance, page.vector("alpha", i)), total(acting), number


def _far_in_words(page: Page, i: int) -> str:
    """Say whose force acts where the link ends, and what couple turns a payload."""
    far, payload = _forces(page, i)[1], page.equations.payload
    if far is None:
        return ""
    whose = f"link {i + 1}" if i < page.n else "the payload"
    text = f" ${far}$ is the force of {whose} on link {i} at ${page.joint(i)}$."
    if i == page.n and payload is not None and payload.inertia != 0:
        couple = page.s.latex(expand(payload.moment.inertia))
        text += f" The payload turns with link {i}; the couple that this takes, ${couple}$, acts "
        text += "back on the link."
    return text


def _link(page: Page, i: int, link: BodyEquations) -> None:
    """Write a link: link 1 about the fixed point A, (2.1) and (2.2), or about its mass centre.

    Link 2 about its mass centre is that of (2.3) to (2.8).
    """
    center, own, joint = page.center(i), i == 2, f"link {i - 1}" if i > 1 else "the ground 0"
    pair, back = f"\\mathbf{{F}}_{{{i - 1}{i}}}", f"\\mathbf{{F}}_{{{i}{i - 1}}}"
    text = f"${pair} = -{back}$" if i > 1 else f"${pair}$"
    text += f" is the joint reaction of {joint} on link {i} at ${page.joint(i - 1)}$."
    text += _far_in_words(page, i) if i in (1, page.n) else ""
    found = [_newton(page, i), _euler(page, i, center, "2.4" if own else "")]
    components: list[Sides] = [
        (
            page.s.masses[i - 1] * page.coordinate(axis, center, 2), line.acting,
            "", f"{axis} of 2.5" if own else "",
        )
        for axis, line in zip("xy", link.newton, strict=True)
    ]  # fmt: skip
    if link.about_pivot:
        text += " As the link turns about the fixed point $A$, the sum of the moments about $A$ "
        text += "equals the moment of inertia about $A$ times the angular acceleration, and "
        text += f"${pair}$ has no moment."
        found.append(_euler(page, i, page.joint(0), "2.1"))
        found += [] if page.equations.laws else [_moments_about_pivot(page, link)]
        found += [(*link.moment, "2.2"), *components]
    else:
        text += " Mass times acceleration is the sum of the forces, and moment of inertia times "
        text += f"angular acceleration is the sum of the moments about ${center}$."
        found += components
        found += _written_out(page, link) if own and page.n == 2 else []
        found.append((*link.moment, "2.8" if own else ""))
    page.step(f"Newton-Euler equations of link {i}", text, *found)


def _moments_about_pivot(page: Page, link: BodyEquations) -> Sides:
    """Return the moments of G_1 and F_21 about A as determinants."""
    forces = [(page.center(1), page.equations.weight(page.s.masses[0]))]
    forces += [(page.joint(1), page.equations.far_forces[0])] if page.n > 1 else []
    moments = (
        page.determinant((page.coordinate("x", at), page.coordinate("y", at)), force)
        for at, force in forces
    )
    return page.along("k", link.moment.inertia), total(moments)


def _written_out(page: Page, link: BodyEquations) -> list[Sides]:
    """Return (2.5), the moment of F_12 about C_2 and what effects add to it, (2.6) and (2.7)."""
    begin, center, force = page.joint(1), page.center(2), page.equations.near_forces[1]
    x, y = (page.coordinate(axis, begin) - page.coordinate(axis, center) for axis in "xy")
    known = minus(page.chain.joints[1], page.chain.centers[1])
    rest = expand(link.moment.acting - cross(known, force))
    more = [page.along("k", term) for term in page.s.terms(rest) if term != 0]
    left = page.along("k", link.moment.inertia)
    lines = ((*line, number) for line, number in zip(link.newton, ("2.6", "2.7"), strict=True))
    return [(left, total([page.determinant((x, y), force), *more]), "2.5"), *lines]


def _payload(page: Page, payload: BodyEquations) -> None:
    """Write the equations of the payload."""
    tip, force, couple = page.joint(page.n), page.vector("F", f"p{page.n}"), page.vector("T", "p")
    mass, turning, moment = payload.mass, "", list[Sides]()
    if payload.inertia != 0:
        turning = (
            f" The couple ${couple}$ of link {page.n} turns the payload: the forces on it "
            "have no moment about its mass centre."
        )
        moment = [(page.scaled(payload.inertia, page.vector("alpha", page.n)), couple)]
    acting = total([Formula(f"-{force}"), page.vector("G", "p")])
    page.step(
        "Newton-Euler equations of the payload" if moment else "Newton's equations of the payload",
        f"The opposite of ${force}$ acts on the payload, whose mass centre is at ${tip}$.{turning}",
        (page.scaled(mass, page.vector("a", tip)), acting),
        *(
            (mass * page.coordinate(axis, tip, 2), line.acting)
            for axis, line in zip("xy", payload.newton, strict=True)
        ),
        *moment,
    )
