"""The check that the equations of motion allow: where the energy goes."""

from __future__ import annotations

from typing import Any

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
    told = []
    for i, (effect, power) in enumerate(powers.items(), start=1):
        told.append(f"$P_{{{i}}}$ is that of the {_named(effect)}")
        names.append(page.symbol(f"P{i}", f"P_{{{i}}}"))
        found.append(page.equation(names[-1], power))
    rate = page.symbol("d(T + V)/dt", r"\frac{\mathrm{d}}{\mathrm{d}t} (T + V)")
    text = "The motion conserves the energy; no step above has used this"
    if names:
        text = (
            "Only the effects change the energy, at the rate of the sum of their powers: "
            f"{', '.join(told)}"
        )
    page.step("Energy", f"{text}.", *found, page.equation(rate, sum(names)))


def _named(effect: Any) -> str:
    """Return what an effect is and where: ``motor at joint 2``."""
    words = {"viscous_joint": "damping"}.get(effect.kind, str(effect.kind).replace("_", " "))
    if (joint := getattr(effect, "joint", None)) is not None:
        return f"{words} at joint {joint}"
    link = getattr(effect, "link", None)
    return words if link is None else f"{words} on link {link}"
