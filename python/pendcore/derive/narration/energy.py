"""The check that the equations of motion allow: where the energy goes."""

from __future__ import annotations

from pendcore.derive.narration.page import Page
from pendcore.derive.step import Equation


def energy(page: Page) -> None:
    """Write energies, powers and their balance."""
    of = page.derivation.energy
    found: list[Equation] = [
        page.equation(page.symbol("T", "T"), of.kinetic),
        page.equation(page.symbol("V", "V"), of.potential),
    ]
    names = []
    powers = of.powers_with(page.equations.forces[0])
    for i, power in enumerate(powers.values(), start=1):
        names.append(page.symbol(f"P{i}", f"P_{{{i}}}"))
        found.append(page.equation(names[-1], power))
    rate = page.symbol("d(T + V)/dt", r"\frac{\mathrm{d}}{\mathrm{d}t} (T + V)")
    text = "The motion conserves the energy, which no step above has made use of"
    if names:
        text = "The energy changes at the rate of the powers of the effects, and by nothing else"
    page.step("Energy", f"{text}.", *found, page.equation(rate, sum(names)))
