"""The equations collected, solved, and as a first-order system."""

from __future__ import annotations

from pendcore.derive.narration.page import Page


def first_order(page: Page) -> None:
    """Write the solution and the first-order form."""
    entries, solved = page.motion.by_entries
    page.step(
        "Solution for the angular accelerations",
        "The equations of motion are linear in the accelerations, $M \\ddot{q} = f$.",
        *(page.equation(name, value) for name, value in entries.items()),
        *(page.equation(a, value) for a, value in zip(page.s.qdd, solved, strict=True)),
    )
    state = []
    for i, (q, qd, qdd) in enumerate(zip(page.s.q, page.s.qd, page.s.qdd, strict=True)):
        x, xd = (page.symbol(f"x({2 * i + k})", f"x_{{{2 * i + k}}}") for k in (1, 2))
        state += [page.equation(x, q), page.equation(xd, qd)]
        for name, value in ((x, xd), (xd, qdd)):
            rate = page.symbol(f"d{name}/dt", rf"\dot{{{page.s.latex(name)}}}")
            state.append(page.equation(rate, value))
    page.step("First-order form", "Two states for each link.", *state)
