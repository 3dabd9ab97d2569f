"""The reactions from Newton's equations, and the moment equations without them."""

from __future__ import annotations

from pendcore.derive.narration.page import Page


def elimination(page: Page) -> None:
    """Write the reactions, and what is left without them."""
    solved = page.equations.solved_forces
    found = [
        page.equation(symbol, solved[symbol], "2.9" if k == 1 else None)
        for k, pair in reversed(list(enumerate(page.equations.forces)))
        for symbol in pair
    ]
    page.step("Joint reactions", "Newton's equations give the reactions, from the tip in.", *found)
    page.step(
        "Equations of motion",
        "The reactions are put into the moment equations.",
        *(
            page.equation(line.inertia, line.acting, number)
            for line, number in zip(
                page.equations.without_reactions, ["2.10", "2.11", *[None] * page.n], strict=False
            )
        ),
    )
