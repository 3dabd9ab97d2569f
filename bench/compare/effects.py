"""The comparison of effects: what each adds to a right-hand side of two links, beside MuJoCo.

The baseline of each side is its own scene without the effect.
"""

from __future__ import annotations

import time

import count_instructions
from cases import Array
from contenders.contender import Contender, Unsupported
from contenders.programs import Calls
from effect_list import BARE, EFFECTS
from forward_dynamics import chain_scene, contenders, disagreement, facts
from machine import circumstances
from measure import interleave
from record import Point, Record

BURST_SECONDS = 2e-3
CORE, PEER = "pendcore", "mujoco_forward"
SIDES = (CORE, "pendcore_step", "pendcore_run", PEER, "mujoco_run")
ALLOWED_DISAGREEMENT = 1e-6
FELT = 1e-10  # MuJoCo finds little drag on bodies without shapes, but it does compute it
FACTS = ("label", "theirs", "ours", "most_ns", "most_instructions")


def prepare(
    entrants: list[Contender],
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
            side: calls[side, effect.name].outcome()
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


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure everything that is here."""
    begin = time.perf_counter()
    entrants = [one for one in contenders() if one.name in SIDES]
    calls, apart = prepare(entrants)
    timings = interleave(calls, rounds, BURST_SECONDS, what="effects")
    rows: dict[tuple[str, str], Point] = {}
    for (who, effect), timing in timings.items():
        row = {"contender": who, "case": effect, **timing.row("ns", 1e9)}
        rows[who, effect] = row | {"disagreement": apart.get(effect) if who == PEER else None}
    names = [effect.name for effect in (BARE, *EFFECTS) if effect.ours]
    for counted in [] if quick else count_instructions.rows_of(names):
        rows.setdefault((counted["contender"], counted["case"]), {}).update(counted)
    return Record.of(
        {"comparison": "effects", **circumstances(begin, rounds, BURST_SECONDS)},
        {who.name: facts(who) for who in entrants},
        {
            effect.name: {fact: getattr(effect, fact) for fact in FACTS}
            for effect in (BARE, *EFFECTS)
        },
        rows.values(),
    )
