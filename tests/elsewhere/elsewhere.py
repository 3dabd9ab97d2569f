"""`make elsewhere`: the C++ tests and the hashes of trajectories on other processors.

    python tests/elsewhere/elsewhere.py aarch64 wasm32 [--contracted] [--page PAGE]

Debian's cross compilers build the core and its C++ tests. QEMU runs them, or Node if they are
compiled to WebAssembly; `clang` is this machine with another compiler. A machine passes if its C++
tests pass, its fma agrees with whole numbers in ten million cases, and all its hashes are those of
tests/cpp/trajectory_hash.txt. A machine whose compiler or emulator is missing fails; none is
skipped, and test cases that are left out are named.

With --contracted, a build in which the compiler may contract a * b + c is held against the same
hashes, which must differ: so the comparison is seen to work. A page has the table of all machines.
The exit status is 1 if anything is not as it must be.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from tqdm import tqdm

ROOT = Path(__file__).parents[2]
RECORDED = ROOT / "tests/cpp/trajectory_hash.txt"
TOOLCHAINS = ROOT / "cpp/cmake/machines"
BEGIN, END = "<!-- elsewhere: begin -->\n", "<!-- elsewhere: end -->"
FMA_CASES = 10_000_000
PROCESSORS = {"aarch64": "ARM, 64 bits", "riscv64": "RISC-V, 64 bits", "s390x": "IBM Z, big-endian"}
WEBASSEMBLY = "wasm32"
CLANG = "clang"
CONTRACTED = "aarch64"
"""The machine on which contraction is tried; every one of its processors has the instruction."""
COUNTS_ALLOCATIONS = "the number of allocations*"
"""What this test case counts is the same on every machine, and emulated it takes minutes."""
CATCH = (
    "a low part is restored, and*",
    "events that are out of range are refused*",
    "an exception in a callable*",
    "a number that is left out and*",
)
"""Test cases that catch an exception, which WebAssembly gives to JavaScript instead."""


@dataclass
class Machine:
    """Where the programs run, how, and what became of them."""

    about: str
    build: str
    runner: Sequence[str]
    left_out: Sequence[str] = (COUNTS_ALLOCATIONS,)
    has_threads: bool = True
    hashes: dict[str, str] = field(default_factory=dict)
    wrong: str = ""
    seconds: float = 0.0

    def differing(self) -> list[str]:
        """Return the names of runs whose hashes are not the recorded ones, or are not there."""
        recorded = hashes_in(RECORDED.read_text())
        return [name for name, value in recorded.items() if self.hashes.get(name) != value]


def machines_of(build: str) -> list[Machine]:
    """Return the machines that run what is built under that name."""
    if build in PROCESSORS:
        emulator = (f"qemu-{build}-static", "-L", f"/usr/{build}-linux-gnu")
        return [Machine(PROCESSORS[build], build, emulator)]
    if build == CLANG:
        return [Machine("x86-64, clang 22", build, ())]
    node = ("node", "--experimental-wasm-relaxed-simd", str(ROOT / "cpp/wasm/run.mjs"))
    return [
        Machine(about, build, runner, (COUNTS_ALLOCATIONS, *CATCH), has_threads=False)
        for about, runner in [
            ("WebAssembly, fma by an instruction", node),
            ("WebAssembly, fma emulated", (*node, "--emulated")),
        ]
    ]


def hashes_in(text: str) -> dict[str, str]:
    return dict(re.findall(r"^(.+) ([0-9a-f]{16})$", text, re.MULTILINE))


def built(build: str, contraction: str = "off") -> Path:
    """Build what runs there, and return the folder; with contraction, the hashes alone."""
    folder = ROOT / "build/elsewhere" / (build if contraction == "off" else f"{build}-contracted")
    targets = ["trajectory_hash"]
    if contraction == "off":
        targets += ["check_fma", "pendcore_tests"]
        targets += ["pendcore_wasm"] if build == WEBASSEMBLY else ["pendcore_threads"]
    if build == CLANG:
        compiler = ["-DCMAKE_CXX_COMPILER=clang++-22"]
    else:
        toolchain = TOOLCHAINS / ("wasm32.cmake" if build == WEBASSEMBLY else "debian.cmake")
        compiler = [f"-DCMAKE_TOOLCHAIN_FILE={toolchain}", f"-DMACHINE={build}"]
    called(
        "cmake", "-G", "Ninja", "-B", folder, *compiler,
        "-DPENDCORE_TESTS=ON", f"-DPENDCORE_CONTRACTION={contraction}",
    )  # fmt: skip
    called("cmake", "--build", folder, "--target", *targets)
    return folder / "tests/cpp"


def run_on(machine: Machine, folder: Path, *, hashes_alone: bool = False) -> None:
    """Run what was built."""
    began = time.monotonic()
    try:
        machine.hashes = hashes_in(called(*machine.runner, folder / "trajectory_hash"))
        if not hashes_alone:
            called(*machine.runner, folder / "check_fma", str(FMA_CASES))
            left_out = ",".join(name.replace(",", "\\,") for name in machine.left_out)
            called(*machine.runner, folder / "pendcore_tests", f"-tce={left_out}")
            if machine.has_threads:
                called(*machine.runner, folder / "pendcore_threads")
    except (subprocess.CalledProcessError, OSError) as error:
        machine.wrong = told(error)
    machine.seconds = time.monotonic() - began


def told(error: Exception) -> str:
    return f"{error}\n{getattr(error, 'stdout', '') or ''}".strip()


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


def run_all(builds: Sequence[str]) -> list[Machine]:
    """Build for one machine after the other; what is built runs beside the next build."""
    machines: list[Machine] = []
    running: list[Future[None]] = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for build in tqdm(builds, unit="build", disable=None):
            found = machines_of(build)
            machines += found
            try:
                folder = built(build)
            except (subprocess.CalledProcessError, OSError) as error:
                for one in found:
                    one.wrong = told(error)
            else:
                running += [pool.submit(run_on, one, folder) for one in found]
        for one_run in tqdm(running, unit="run", disable=None):
            one_run.result()
    return machines


def table(machines: Sequence[Machine]) -> str:
    """Return the table of the page: a row for each run, a column for each machine."""
    recorded = hashes_in(RECORDED.read_text())
    titles = [f"{one.build} ({one.about})" for one in machines]
    lines = [f"| run | x86-64 | {' | '.join(titles)} |", "|---|---|" + "---|" * len(machines)]
    for name, value in recorded.items():
        cells = [
            "the same" if one.hashes.get(name) == value else f"`{one.hashes.get(name, 'none')}`"
            for one in machines
        ]
        lines.append(f"| {name} | `{value}` | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def contraction_is_seen() -> bool:
    """Print and return whether hashes differ where the compiler may contract a * b + c."""
    (machine,) = machines_of(CONTRACTED)
    try:
        run_on(machine, built(CONTRACTED, contraction="fast"), hashes_alone=True)
    except (subprocess.CalledProcessError, OSError) as error:
        machine.wrong = told(error)
    caught = not machine.wrong and bool(machine.differing())
    how_many = f"{len(machine.differing())} of {len(machine.hashes)} hashes differ"
    print(f"with contraction, {CONTRACTED}: {how_many if caught else 'NOT SEEN'}")
    if machine.wrong:
        print(machine.wrong)
    return caught


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("builds", nargs="+", choices=(*PROCESSORS, WEBASSEMBLY, CLANG))
    parser.add_argument("--page", type=Path, help="the page that has the table")
    parser.add_argument("--contracted", action="store_true", help="try contraction as well")
    asked = parser.parse_args()
    if asked.page and set(asked.builds) != {*PROCESSORS, WEBASSEMBLY, CLANG}:
        parser.error("--page needs all machines: the table has a column for each")
    machines = run_all(asked.builds)
    for one in machines:
        print(f"{one.build:10} {one.about:36} {verdict(one):12} {one.seconds:5.0f} s")
        print(f"           left out: {'; '.join(one.left_out)}")
        if one.wrong:
            print(one.wrong)
    fine = not any(one.wrong or one.differing() for one in machines)
    if asked.contracted:
        fine &= contraction_is_seen()
    if asked.page and fine:
        before, _, rest = asked.page.read_text().partition(BEGIN)
        asked.page.write_text(before + BEGIN + table(machines) + END + rest.partition(END)[2])
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
