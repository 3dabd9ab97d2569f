"""The words of the derivation, a file for each of its parts, in the textbook's order."""

from __future__ import annotations

from pendcore.derive.derivation import Derivation
from pendcore.derive.narration.kinematics import kinematics
from pendcore.derive.narration.newton_euler import newton_euler
from pendcore.derive.narration.page import Page
from pendcore.derive.narration.results import energy, equations_of_motion, first_order, solution
from pendcore.derive.step import Step


def steps(derivation: Derivation) -> tuple[Step, ...]:
    """Return the steps of a derivation."""
    page = Page(derivation)
    for part in (kinematics, newton_euler, equations_of_motion, solution, first_order, energy):
        part(page)
    return tuple(page.steps)
