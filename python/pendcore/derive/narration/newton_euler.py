"""Weights, moments of inertia, and the Newton-Euler equations of every link."""

from __future__ import annotations

from pendcore.derive.narration.page import Page


def newton_euler(page: Page) -> None:
    """Write the equations of every link."""
    s = page.s
    moments = []
    for i in range(1, page.n + 1):
        name = page.symbol(f"I_C{i}", f"I_{{C_{{{i}}}}}")
        if s.inertias[i - 1] != name:
            moments.append(page.equation(name, s.inertias[i - 1]))
    page.step("Moments of inertia", "About the mass centres.", *moments)
    for i, link in enumerate(page.equations.links, start=1):
        ax, ay = (page.coordinate(axis, page.center(i), 2) for axis in "xy")
        mass = s.masses[i - 1]
        last = page.n == i and i > 1
        numbers = ("2.5", "2.5", "2.5") if last else (None, None, "2.2")
        page.step(
            f"Newton-Euler equations of link {i}",
            "Mass times acceleration is the sum of the forces; moment of inertia times angular "
            "acceleration the sum of the moments, about "
            + ("the fixed point $A$." if link.about_pivot else f"$C_{{{i}}}$."),
            page.equation(mass * ax, link.x.acting, numbers[0]),
            page.equation(mass * ay, link.y.acting, numbers[1]),
            page.equation(link.moment.inertia, link.moment.acting, numbers[2]),
        )
