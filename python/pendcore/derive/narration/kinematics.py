"""Positions, velocities and accelerations; weights, moments of inertia and what else acts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sympy import Integer

from pendcore.derive.chain import Vector
from pendcore.derive.narration.page import Page, Sides, total
from pendcore.derive.step import Formula
from pendcore.messages import in_a_row


def kinematics(page: Page) -> None:
    """Write the kinematics, and what acts and what resists."""
    links = range(1, page.n + 1)
    chain, centers = page.chain, [page.center(i) for i in links]
    joints = [page.joint(i) for i in range(page.n + 1)]
    radii = [
        total(page.along(u, page.coordinate(axis, center)) for axis, u in ("xi", "yj"))
        for center in centers
    ]
    _mobility(page)
    path = "the point about which the pivot $A$ moves on a path"
    origin = "at $A$" if chain.pivot_is_fixed else path
    page.step(
        "Positions",
        "The plane of motion is the $xy$ plane, with $x$ to the right and $y$ vertical, positive "
        f"downward. The origin is {origin}. The angle of each link is measured from the $x$ axis "
        "towards the $y$ axis.",
        *chain.path.items(),
        *_points(page, joints[1:], chain.joints[1:], 0),
        *zip((page.vector("r", center) for center in centers), radii, strict=True),
        *_points(page, centers, chain.centers, 0),
    )
    text = "The velocity is the derivative of the position with respect to time."
    found = _points(page, centers, chain.center_velocities, 1)
    page.step("Velocities of the mass centres", text, *found)
    moved = [body.acceleration for body in page.equations.bodies]
    named = [page.center(i) for i in range(1, len(moved) + 1)]
    text = "The acceleration is the derivative of the velocity with respect to time."
    page.step("Accelerations of the mass centres", text, *_points(page, named, moved, 2))
    page.step(
        "Angular velocities and accelerations",
        "Every link turns about the $z$ axis, whose unit vector is $\\mathbf{k}$; turning from $x$ "
        "to $y$ is positive.",
        *(
            (page.vector(letter, i), page.along("k", row[i - 1]))
            for letter, row in (("omega", page.s.qd), ("alpha", page.s.qdd))
            for i in links
        ),
    )
    page.step(
        "Weights",
        "The weight of a link acts at its mass centre, downward: towards $+y$.",
        *(
            (page.vector("G", i), page.along("j", mass * page.s.gravity))
            for i, mass in zip(links, page.s.masses, strict=True)
        ),
    )
    _moments_of_inertia(page)
    if page.equations.laws:
        _effects(page)


def _mobility(page: Page) -> None:
    k = page.n - len(page.equations.locked)  # links that a lock joins count as one
    locks = " A lock makes one body of the two that it joins." if page.equations.locked else ""
    angles = in_a_row(f"$q_{{{i}}}(t)$" for i in range(1, page.n + 1))
    symbol = page.s.symbol("M", "M")
    page.step(
        "Degrees of freedom",
        f"Here $n = {k}$ counts the moving links, $c_{{5}} = {k}$ the joints that leave one degree "
        f"of freedom, and $c_{{4}} = 0$ those that leave two.{locks} The chain is described by the "
        f"angles of its links: {angles}.",
        (symbol, Formula("3 n - 2 c_{5} - c_{4}")),
        (symbol, Formula(rf"3 \cdot {k} - 2 \cdot {k} - 0 = {k}")),
    )


def _moments_of_inertia(page: Page) -> None:
    s, names = page.s, [page.moment_of_inertia(i) for i in range(page.n + 1)]
    given = zip(names[1:], s.inertias, strict=True)
    found: list[Sides] = [(name, value) for name, value in given if value != name]
    text = "The moment of inertia of each link about its mass centre is given."
    if found:
        text = "The moment of inertia of a link about its mass centre is that of a uniform rod, "
        text += "unless another is given."
    if page.chain.pivot_is_fixed:
        text += " Link 1 turns about the fixed point $A$, for which the parallel axis theorem "
        text += "gives $I_{A}$."
        found.append((names[0], names[1] + s.masses[0] * s.centers[0] ** 2))
        if s.inertias[0] != names[1]:
            found.append((names[0], page.equations.links[0].moment.inertia / s.qdd[0]))
    page.step("Moments of inertia", text, *found)


def _effects(page: Page) -> None:
    equations = page.equations
    of_laws = equations.definitions.items()
    found: list[Sides] = [one for one in of_laws if one[0] not in page.chain.path]
    for load in equations.loads:
        parts = total(page.along(u, f) for u, f in zip("ij", load.force, strict=True))
        found.append((page.load(load), parts))
    if equations.payload is not None:
        weight = page.along("j", equations.payload.mass * page.s.gravity)
        found.append((page.vector("G", "p"), weight))
    found += [(page.chain.joint(joint)[2], Integer(0)) for joint in equations.locked]
    page.step("Effects", " ".join(statements(page)), *found)


def statements(page: Page) -> list[str]:
    """Return what acts besides gravity, in sentences with the formulas of the laws."""
    equations = page.equations
    found = []
    if equations.torques or equations.locked or any(equations.armatures):
        found.append(
            "The angle of joint $j$ is $\\varphi_{j} = q_{j} - q_{j-1}$, that of the first joint "
            "$\\varphi_{1} = q_{1}$. A couple at joint $j$ acts on link $j$, and the opposite "
            "couple on link $j - 1$, which for the first joint is the ground."
        )
    if equations.torques:
        found.append("$\\tau_{j}$ is the sum of the couples of effects at joint $j$.")
    return [*found, *(law.statement for law in equations.laws)]


def _points(
    page: Page, names: Sequence[Formula], vectors: Sequence[Vector], dots: int
) -> Iterator[Sides]:
    for name, vector in zip(names, vectors, strict=True):
        for axis, component in zip("xy", vector, strict=True):
            yield page.coordinate(axis, name, dots), component
