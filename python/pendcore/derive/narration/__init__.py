"""The words of the derivation, a file for each of its parts, in the textbook's order."""

from __future__ import annotations

from pendcore.derive.algebra import Algebra
from pendcore.derive.narration.elimination import elimination
from pendcore.derive.narration.energy import energy
from pendcore.derive.narration.first_order import first_order
from pendcore.derive.narration.kinematics import kinematics
from pendcore.derive.narration.loads import loads
from pendcore.derive.narration.newton_euler import newton_euler
from pendcore.derive.narration.page import Page
from pendcore.derive.step import Step

PARTS = (kinematics, loads, newton_euler, elimination, first_order, energy)


def steps(derivation: Algebra) -> tuple[Step, ...]:
    """Return the steps of a derivation."""
    page = Page(derivation)
    for part in PARTS:
        part(page)
    return tuple(page.steps)
