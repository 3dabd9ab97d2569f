"""Absent effects cost nothing, present ones their arithmetic, by callgrind's instruction counts.

The counts are the same on every run. The tests are skipped where valgrind is missing, or where the
programs that `make build-bench` builds are missing or older than the core.
FORWARD_DYNAMICS_PENDCORE and FORWARD_DYNAMICS_ONE_EFFECT_MORE may name these programs.
"""

from __future__ import annotations

import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

from count_instructions import (
    CALL,
    KERNEL,
    STEP,
    NotCounted,
    count,
    count_right_hand_side,
    programs,
)
from effect_list import EFFECTS

pytestmark = pytest.mark.outside_build

CORE = Path(__file__).parents[2] / "cpp"
CPU_INFO = Path("/proc/cpuinfo")
BOUNDS = {e.name: e.most_instructions for e in EFFECTS if e.most_instructions is not None}


@pytest.fixture(scope="module")
def built() -> tuple[Path, Path]:
    """Return pendcore's program, and that of a core with one law more in its list."""
    if not CPU_INFO.exists() or "avx2" not in CPU_INFO.read_text():
        pytest.skip("the kernels that are counted, for x86-64-v3, do not run here")
    try:
        found = programs()
    except NotCounted as reason:
        pytest.skip(str(reason))
    sources = [path for path in CORE.rglob("*.?pp") if path.parent.name != "bindings"]
    newest = max(path.stat().st_mtime for path in sources)
    if min(path.stat().st_mtime for path in found) < newest:
        pytest.skip("the programs are older than the core: make build-bench")
    return found


@pytest.fixture
def program(built: tuple[Path, Path]) -> Path:
    return built[0]


@cache
def in_step(program: Path, effect: str) -> float:
    return count_right_hand_side(program, effect, STEP)


def registered(program: Path) -> int:
    """Ask a program how many laws its core has in the list."""
    told = subprocess.check_output([program], input="about pendcore\n", text=True)
    (found,) = re.findall(r"(\d+) laws registered", told)
    return int(found)


def in_run(program: Path, effect: str) -> float:
    return count(program, effect, "pendcore_run", calls=3)


@pytest.mark.parametrize("way", [CALL, STEP])
def test_bare_scene_executes_no_instruction_for_one_law_more_in_the_list(way, built) -> None:
    program, longer = built
    assert registered(longer) == registered(program) + 1
    assert count(program, "none", way) == count(longer, "none", way)


def test_bare_scene_executes_the_kernel_that_knows_no_effect(program: Path) -> None:
    assert in_step(program, "none") == count_right_hand_side(program, "none", KERNEL)


def test_constants_of_the_mass_matrix_cost_nothing_and_friction_that_slides_one_torque(program):
    assert in_step(program, "payload") == in_step(program, "none")
    assert in_step(program, "dry_joint_friction") == in_step(program, "viscous_joint")


@pytest.mark.parametrize("effect", ["viscous_joint", "torsional_spring", "rod_drag"])
def test_an_effect_with_coefficient_0_pays_that_effect_and_no_other(effect, program: Path) -> None:
    assert in_step(program, "none") < in_step(program, f"{effect}_0") == in_step(program, effect)


@pytest.mark.parametrize("effect", BOUNDS)
def test_a_present_effect_adds_at_most_what_is_promised(effect: str, program: Path) -> None:
    assert in_step(program, effect) - in_step(program, "none") <= BOUNDS[effect]


def test_a_stop_that_is_never_reached_costs_a_run_no_more_than_to_watch_it(program: Path) -> None:
    """The steps stay the same: the torques' kernel, a polynomial, and bounds of one angle."""
    assert in_run(program, "joint_limit") <= 1.75 * in_run(program, "none")
