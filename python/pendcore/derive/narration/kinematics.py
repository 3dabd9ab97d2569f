"""Positions, velocities and accelerations, of points and angles."""

from __future__ import annotations

from collections.abc import Sequence

from pendcore.derive.chain import Vector
from pendcore.derive.narration.page import Page, total
from pendcore.derive.step import Equation, Formula

AXES = ("x", "y")


def kinematics(page: Page) -> None:
    """Write the kinematics."""
    n, chain = page.n, page.chain
    _mobility(page)
    centers = [page.center(i) for i in range(1, n + 1)]
    joints = [page.joint(i) for i in range(n + 1)]
    fixed = chain.pivot_is_fixed
    origin = (
        "The origin is at $A$."
        if fixed
        else ("The origin is the point about which the pivot $A$ moves on a given path.")
    )
    names = _listed(f"$q_{{{i}}}$" for i in range(1, n + 1))
    measured = f"The angles {names} are" if n > 1 else f"The angle {names} is"
    page.step(
        "Positions",
        "The plane of motion is the $xy$ plane, with $x$ to the right and $y$ vertical, positive "
        f"downward. {origin} "
        f"{measured} measured from the $x$ axis towards the $y$ axis.",
        *(page.equation(symbol, law) for symbol, law in chain.path.items()),
        *_points(page, chain.joints[1:], joints[1:], 0),
        *_vectors(page, centers),
        *_points(page, chain.centers, centers, 0),
    )
    page.step(
        "Velocities of the mass centres",
        "The velocity is the derivative of the position with respect to time.",
        *_points(page, chain.center_velocities, centers, 1),
    )
    page.step(
        "Accelerations of the mass centres",
        "The acceleration is the derivative of the velocity with respect to time.",
        *_points(page, chain.center_accelerations, centers, 2),
        *(
            _points(page, [chain.tip_acceleration], joints[-1:], 2)
            if page.equations.payload is not None
            else ()
        ),
    )
    page.step(
        "Angular velocities and accelerations",
        f"{'The links turn' if n > 1 else 'The link turns'} about the $z$ axis, whose unit vector "
        "is $\\mathbf{k}$; turning from $x$ to $y$ is positive.",
        *(
            page.equation(page.vector(letter, i), page.along("k", row[i - 1]))
            for letter, row in (("omega", page.s.qd), ("alpha", page.s.qdd))
            for i in range(1, n + 1)
        ),
    )


def _mobility(page: Page) -> None:
    n = page.n
    locked = page.equations.locked
    k = n - len(locked)  # links that a lock joins count as one
    joints = "one revolute joint" if k == 1 else f"{k} revolute joints"
    links = "one moving link" if k == 1 else f"{k} moving links"
    text = f"The chain has {links} and {joints}, with one degree of freedom{' each' * (k > 1)}"
    if k == 0:
        text = f"{'The link does' if n == 1 else 'The links do'} not move"
    text += (
        f": $n = {k}$, $c_{{5}} = {k}$, $c_{{4}} = 0$. Here $n$ counts the moving links, $c_{{5}}$ "
        "the joints that leave one degree of freedom, and $c_{4}$ those that leave two."
    )
    if locked:
        joints = f"joint{'s' if len(locked) > 1 else ''} {_listed(map(str, locked))}"
        text += f" The lock of {joints} makes one body of the two that it joins."
    symbol = page.symbol("M", "M")
    count = Formula(f"3*{k} - 2*{k} - 0 = {k}", rf"3 \cdot {k} - 2 \cdot {k} - 0 = {k}")
    general = Formula("3 n - 2 c5 - c4", r"3 n - 2 c_{5} - c_{4}")
    angles = _listed(f"$q_{{{i}}}(t)$" for i in range(1, n + 1))
    coordinates = "The generalized coordinates are the angles"
    if locked:
        coordinates = f"The chain is described by the angle{'s' * (n > 1)}"
    elif n == 1:
        coordinates = "The generalized coordinate is the angle"
    page.step(
        "Degrees of freedom",
        f"{text} {coordinates} {angles} of the link{'s' if n > 1 else ''}.",
        page.equation(symbol, general),
        page.equation(symbol, count),
    )


def _vectors(page: Page, names: Sequence[Formula]) -> list[Equation]:
    return [
        page.equation(
            page.position(name),
            total(page.along(u, page.coordinate(a, name)) for a, u in zip(AXES, "ij", strict=True)),
        )
        for name in names
    ]


def _points(
    page: Page, vectors: Sequence[Vector], names: Sequence[Formula], dots: int
) -> list[Equation]:
    return [
        page.equation(page.coordinate(axis, name, dots), vector[k])
        for vector, name in zip(vectors, names, strict=True)
        for k, axis in enumerate(AXES)
    ]


def _listed(words: object) -> str:
    *most, last = list(words)  # type: ignore[call-overload]
    return f"{', '.join(most)} and {last}" if most else str(last)
