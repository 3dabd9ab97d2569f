"""The comparison of effects: what each adds to a right-hand side of two links, beside MuJoCo.

The baseline of each side is its own scene without the effect. contenders/effect_parameters.hpp has
the numbers.
"""

from __future__ import annotations

import sys
import time
from dataclasses import asdict
from typing import Any

import count_instructions
from chain_scenes import Array, chain_scene
from chains import disagreement, nanoseconds
from contenders.contender import Unsupported
from contenders.forward_dynamics import Calls, ForwardDynamics, contenders
from effect_list import BARE, EFFECTS
from machine import circumstances
from measure import interleave
from tqdm import tqdm

BURST_SECONDS = 2e-3
SIDES = ("pendcore", "pendcore_step", "pendcore_run", "mujoco_forward", "mujoco_run")
ALLOWED_DISAGREEMENT = 1e-6
FELT = 1e-10  # MuJoCo finds little drag on bodies without shapes, but it does compute it

Key = tuple[str, str]  # effect and contender


def prepare(entrants: list[ForwardDynamics]) -> tuple[dict[Key, Calls], dict[str, float]]:
    """Prepare all calls; return how far apart the accelerations of both sides are."""
    calls: dict[Key, Calls] = {}
    apart: dict[str, float] = {}
    bare: dict[str, Array] = {}
    for effect in (BARE, *EFFECTS):
        scene = chain_scene(2, effect.name)
        for contender in entrants:
            try:
                calls[effect.name, contender.name] = contender.prepare(scene)
            except Unsupported:
                continue
        found = {
            side: calls[effect.name, side].accelerations()
            for side in ("pendcore", "mujoco_forward")
            if (effect.name, side) in calls
        }
        bare = bare or found
        for side, one in found.items():
            if effect.felt and effect is not BARE and not disagreement(one, bare[side]) > FELT:
                raise RuntimeError(f"{effect.label}: {side} does not feel it")
        if effect.same_law and len(found) == 2:
            apart[effect.name] = disagreement(found["mujoco_forward"], found["pendcore"])
            if not apart[effect.name] <= ALLOWED_DISAGREEMENT:
                raise RuntimeError(f"{effect.label}: {found}: not one scene")
    return calls, apart


def measure(*, quick: bool, rounds: int) -> dict[str, Any]:
    """Measure everything that is here; return the record, with the machine, as JSON holds it."""
    with contenders() as found:
        entrants = [one for one in found if one.name in SIDES]
        return measure_these(entrants, quick, rounds)


def measure_these(entrants: list[ForwardDynamics], quick: bool, rounds: int) -> dict[str, Any]:
    begin = time.perf_counter()
    if not entrants:
        print("effects: nobody takes part", file=sys.stderr)
    calls, apart = prepare(entrants)
    bar = tqdm(range(rounds), desc="effects", unit="round", disable=None)
    timings = interleave(calls, bar, BURST_SECONDS)
    names = [effect.name for effect in (BARE, *EFFECTS) if effect.ours]
    instructions = {} if quick else count_instructions.count_effects(names)
    return {
        "comparison": "effects",
        **circumstances(begin, rounds, BURST_SECONDS),
        "bare_instructions": {} if quick else count_instructions.count_bare(),
        "contenders": [
            {"name": one.name, "label": one.label, "about": one.about} for one in entrants
        ],
        "effects": [
            {
                **asdict(effect),
                "sides": {
                    side: nanoseconds(timings[effect.name, side])
                    for side in SIDES
                    if (effect.name, side) in timings
                },
                "disagreement": apart.get(effect.name),
                "instructions": instructions.get(effect.name, {}),
            }
            for effect in (BARE, *EFFECTS)
        ],
    }
