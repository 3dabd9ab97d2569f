"""The comparison of effects: what each adds to a right-hand side of two links, beside MuJoCo.

The baseline of each side is its own scene without the effect. contenders/effect_parameters.hpp has
the numbers.
"""

from __future__ import annotations

import time

import count_instructions
from chain_scenes import Array, chain_scene
from chains import disagreement, nanoseconds
from contenders.contender import Unsupported
from contenders.forward_dynamics import Calls, ForwardDynamics, contenders
from effect_list import BARE, EFFECTS
from machine import circumstances
from measure import interleave
from record import Point, Record
from tqdm import tqdm

BURST_SECONDS = 2e-3
CORE, PEER = "pendcore", "mujoco_forward"
SIDES = (CORE, "pendcore_step", "pendcore_run", PEER, "mujoco_run")
ALLOWED_DISAGREEMENT = 1e-6
FELT = 1e-10  # MuJoCo finds little drag on bodies without shapes, but it does compute it
FACTS = ("label", "theirs", "ours", "most_ns", "most_instructions")


def prepare(
    entrants: list[ForwardDynamics],
) -> tuple[dict[tuple[str, str], Calls], dict[str, float]]:
    """Prepare all calls; return how far apart the accelerations of both sides are."""
    calls: dict[tuple[str, str], Calls] = {}
    apart: dict[str, float] = {}
    bare: dict[str, Array] = {}
    for effect in (BARE, *EFFECTS):
        scene = chain_scene(2, effect.name)
        for contender in entrants:
            try:
                calls[contender.name, effect.name] = contender.prepare(scene)
            except Unsupported:
                continue
        found = {
            side: calls[side, effect.name].accelerations()
            for side in (CORE, PEER)
            if (side, effect.name) in calls
        }
        bare = bare or found
        for side, one in found.items():
            if effect.felt and effect is not BARE and not disagreement(one, bare[side]) > FELT:
                raise RuntimeError(f"{effect.label}: {side} does not feel it")
        if effect.same_law and len(found) == 2:
            apart[effect.name] = disagreement(found[PEER], found[CORE])
            if not apart[effect.name] <= ALLOWED_DISAGREEMENT:
                raise RuntimeError(f"{effect.label}: {found}: not one scene")
    return calls, apart


def instructions() -> list[Point]:
    """Count the instructions of a right-hand side with each effect, and of the bare scene."""
    names = [effect.name for effect in (BARE, *EFFECTS) if effect.ours]
    rows = [
        {"contender": contender, "case": name, "instructions": counts[way]}
        for name, counts in count_instructions.count_effects(names).items()
        for way, contender in count_instructions.WAYS.items()
    ]
    bare = count_instructions.count_bare()
    for contender, what in (("pendcore_kernel", "kernel"), ("one_effect_more", "one_effect_more")):
        if what in bare:
            row = {"contender": contender, "case": BARE.name, "instructions": bare[what]}
            rows.append(row)
    return rows


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure everything that is here."""
    begin = time.perf_counter()
    with contenders() as found:
        entrants = [one for one in found if one.name in SIDES]
        calls, apart = prepare(entrants)
        bar = tqdm(range(rounds), desc="effects", unit="round", disable=None)
        timings = interleave(calls, bar, BURST_SECONDS)
    rows: dict[tuple[str, str], Point] = {}
    for (who, effect), timing in timings.items():
        row = {"contender": who, "case": effect, **nanoseconds(timing)}
        rows[who, effect] = row | {"disagreement": apart.get(effect) if who == PEER else None}
    for counted in [] if quick else instructions():
        rows.setdefault((counted["contender"], counted["case"]), {}).update(counted)
    return Record.of(
        {"comparison": "effects", **circumstances(begin, rounds, BURST_SECONDS)},
        {who.name: who.facts() for who in entrants},
        {
            effect.name: {fact: getattr(effect, fact) for fact in FACTS}
            for effect in (BARE, *EFFECTS)
        },
        rows.values(),
    )
