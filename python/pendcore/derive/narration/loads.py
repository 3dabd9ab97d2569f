"""Weights, moments of inertia, and the laws of what acts besides gravity."""

from __future__ import annotations

from sympy import Integer

from pendcore.derive.narration.page import Page, total
from pendcore.derive.step import Equation
from pendcore.derive.writing import MASS


def loads(page: Page) -> None:
    """Write what acts, and what resists."""
    s = page.s
    page.step(
        "Weights",
        "The weight of a link acts at its mass centre, downward: towards $+y$.",
        *(
            page.equation(page.vector("G", i), page.along("j", mass * s.gravity))
            for i, mass in enumerate(s.masses, start=1)
        ),
    )
    _moments_of_inertia(page)
    if page.equations.laws:
        _effects(page)


def _moments_of_inertia(page: Page) -> None:
    s, found = page.s, []
    for i, value in enumerate(s.inertias, start=1):
        name = page.moment_of_inertia(i)
        if value != name:
            found.append(page.equation(name, value))
    if page.n == 1:
        text = (
            f"{'A uniform rod' if page.is_uniform else 'The link'} has this moment of inertia "
            "about its mass centre"
        )
    else:
        whose = "Uniform rods" if page.is_uniform else "The links"
        text = f"{whose} have these moments of inertia about their mass centres"
    if not found:
        text = (
            "The moments of inertia about the mass centres are given"
            if page.n > 1
            else "The moment of inertia about the mass centre is given"
        )
    elif len(found) < page.n:
        text += ", where they are not given"
    if page.chain.pivot_is_fixed:
        text += "; link 1 turns about the fixed point $A$, for which the parallel axis theorem"
        text += " gives $I_{A}$"
        about_pivot = page.symbol("I_A", "I_{A}", MASS)
        parallel = page.moment_of_inertia(1) + s.masses[0] * s.centers[0] ** 2
        found.append(page.equation(about_pivot, parallel))
        whole = page.equations.links[0].moment.inertia / s.qdd[0]
        if s.inertias[0] != page.moment_of_inertia(1):
            found.append(page.equation(about_pivot, whole))
    page.step("Moments of inertia", f"{text}.", *found)


def _effects(page: Page) -> None:
    path = page.chain.path
    found: list[Equation] = [
        page.equation(definition.symbol, definition.value)
        for definition in page.equations.definitions
        if definition.symbol not in path
    ]
    for load in page.equations.loads:
        parts = (page.along(u, f) for u, f in zip("ij", load.force, strict=True))
        found.append(page.equation(page.load(load), total(parts)))
    if page.equations.payload is not None:
        weight = page.along("j", page.equations.payload.mass * page.s.gravity)
        found.append(page.equation(page.vector("G", "p"), weight))
    opposite = ", and the opposite torque on the link before it" if page.n > 1 else ""
    torques = page.equations.torques or page.equations.locked or any(page.equations.armatures)
    for joint in page.equations.locked:
        found.append(page.equation(page.chain.joint_acceleration(joint), Integer(0)))
    page.step(
        "Effects",
        " ".join(dict.fromkeys(law.sentence(page.s) for law in page.equations.laws))
        + (f" A torque at a joint acts on the link beyond it{opposite}." if torques else ""),
        *found,
    )
