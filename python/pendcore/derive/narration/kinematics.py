"""Positions, velocities and accelerations; weights, moments of inertia and what else acts."""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Integer

from pendcore.derive.chain import Vector
from pendcore.derive.narration.page import Page, listed, total
from pendcore.derive.step import Equation, Formula


def kinematics(page: Page) -> None:
    """Write the kinematics, and what acts and what resists."""
    links = range(1, page.n + 1)
    chain, centers = page.chain, [page.center(i) for i in links]
    joints = [page.joint(i) for i in range(page.n + 1)]
    _mobility(page)
    origin = (
        "at $A$" if chain.pivot_is_fixed else "the point about which the pivot $A$ moves on a path"
    )
    page.step(
        "Positions",
        "The plane of motion is the $xy$ plane, with $x$ to the right and $y$ vertical, positive "
        f"downward. The origin is {origin}. The angle of each link is measured from the $x$ axis "
        "towards the $y$ axis.",
        *(page.equation(symbol, law) for symbol, law in chain.path.items()),
        *_points(page, chain.joints[1:], joints[1:], 0),
        *(
            page.equation(
                page.vector("r", name),
                total(page.along(unit, page.coordinate(axis, name)) for axis, unit in ("xi", "yj")),
            )
            for name in centers
        ),
        *_points(page, chain.centers, centers, 0),
    )
    page.step(
        "Velocities of the mass centres",
        "The velocity is the derivative of the position with respect to time.",
        *_points(page, chain.center_velocities, centers, 1),
    )
    tip = [chain.tip_acceleration] if page.equations.payload is not None else []
    page.step(
        "Accelerations of the mass centres",
        "The acceleration is the derivative of the velocity with respect to time.",
        *_points(page, chain.center_accelerations, centers, 2),
        *_points(page, tip, joints[-1:] * len(tip), 2),
    )
    page.step(
        "Angular velocities and accelerations",
        "Every link turns about the $z$ axis, whose unit vector is $\\mathbf{k}$; turning from $x$ "
        "to $y$ is positive.",
        *(
            page.equation(page.vector(letter, i), page.along("k", row[i - 1]))
            for letter, row in (("omega", page.s.qd), ("alpha", page.s.qdd))
            for i in links
        ),
    )
    page.step(
        "Weights",
        "The weight of a link acts at its mass centre, downward: towards $+y$.",
        *(
            page.equation(page.vector("G", i), page.along("j", mass * page.s.gravity))
            for i, mass in zip(links, page.s.masses, strict=True)
        ),
    )
    _moments_of_inertia(page)
    if page.equations.laws:
        _effects(page)


def _mobility(page: Page) -> None:
    k = page.n - len(page.equations.locked)  # links that a lock joins count as one
    locks = " A lock makes one body of the two that it joins." if page.equations.locked else ""
    angles = listed(f"$q_{{{i}}}(t)$" for i in range(1, page.n + 1))
    symbol = page.symbol("M", "M")
    page.step(
        "Degrees of freedom",
        f"Here $n = {k}$ counts the moving links, $c_{{5}} = {k}$ the joints that leave one degree "
        f"of freedom, and $c_{{4}} = 0$ those that leave two.{locks} The chain is described by the "
        f"angles of its links: {angles}.",
        page.equation(symbol, Formula("3 n - 2 c_{5} - c_{4}")),
        page.equation(symbol, Formula(rf"3 \cdot {k} - 2 \cdot {k} - 0 = {k}")),
    )


def _moments_of_inertia(page: Page) -> None:
    s, names = page.s, [page.moment_of_inertia(i) for i in range(page.n + 1)]
    found = [
        page.equation(name, value)
        for name, value in zip(names[1:], s.inertias, strict=True)
        if value != name
    ]
    text = "The moment of inertia of each link about its mass centre is given."
    if found:
        text = (
            "The moment of inertia of a link about its mass centre is that of a uniform rod, "
            "unless another is given."
        )
    if page.chain.pivot_is_fixed:
        text += (
            " Link 1 turns about the fixed point $A$, for which the parallel axis theorem gives "
            "$I_{A}$."
        )
        found.append(page.equation(names[0], names[1] + s.masses[0] * s.centers[0] ** 2))
        if s.inertias[0] != names[1]:
            whole = page.equations.links[0].moment.inertia / s.qdd[0]
            found.append(page.equation(names[0], whole))
    page.step("Moments of inertia", text, *found)


def _effects(page: Page) -> None:
    equations, found = page.equations, list[Equation]()
    for definition in equations.definitions:
        if definition.symbol not in page.chain.path:
            found.append(page.equation(definition.symbol, definition.value))
    for load in equations.loads:
        parts = total(page.along(u, f) for u, f in zip("ij", load.force, strict=True))
        found.append(page.equation(page.load(load), parts))
    if equations.payload is not None:
        weight = page.along("j", equations.payload.mass * page.s.gravity)
        found.append(page.equation(page.vector("G", "p"), weight))
    for joint in equations.locked:
        found.append(page.equation(page.chain.joint(joint)[2], Integer(0)))
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
    page: Page, vectors: Sequence[Vector], names: Sequence[Formula], dots: int
) -> list[Equation]:
    return [
        page.equation(page.coordinate(axis, name, dots), vector[k])
        for vector, name in zip(vectors, names, strict=True)
        for k, axis in enumerate("xy")
    ]
