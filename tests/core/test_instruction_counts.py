"""Absent effects cost nothing, present ones their arithmetic, by callgrind's instruction counts.

The counts are the same on every run. The tests are skipped where valgrind is missing, or where the
programs that `make build-bench` builds are missing or older than the core.
PENDCORE_FORWARD_DYNAMICS may name the folder of these programs.
"""

from __future__ import annotations

import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import count_instructions
from chain_scenes import chain_scene
from contenders.forward_dynamics import described
from effect_list import EFFECTS, Effect

pytestmark = pytest.mark.outside_build

CORE = Path(__file__).parents[2] / "cpp"
CPU_INFO = Path("/proc/cpuinfo")
SMOOTH = [effect for effect in EFFECTS if effect.most_instructions is not None]


@pytest.fixture(scope="module")
def programs() -> tuple[Path, Path]:
    """Return pendcore's program, and that of a core with one law more in its list."""
    if not CPU_INFO.exists() or "avx2" not in CPU_INFO.read_text():
        pytest.skip("the kernels that are counted, for x86-64-v3, do not run here")
    try:
        found = count_instructions.programs()
    except count_instructions.NotCounted as reason:
        pytest.skip(str(reason))
    sources = [path for path in CORE.rglob("*.?pp") if path.parent.name != "bindings"]
    newest = max(path.stat().st_mtime for path in sources)
    if min(path.stat().st_mtime for path in found) < newest:
        pytest.skip("the programs are older than the core: make build-bench")
    return found


@cache
def count(program: Path, effect: str, way: str) -> float:
    return count_instructions.count(program, effect, way)


def in_step(program: Path, effect: str) -> float:
    return count(program, effect, count_instructions.WAYS["step"])


def registered(program: Path) -> int:
    """Ask a program how many laws its core has in the list."""
    about = subprocess.run(
        [program], input="about pendcore\n", capture_output=True, text=True, check=True
    )
    (found,) = re.findall(r"(\d+) laws registered", about.stdout)
    return int(found)


def test_bare_scene_executes_the_kernel_that_knows_no_effect(programs: tuple[Path, Path]) -> None:
    program, _ = programs
    assert in_step(program, "none") == count(program, "none", count_instructions.KERNEL)


@pytest.mark.parametrize("way", count_instructions.WAYS.values())
def test_bare_scene_executes_no_instruction_for_one_law_more_in_the_list(
    way: str, programs: tuple[Path, Path]
) -> None:
    program, longer = programs
    assert registered(longer) == registered(program) + 1
    assert count(program, "none", way) == count(longer, "none", way)


def test_constants_of_the_mass_matrix_cost_nothing(programs: tuple[Path, Path]) -> None:
    assert in_step(programs[0], "none") == in_step(programs[0], "payload")


def test_dry_friction_that_slides_costs_one_torque(programs: tuple[Path, Path]) -> None:
    assert in_step(programs[0], "dry_joint_friction") == in_step(programs[0], "viscous_joint")


def test_a_stop_that_is_never_reached_costs_a_run_no_more_than_to_watch_it(
    programs: tuple[Path, Path],
) -> None:
    """The steps stay the same: the torques' kernel, a polynomial, and bounds of one angle."""

    def in_run(effect: str) -> float:
        requests = [f"prepare pendcore_run {described(chain_scene(2, effect))}", "make 0 3"]
        counts = [
            count_instructions.executed(programs[0], [*requests, f"make 0 {runs}"])
            for runs in (6, 0)
        ]
        return (counts[0] - counts[1]) / 6

    assert in_run("joint_limit") <= 1.75 * in_run("none")


@pytest.mark.parametrize("effect", ["viscous_joint", "torsional_spring", "rod_drag"])
def test_an_effect_with_coefficient_0_pays_that_effect_and_no_other(
    effect: str, programs: tuple[Path, Path]
) -> None:
    bare, nil, full = (in_step(programs[0], name) for name in ("none", f"{effect}_0", effect))
    assert bare < nil == full


@pytest.mark.parametrize("effect", SMOOTH, ids=lambda effect: effect.name)
def test_a_present_effect_adds_at_most_what_is_promised(
    effect: Effect, programs: tuple[Path, Path]
) -> None:
    assert effect.most_instructions is not None
    more = in_step(programs[0], effect.name) - in_step(programs[0], "none")
    assert more <= effect.most_instructions
