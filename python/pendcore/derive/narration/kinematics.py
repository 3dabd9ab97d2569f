"""Positions, velocities and accelerations, of points and angles."""

from __future__ import annotations

from pendcore.derive.chain import Vector
from pendcore.derive.narration.page import Page
from pendcore.derive.step import Equation, Formula

AXES = ("x", "y")


def kinematics(page: Page) -> None:
    """Write the kinematics."""
    n, chain = page.n, page.chain
    page.step(
        "Positions of the mass centres",
        f"The plane of motion is the $xy$ plane, $x$ to the right and $y$ vertical, positive "
        f"downward; the origin is at $A$. The angles "
        f"{', '.join(f'$q_{{{i}}}$' for i in range(1, n + 1))} of the links, measured from the "
        "$x$ axis towards the $y$ axis, are the generalized coordinates.",
        *_points(page, chain.joints[1:], [page.joint(i) for i in range(1, n + 1)], 0),
        *_points(page, chain.centers, [page.center(i) for i in range(1, n + 1)], 0),
    )
    centers = [page.center(i) for i in range(1, n + 1)]
    page.step(
        "Velocities of the mass centres",
        "The velocity is the derivative with respect to time of the position.",
        *_points(page, chain.center_velocities, centers, 1),
    )
    page.step(
        "Accelerations of the mass centres",
        "The acceleration is the derivative with respect to time of the velocity.",
        *_points(page, chain.center_accelerations, centers, 2),
    )
    angular = []
    for i, (rate, turning) in enumerate(zip(page.s.qd, page.s.qdd, strict=True), start=1):
        for letter, latex, value in (("omega", r"\omega", rate), ("alpha", r"\alpha", turning)):
            name = Formula(f"{letter}{i}", rf"\boldsymbol{{{latex}}}_{{{i}}}")
            of = Formula(f"{value} k", rf"{page.s.latex(value)} \, \mathbf{{k}}")
            angular.append(page.equation(name, of))
    page.step(
        "Angular velocities and accelerations",
        "The links turn about the axis $z$ of unit vector $\\mathbf{k}$, away from the reader.",
        *angular,
    )


def _points(
    page: Page, vectors: tuple[Vector, ...], names: list[tuple[str, str]], dots: int
) -> list[Equation]:
    return [
        page.equation(page.coordinate(axis, name, dots), vector[k])
        for vector, name in zip(vectors, names, strict=True)
        for k, axis in enumerate(AXES)
    ]
