"""The comparison of effects: what each adds to a right-hand side of two links, beside MuJoCo.

The baseline of each side is its own scene without the effect. contenders/effect_parameters.hpp has
the numbers.
"""

from __future__ import annotations

import sys
import time
from dataclasses import asdict, dataclass
from typing import Any

import count_instructions
from chain_scenes import Array, chain_scene
from chains import disagreement, nanoseconds
from contenders.contender import Unsupported
from contenders.forward_dynamics import Calls, ForwardDynamics, contenders
from machine import circumstances
from measure import interleave
from tqdm import tqdm

BURST_SECONDS = 2e-3
SIDES = ("pendcore", "pendcore_step", "pendcore_run", "mujoco_forward", "mujoco_run")
ALLOWED_DISAGREEMENT = 1e-6
FELT = 1e-10  # MuJoCo finds little drag on bodies without shapes, but it does compute it

Key = tuple[str, str]  # effect and contender


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """`name` is that of effect_parameters.hpp, `theirs` what MuJoCo calls it.

    `ours`: pendcore has it; `same_law`: both sides must give the same accelerations, `felt`: and
    others than the bare scene. The last two are what pendcore promises at most, None where it
    promises nothing. Friction that slides is one torque more; a stop that is not reached has none,
    but its scene is in the kernel of joint torques.
    """

    name: str
    label: str
    theirs: str
    ours: bool = True
    same_law: bool = True
    felt: bool = True
    most_ns: float | None = 6
    most_instructions: int | None = 60


BARE = Effect(name="none", label="bare scene", theirs="")
EFFECTS = (
    Effect(name="viscous_joint", label="viscous joint", theirs="joint damping"),
    Effect(
        name="viscous_joint_3", label="viscous joint, three terms", theirs="joint damping, 3 terms"
    ),
    Effect(
        name="rod_drag",
        label="rod drag, both links",
        theirs="fluid forces, inertia box",
        same_law=False,
        most_ns=15,
        most_instructions=150,
    ),
    Effect(name="torsional_spring", label="torsional spring", theirs="joint stiffness"),
    Effect(name="motor_constant", label="motor, constant", theirs="motor actuator"),
    Effect(name="motor_sinusoid", label="motor, sinusoid", theirs="motor, control set", most_ns=10),
    Effect(name="motor_table", label="motor, table", theirs=""),
    Effect(name="motor_pd", label="motor, PD with limit", theirs="position actuator, forcerange"),
    Effect(name="rotor_inertia", label="rotor inertia", theirs="armature"),
    Effect(name="payload", label="payload", theirs="part of the body"),
    Effect(name="driven_pivot", label="driven pivot, sinusoid", theirs="", most_ns=10),
    Effect(
        name="dry_joint_friction",
        label="dry friction, sliding",
        theirs="frictionloss",
        same_law=False,
    ),
    Effect(
        name="joint_limit",
        label="joint stop, never reached",
        theirs="joint limit",
        felt=False,
    ),
    Effect(
        name="user",
        label="compiled function of a user's",
        theirs="mjcb_passive",
        most_ns=None,
        most_instructions=None,
    ),
)


def prepare(entrants: list[ForwardDynamics]) -> tuple[dict[Key, Calls], dict[str, float]]:
    """Prepare all calls; with them how far both sides' accelerations are apart."""
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
    """Measure all there is, and say on what: the record, as JSON holds it."""
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
