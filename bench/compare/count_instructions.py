"""Count the instructions of a right-hand side of two links, with each effect and without.

Valgrind's callgrind counts what the program of pendcore's contender executes with a number of
calls, and with none. The difference belongs to the calls; it is the same on every run and on every
machine that executes the same instructions. Valgrind does not know AVX-512, so the kernels for
x86-64-v3 are counted.

    python bench/compare/count_instructions.py [EFFECT ...]

    call     of pendcore::accelerations_in_force
    step     of a right-hand side within attempted steps of dopri5

and three counts of the bare scene, in steps: as it is; by the kernel that is named by its type,
which no effect can affect; and in a core that has one law more in its list.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from chain_scenes import ChainScene, chain_scene
from contenders.conversation import find_executable
from contenders.forward_dynamics import described
from effect_list import BARE, EFFECTS
from tqdm import tqdm

PROGRAM = "forward_dynamics_pendcore"
ONE_EFFECT_MORE = "forward_dynamics_one_effect_more"
WAYS = {"call": "pendcore", "step": "pendcore_step"}
KERNEL = "pendcore_kernel"
CALLS = 256
LONGEST_RUN = 60.0  # s; a run takes a third of a second
VARIABLE = "PENDCORE_FORWARD_DYNAMICS"


class NotCounted(Exception):
    """Raised, with the reason, if nothing can be counted."""


def programs() -> tuple[Path, Path]:
    """Find the program and the one with one effect more; NotCounted says what is missing."""
    if shutil.which("valgrind") is None:
        raise NotCounted("valgrind is missing (Debian: valgrind)")
    try:
        return find_executable(PROGRAM, VARIABLE), find_executable(ONE_EFFECT_MORE, VARIABLE)
    except ImportError as absence:
        raise NotCounted(str(absence)) from None


def executed(program: Path, requests: list[str]) -> int:
    """Count the instructions that the program executes over a conversation."""
    run = subprocess.run(
        ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program],
        input="\n".join(requests) + "\n",
        capture_output=True,
        text=True,
        check=True,
        timeout=LONGEST_RUN,
        env=os.environ | {"PENDCORE_INSTRUCTION_SET": "x86-64-v3"},
    )
    refused = [line for line in run.stdout.splitlines() if not line.startswith("ok")]
    found = re.search(r"Collected\s*:\s*(\d+)", run.stderr)
    if refused or not found:
        raise RuntimeError("; ".join(refused) or run.stderr)
    return int(found[1])


def count(program: Path, effect: str, contender: str) -> float:
    """Count the instructions of one right-hand side of two links with the effect, or "none"."""
    scene: ChainScene = chain_scene(2, effect)
    prepare = f"prepare {contender} {described(scene)}"
    with_calls = executed(program, [prepare, f"make 0 {CALLS}", f"make 0 {2 * CALLS}"])
    without = executed(program, [prepare, f"make 0 {CALLS}", "make 0 0"])
    right_hand_sides = 2 * CALLS * (1 if contender == WAYS["call"] else 6)
    return (with_calls - without) / right_hand_sides


def count_effects(effects: list[str]) -> dict[str, dict[str, float]]:
    """Count a right-hand side with each effect, in both ways; stderr says why if that fails."""
    try:
        program, _ = programs()
    except NotCounted as reason:
        print(f"instructions are not counted: {reason}", file=sys.stderr)
        return {}
    bar = tqdm(effects, desc="instructions", unit="effect", disable=None)
    return {
        effect: {way: count(program, effect, name) for way, name in WAYS.items()} for effect in bar
    }


def count_bare() -> dict[str, float]:
    """Count the bare scene: as it is, by its kernel's type, and with one law more in the list."""
    try:
        program, longer = programs()
    except NotCounted:
        return {}
    return {
        "scene": count(program, "none", WAYS["step"]),
        "kernel": count(program, "none", KERNEL),
        "one_effect_more": count(longer, "none", WAYS["step"]),
    }


def main(effects: list[str]) -> int:
    names = effects or [effect.name for effect in EFFECTS if effect.ours]
    counted = count_effects([BARE.name, *names])
    bare = counted.get(BARE.name)
    if bare is None:
        return 1
    print(f"{'':24}{'call':>10}{'added':>8}{'step':>10}{'added':>8}")
    for name, one in counted.items():
        columns = "".join(f"{one[way]:10.1f}{one[way] - bare[way]:8.1f}" for way in WAYS)
        print(f"{name:24}{columns}")
    for name, found in count_bare().items():
        print(f"{'bare, ' + name:24}{found:28.1f}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
