"""Positions, velocities and accelerations, of points and angles."""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Integer

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
    pivot = "" if chain.pivot_is_fixed else " from where the pivot $A$ is at $x = y = 0$; it moves"
    page.step(
        "Positions",
        "The plane of motion is the $xy$ plane, with $x$ to the right and $y$ vertical, positive "
        f"downward. Positions are measured from {'$A$' if not pivot else 'the origin,'}{pivot}. "
        f"The angles {_listed(f'$q_{{{i}}}$' for i in range(1, n + 1))} are measured from the "
        "$x$ axis towards the $y$ axis.",
        *(_points(page, [chain.pivot], joints[:1], 0) if pivot else ()),
        *_points(page, chain.joints[1:], joints[1:], 0),
        *_vectors(page, centers),
        *_points(page, chain.centers, centers, 0),
    )
    page.step(
        "Velocities of the mass centres",
        "The velocity is the derivative with respect to time of the position.",
        *_points(page, chain.center_velocities, centers, 1),
    )
    page.step(
        "Accelerations of the mass centres",
        "The acceleration is the derivative with respect to time of the velocity.",
        *_points(page, chain.center_accelerations, centers, 2),
        *(
            _points(page, [chain.tip_acceleration], joints[-1:], 2)
            if page.equations.payload is not None
            else ()
        ),
    )
    page.step(
        "Angular velocities and accelerations",
        "The links turn about the $z$ axis, of unit vector $\\mathbf{k}$; positive is from $x$ to "
        "$y$.",
        *(
            page.equation(page.vector(letter, i), page.along("k", row[i - 1]))
            for letter, row in (("omega", page.s.qd), ("alpha", page.s.qdd))
            for i in range(1, n + 1)
        ),
    )


def _mobility(page: Page) -> None:
    n = page.n
    joints = "one revolute joint" if n == 1 else f"{n} revolute joints"
    links = "one moving link" if n == 1 else f"{n} moving links"
    text = (
        f"The chain has {links} and {joints}, of one degree of freedom each: $n = {n}$, "
        f"$c_{{5}} = {n}$, $c_{{4}} = 0$."
    )
    locked = page.equations.locked
    if locked:
        text += (
            f" It would move with {n} if no joint were locked; the lock of joint"
            f"{'s' if len(locked) > 1 else ''} {_listed(map(str, locked))} takes "
            f"{len(locked)} away."
        )
    symbol = page.symbol("M", "M")
    count = Formula(f"3*{n} - 2*{n} - 0 = {n}", rf"3 \cdot {n} - 2 \cdot {n} - 0 = {n}")
    general = Formula("3 n - 2 c5 - c4", r"3 n - 2 c_{5} - c_{4}")
    angles = _listed(f"$q_{{{i}}}(t)$" for i in range(1, n + 1))
    page.step(
        "Degrees of freedom",
        f"{text} The generalized coordinate{'s are the angles' if n > 1 else ' is the angle'} "
        f"{angles} of the link{'s' if n > 1 else ''}.",
        page.equation(symbol, general),
        page.equation(symbol, count),
        *([page.equation(symbol, Integer(n - len(locked)))] if locked else ()),
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
