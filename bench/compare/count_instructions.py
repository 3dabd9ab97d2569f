"""Count the instructions of a right-hand side of two links, with each effect and without.

Valgrind's callgrind counts what the program of pendcore's contender executes with a number of
calls, and with none. The difference belongs to the calls; it is the same on every run and on every
machine that executes the same instructions. Valgrind does not know AVX-512, so the kernels for
x86-64-v3 are counted. A right-hand side is one call of pendcore::accelerations_in_force, or its
share of attempted steps of dopri5.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from contenders.programs import find_executable
from forward_dynamics import chain_scene
from record import Point
from tqdm import tqdm

CALL, STEP, KERNEL = "pendcore", "pendcore_step", "pendcore_kernel"
PROGRAM, ONE_EFFECT_MORE = "forward_dynamics_pendcore", "forward_dynamics_one_effect_more"
CALLS = 256
LONGEST_RUN = 60.0  # s; a run takes a third of a second


class NotCounted(Exception):
    """Raised, with the reason, if nothing can be counted."""


def programs() -> tuple[Path, Path]:
    """Find the program and the one with one effect more; NotCounted says what is missing."""
    if shutil.which("valgrind") is None:
        raise NotCounted("valgrind is missing (Debian: valgrind)")
    try:
        return find_executable(PROGRAM), find_executable(ONE_EFFECT_MORE)
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


def count(program: Path, effect: str, contender: str, calls: int = CALLS) -> float:
    """Count the instructions of a call on two links with the effect, or "none"; first warm up."""
    prepare = f"prepare {contender} {chain_scene(2, effect).described()}"
    begin = [prepare, f"make 0 {calls}"]
    more, less = (executed(program, [*begin, f"make 0 {n}"]) for n in (2 * calls, 0))
    return (more - less) / (2 * calls)


def count_right_hand_side(program: Path, effect: str, contender: str) -> float:
    return count(program, effect, contender) / (1 if contender == CALL else 6)


def rows_of(effects: Iterable[str]) -> list[Point]:
    """Count a right-hand side with each effect; stderr says why if that fails.

    The bare scene is counted twice more: by the kernel that is named by its type, which no effect
    can affect, and in a core that has one law more in its list.
    """
    try:
        program, longer = programs()
    except NotCounted as reason:
        print(f"instructions are not counted: {reason}", file=sys.stderr)
        return []
    asked = [(program, effect, who, who) for effect in effects for who in (CALL, STEP)]
    asked += [(program, "none", KERNEL, KERNEL), (longer, "none", STEP, "one_effect_more")]
    return [
        {"contender": named, "case": effect}
        | {"instructions": count_right_hand_side(which, effect, who)}
        for which, effect, who, named in tqdm(asked, desc="instructions", disable=None)
    ]
