"""`make elsewhere`: the C++ tests and the hashes of trajectories on other processors.

    python tests/elsewhere/elsewhere.py aarch64 wasm32 [--contracted] [--page PAGE]

Debian's cross compilers build the core and its C++ tests. QEMU runs them, or Node if they are
compiled to WebAssembly; `clang` is this machine with another compiler. A machine passes if its C++
tests pass, its fma agrees with whole numbers in ten million cases, and all its hashes are those of
tests/cpp/trajectory_hash.txt. A machine whose compiler or emulator is missing fails; none is
skipped, and test cases that are left out are named.

With --contracted, a build for ARM whose compiler may contract a * b + c is held against the same
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
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from tqdm import tqdm

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))

from page_part import rewrite

ROOT = Path(__file__).parents[2]
RECORDED = ROOT / "tests/cpp/trajectory_hash.txt"
TOOLCHAINS = ROOT / "cpp/cmake/machines"
FMA_CASES = 10_000_000
PROCESSORS = {"aarch64": "ARM, 64 bits", "riscv64": "RISC-V, 64 bits", "s390x": "IBM Z, big-endian"}
WEBASSEMBLY = "wasm32"
CLANG = "clang"
CONTRACTING = (
    "<CMAKE_CXX_COMPILER> <DEFINES> <INCLUDES> <FLAGS> -ffp-contract=fast -o <OBJECT> -c <SOURCE>"
)
"""How a source is compiled with contraction: the last of such flags counts."""
COUNTS_ALLOCATIONS = "the number of allocations*"
"""What this test case counts is the same on every machine, and emulated it takes minutes."""
CATCH = (
    "a low part is restored, and*",
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
    contracted: bool = False  # then nothing but hashes is looked at, and these must differ
    hashes: dict[str, str] = field(default_factory=dict)
    folder: Path = Path()
    wrong: str = ""
    seconds: float = 0.0

    def differing(self) -> list[str]:
        """Return the names of runs whose hashes are not the recorded ones, or are not there."""
        recorded = hashes_in(RECORDED.read_text())
        return [name for name, value in recorded.items() if self.hashes.get(name) != value]

    def is_right(self) -> bool:
        return not self.wrong and bool(self.differing()) == self.contracted

    def verdict(self) -> str:
        differing = self.differing()
        found = f"{len(differing)} DIFFER: {', '.join(differing)}" if differing else "all equal"
        return "FAILED" if self.wrong else found

    def build_there(self) -> None:
        try:
            self.folder = built(self.build, contracted=self.contracted)
        except (subprocess.CalledProcessError, OSError) as error:
            self.take(error)

    def run(self) -> None:
        began, folder = time.monotonic(), self.folder
        try:
            self.hashes = hashes_in(called(*self.runner, folder / "trajectory_hash"))
            if not self.contracted:
                called(*self.runner, folder / "check_fma", str(FMA_CASES))
                left_out = ",".join(name.replace(",", "\\,") for name in self.left_out)
                called(*self.runner, folder / "pendcore_tests", f"-tce={left_out}")
                if self.build != WEBASSEMBLY:  # which has no threads
                    called(*self.runner, folder / "pendcore_threads")
        except (subprocess.CalledProcessError, OSError) as error:
            self.take(error)
        self.seconds = time.monotonic() - began

    def take(self, error: Exception) -> None:
        self.wrong = f"{error}\n{getattr(error, 'stdout', '') or ''}".strip()


def machines_of(build: str) -> list[Machine]:
    """Return the machines that run what is built under that name."""
    if build in PROCESSORS:
        emulator = (f"qemu-{build}-static", "-L", f"/usr/{build}-linux-gnu")
        return [Machine(PROCESSORS[build], build, emulator)]
    if build == CLANG:
        return [Machine("x86-64, clang 22", build, ())]
    node = ("node", "--experimental-wasm-relaxed-simd", str(ROOT / "cpp/wasm/run.mjs"))
    left_out = (COUNTS_ALLOCATIONS, *CATCH)
    return [
        Machine("WebAssembly, fma by an instruction", build, node, left_out),
        Machine("WebAssembly, fma emulated", build, (*node, "--emulated"), left_out),
    ]


def hashes_in(text: str) -> dict[str, str]:
    return dict(re.findall(r"^(.+) ([0-9a-f]{16})$", text, re.MULTILINE))


@cache
def built(build: str, *, contracted: bool) -> Path:
    """Build what runs there, and return the folder; with contraction, the hashes alone.

    The core in WebAssembly is the one that `make page` compiles.
    """
    own = f"elsewhere/{build}-contracted" if contracted else f"elsewhere/{build}"
    folder = ROOT / "build" / ("wasm" if build == WEBASSEMBLY else own)
    targets = ["trajectory_hash"]
    if not contracted:
        targets += ["check_fma", "pendcore_tests"]
        targets += ["pendcore_wasm"] if build == WEBASSEMBLY else ["pendcore_threads"]
    compiler = ["-DCMAKE_CXX_COMPILER=clang++-22"]
    if build != CLANG:
        toolchain = TOOLCHAINS / ("wasm32.cmake" if build == WEBASSEMBLY else "debian.cmake")
        compiler = [f"-DCMAKE_TOOLCHAIN_FILE={toolchain}", f"-DMACHINE={build}"]
    if contracted:
        compiler += [f"-DCMAKE_CXX_COMPILE_OBJECT={CONTRACTING}"]
    called("cmake", "-G", "Ninja", "-B", folder, *compiler, "-DPENDCORE_TESTS=ON")
    called("cmake", "--build", folder, "--target", *targets)
    return folder / "tests/cpp"


def called(*command: str | os.PathLike[str]) -> str:
    """Return what a command prints."""
    return subprocess.run(
        [*map(str, command)], check=True, text=True, cwd=ROOT,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ).stdout  # fmt: skip


def table(machines: Sequence[Machine]) -> str:
    """Return the table of the page: a row for each run, a column for each machine."""
    titles = [f"{one.build} ({one.about})" for one in machines]
    lines = [f"| run | x86-64 | {' | '.join(titles)} |", "|---|---|" + "---|" * len(machines)]
    for name, value in hashes_in(RECORDED.read_text()).items():
        lines.append(f"| {name} | `{value}` | {' | '.join(['the same'] * len(machines))} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("builds", nargs="+", choices=(*PROCESSORS, WEBASSEMBLY, CLANG))
    parser.add_argument("--page", type=Path, help="the page that has the table")
    parser.add_argument("--contracted", action="store_true", help="try contraction as well")
    asked = parser.parse_args()
    if asked.page and set(asked.builds) != {*PROCESSORS, WEBASSEMBLY, CLANG}:
        parser.error("--page needs all machines: the table has a column for each")
    machines = [one for build in asked.builds for one in machines_of(build)]
    plain = list(machines)
    if asked.contracted:
        (arm,) = machines_of("aarch64")  # whose every processor has the instruction
        machines.append(replace(arm, about="ARM, contracted: must differ", contracted=True))
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # what is built runs beside the next build
        running = []
        for one in tqdm(machines, unit="machine", disable=None):
            one.build_there()
            if not one.wrong:
                running.append(pool.submit(one.run))
        for one_run in running:
            one_run.result()
    for one in machines:
        print(f"{one.build:10} {one.about:36} {one.verdict():12} {one.seconds:5.0f} s")
        if not one.contracted:
            print(f"           left out: {'; '.join(one.left_out)}")
        if one.wrong:
            print(one.wrong)
    fine = all(one.is_right() for one in machines)
    if asked.page and fine:
        rewrite(asked.page, elsewhere=table(plain))
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
