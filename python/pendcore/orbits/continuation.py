"""Families of orbits, by pseudo-arclength: one number changes, and the family may turn back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pendcore.messages import Floats
from pendcore.orbits.shooting import (
    GROWTH,
    MOST_ARCS,
    Arcs,
    Closed,
    NotClosedError,
    Shooting,
    require_energy,
    tangent_of,
    total_energy,
    velocity,
)

SHORTEST = 1e-6
"""The least step that is tried: below it the family is lost."""
EASY = 5
"""So few corrections that the next step may be longer."""
STAYS = 10
"""So many orbits between which the number hardly changes are the end of a family, as where the
period grows without end."""


class Family(NamedTuple):
    """Orbits that were found, and why there are no more, if the last is not the one asked for."""

    found: list[Closed]
    lost: str = ""


def followed(shooting: Shooting, arcs: Arcs, until: float, longest: float, most: int) -> Family:
    """Follow the family from an orbit until the number that changes comes to a value.

    Steps are in the units of `System.columns`, those of the states over all arcs, so that they mean
    the same however many arcs there are.
    """
    if shooting.free == "energy":
        require_energy("until", until, shooting.scene)
    here, found = shooting.closed(arcs), list[Closed]()
    onward = np.sign(until - arcs.value)
    step, ahead, stays = longest / 4, _ends(here.tangent, arcs), 0
    if ahead[-1] * onward < 0:
        ahead = -ahead
    while len(found) + 1 < most:
        tangent = here.tangent * np.sign(_ends(here.tangent, here.arcs) @ ahead)
        columns = shooting.system(here.arcs, here.arcs).columns
        guess = shooting.moved(here.arcs, step * tangent * columns)
        try:
            there = shooting.closed(guess, tangent)
            if abs(_ends(there.tangent, there.arcs) @ _ends(tangent, here.arcs)) < 0.5:
                raise NotClosedError("it turns too fast")
            if at_rest := _rest_between(shooting, here.arcs, there.arcs):
                return Family(found, at_rest)
            if (there.arcs.value - until) * (here.arcs.value - until) <= 0:
                return Family([*found, _at(shooting, here.arcs, there.arcs, until)])
        except (NotClosedError, ValueError) as failure:  # a parameter may leave its range
            step /= 2
            if step < SHORTEST:
                return Family(found, str(failure))
            continue
        found.append(there)
        stays = stays + 1 if abs(there.arcs.value - here.arcs.value) < 1e-6 * shooting.span else 0
        if stays == STAYS:
            return Family(found, f"it stays there, at a period of {there.arcs.period:.6g} s")
        ahead = _ends(tangent, here.arcs)
        here = there
        if shooting.growth(here.arcs) > 10 * GROWTH and not shooting.period_follows:
            if 2 * len(there.arcs.states) > MOST_ARCS:
                return Family(found, f"it takes more than {MOST_ARCS} arcs, so unstable it is")
            halves = shooting.cut(there.arcs)
            here = there._replace(arcs=halves, tangent=tangent_of(shooting.system(halves, halves)))
        step = min(longest, 1.5 * step) if there.corrections <= EASY else step
    return Family(found, f"{most} orbits are all that were asked for")


def _rest_between(shooting: Shooting, one: Arcs, other: Arcs) -> str:
    """Say where the family has shrunk to a point, beyond which its orbits are the same again.

    Their phase is then another by half a period: the motion goes the other way.
    """
    if shooting.is_forced:
        return ""
    before, after = (
        velocity(shooting.at(arcs.value), 0.0, arcs.states[0]) / shooting.scales
        for arcs in (one, other)
    )
    if before @ after >= 0:
        return ""
    share = np.linalg.norm(before) / (np.linalg.norm(before) + np.linalg.norm(after))
    value = one.value + float(share) * (other.value - one.value)
    q = np.split(one.states[0] + share * (other.states[0] - one.states[0]), 2)[0]
    energy = float(total_energy(shooting.at(value), np.append(q, 0 * q)))
    return (
        f"it shrinks to the equilibrium at q = {q.round(4).tolist()}, whose energy is "
        f"{energy:.6g} J"
    )


def _ends(tangent: Floats, arcs: Arcs) -> Floats:
    """Return the parts of a direction that do not depend on the number of arcs, of length 1."""
    size = arcs.states.shape[1]
    parts = np.concatenate([tangent[:size] * len(arcs.states) ** 0.5, tangent[arcs.states.size :]])
    unit: Floats = parts / np.linalg.norm(parts)
    return unit


def _at(shooting: Shooting, one: Arcs, other: Arcs, value: float) -> Closed:
    """Return the orbit at a value between those of two neighbours."""
    share = (value - one.value) / (other.value - one.value)
    states = one.states + share * (other.states - one.states)
    period = one.period + share * (other.period - one.period)
    if shooting.period_follows:
        period = one.period * one.value / value
    return shooting.closed(Arcs(states, period, value))
