"""`make elsewhere`: the C++ tests and the hashes of trajectories on other processors.

    python tests/elsewhere/elsewhere.py aarch64 riscv64 s390x [--page docs/elsewhere.md]

Debian's cross compilers build the core and its C++ tests, and QEMU runs them, but for those that
count allocations. A machine passes if its C++ tests pass and all its hashes are those of
tests/cpp/trajectory_hash.txt. A machine whose compiler or emulator is missing fails; none is
skipped. Last, a build in which the compiler may contract a * b + c is held against the same hashes,
which must differ: so the comparison is seen to work. The exit status is 1 if anything is not as it
must be.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tqdm import tqdm

ROOT = Path(__file__).parents[2]
RECORDED = ROOT / "tests/cpp/trajectory_hash.txt"
TOOLCHAIN = ROOT / "cpp/cmake/machines/debian.cmake"
BEGIN, END = "<!-- elsewhere: begin -->\n", "<!-- elsewhere: end -->"
ABOUT = {
    "aarch64": "ARM, 64 bits",
    "riscv64": "RISC-V, 64 bits",
    "s390x": "IBM Z, big-endian",
}
NOT_THERE = "the number of allocations*"
"""The test cases that are left out: what they count is the same on every machine, and emulated they
take minutes."""
CONTRACTED = "aarch64"
"""The machine on which contraction is tried; every one of its processors has the instruction."""


@dataclass
class Machine:
    """What became of a machine: its hashes by the name of the run, and what went wrong."""

    name: str
    hashes: dict[str, str] = field(default_factory=dict)
    wrong: str = ""
    seconds: float = 0.0

    def differing(self) -> list[str]:
        """Return the names of runs whose hashes are not the recorded ones, or are not there."""
        recorded = hashes_in(RECORDED.read_text())
        return [name for name, value in recorded.items() if self.hashes.get(name) != value]


def hashes_in(text: str) -> dict[str, str]:
    return dict(line.rsplit(" ", 1) for line in text.splitlines())


def run_on(name: str, contraction: str = "off") -> Machine:
    """Build for a machine and run what was built; with contraction, the hashes alone."""
    began = time.monotonic()
    machine = Machine(name)
    folder = ROOT / "build/elsewhere" / (name if contraction == "off" else f"{name}-contracted")
    targets = ["trajectory_hash"]
    if contraction == "off":
        targets += ["pendcore_tests", "pendcore_threads"]
    try:
        called(
            "cmake", "-G", "Ninja", "-B", folder, f"-DMACHINE={name}", "-DPENDCORE_TESTS=ON",
            f"-DCMAKE_TOOLCHAIN_FILE={TOOLCHAIN}", f"-DPENDCORE_CONTRACTION={contraction}",
        )  # fmt: skip
        called("cmake", "--build", folder, "--target", *targets)
        emulator = [f"qemu-{name}-static", "-L", f"/usr/{name}-linux-gnu"]
        machine.hashes = hashes_in(called(*emulator, folder / "tests/cpp/trajectory_hash"))
        if contraction == "off":
            called(*emulator, folder / "tests/cpp/pendcore_tests", f"-tce={NOT_THERE}")
            called(*emulator, folder / "tests/cpp/pendcore_threads")
    except (subprocess.CalledProcessError, OSError) as error:
        machine.wrong = f"{error}\n{getattr(error, 'stdout', '') or ''}".strip()
    machine.seconds = time.monotonic() - began
    return machine


def called(*command: str | os.PathLike[str]) -> str:
    """Return what a command prints."""
    return subprocess.run(
        [*map(str, command)], check=True, text=True, cwd=ROOT,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ).stdout  # fmt: skip


def verdict(machine: Machine) -> str:
    if machine.wrong:
        return "FAILED"
    differing = machine.differing()
    return f"{len(differing)} DIFFER: {', '.join(differing)}" if differing else "all equal"


def table(machines: Sequence[Machine]) -> str:
    """Return the table of the page: a row for each run, a column for each machine."""
    recorded = hashes_in(RECORDED.read_text())
    titles = [f"{one.name} ({ABOUT[one.name]})" for one in machines]
    lines = [f"| run | x86-64 | {' | '.join(titles)} |", "|---|---|" + "---|" * len(machines)]
    for name, value in recorded.items():
        cells = [
            "the same" if one.hashes.get(name) == value else f"`{one.hashes.get(name, 'none')}`"
            for one in machines
        ]
        lines.append(f"| {name} | `{value}` | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("machines", nargs="+", choices=ABOUT)
    parser.add_argument("--page", type=Path, help="the page that has the table")
    parser.add_argument("--contracted", action="store_true", help="try contraction as well")
    asked = parser.parse_args()
    machines = [run_on(name) for name in tqdm(asked.machines, unit="machine", disable=None)]
    for one in machines:
        print(f"{one.name:10} {ABOUT[one.name]:20} {verdict(one):12} {one.seconds:5.0f} s")
        if one.wrong:
            print(one.wrong)
    fine = not any(one.wrong or one.differing() for one in machines)
    if asked.contracted:
        contracted = run_on(CONTRACTED, contraction="fast")
        caught = not contracted.wrong and bool(contracted.differing())
        how_many = f"{len(contracted.differing())} of {len(contracted.hashes)} hashes differ"
        print(f"with contraction, {CONTRACTED}: {how_many if caught else 'NOT SEEN'}")
        if contracted.wrong:
            print(contracted.wrong)
        fine &= caught
    if asked.page and fine:
        before, _, rest = asked.page.read_text().partition(BEGIN)
        asked.page.write_text(before + BEGIN + table(machines) + END + rest.partition(END)[2])
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
