"""Where mutants are built and tested: a clone, its core, and packages beside the installed one."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType

import pybind11

from mutants import coverage_of_tests as coverage
from mutants import switched as switches
from mutants.mutation import Mutant
from mutants.related import related_first
from mutants.server import NOT_ENDED

ROOT = Path(__file__).parents[2]
PLACE = ROOT / "build/mutants"
SOURCE, BUILD, SITE = PLACE / "source", PLACE / "core", PLACE / "site"
SERVER = Path(__file__).with_name("server.py")
TESTS_OF_LINES = PLACE / "tests_of_lines.json"
KINDS = ("not outside_build", "outside_build")
"""The tests that build something outside the project come last."""
SPEAK_OF_IT = 10
"""So many files of tests are asked of each mutant of the package, whatever lines they run."""
ASKED_OF_CORE = 25
"""So many files of tests, those that speak most of it, are asked of a mutant of the core."""
SILENT = 90.0
"""A test that takes so long has lost its way, s."""
NOTICED_IN = 240.0
"""A mutant of the package that its tests have not noticed by then counts as alive, s."""
PATIENCE = 1800.0
"""No build and no run of all tests takes so long, s."""

PYTEST = [
    "-q", "-x", "-p", "no:cacheprovider", "--hypothesis-seed=0",
    "-o", f"faulthandler_timeout={SILENT:g}", "-o", "faulthandler_exit_on_timeout=true",
]  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant (killed, alive, no program, the same program), by which test."""

    what: str
    by: str = ""


class Workshop:
    """A clone of a commit, its core built, its package without a mistake.

    The given mutants of the core, by number, are compiled into it; `in_build` has those that could
    be.
    """

    def __init__(self, commit: str, mutants: Mapping[int, Mutant] = MappingProxyType({})) -> None:
        self.commit = commit
        self.in_build = dict(mutants)
        self.environment = os.environ | {
            "PYTHONPATH": str(SITE), "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1",
            "PYTEST_DEBUG_TEMPROOT": str(PLACE),  # others' runs of pytest clean up there
        }  # fmt: skip
        if not (SOURCE / ".git").exists():
            shutil.rmtree(PLACE, ignore_errors=True)
            run(["git", "clone", "--quiet", ROOT, SOURCE])
        run(["git", "-C", SOURCE, "fetch", "--quiet"])
        if not mutants or self.output("rev-parse", "HEAD").decode().strip() != commit:
            run(["git", "-C", SOURCE, "checkout", "--quiet", "--force", commit])
        run([
            "cmake", "-G", "Ninja", "-S", SOURCE, "-B", BUILD, "-DCMAKE_BUILD_TYPE=Release",
            "-DPENDCORE_PYTHON=ON", "-DPENDCORE_TESTS=ON", f"-DPython_EXECUTABLE={sys.executable}",
            f"-Dpybind11_DIR={pybind11.get_cmake_dir()}", f"-DCMAKE_CXX_FLAGS={self.flags()}",
        ])  # fmt: skip
        if not (self.built_with_switches() if mutants else self.built("all", "tests/cpp/all")):
            raise SystemExit(f"{commit} does not build: cmake --build {BUILD} says why")
        shutil.rmtree(SITE, ignore_errors=True)
        shutil.copytree(SOURCE / "python/pendcore", SITE / "pendcore")
        self.installed()
        self.core = self.bytes_of_core()
        self.tests_of_lines: coverage.TestsOfLines = {}

    def flags(self) -> str:
        """Return what the compiler is told, so that mutants can be switched."""
        if not self.in_build:
            return ""
        header = PLACE / "switches.hpp"
        if not header.exists() or header.read_text() != switches.HEADER:
            header.write_text(switches.HEADER)  # all is compiled anew
        return f"-include {header} -w"

    def built_with_switches(self) -> bool:
        """Build all mutants at once; those go that do not compile so, and are remembered."""
        changed = self.output("diff", "--name-only").decode().split()
        paths = {*changed, *(m.path for m in self.in_build.values())}
        right = {path: self.output("show", f"{self.commit}:{path}") for path in paths}
        drawn = sha256(repr(self.in_build).encode()).hexdigest()[:8]
        known = PLACE / f"not_switched.{drawn}.json"
        out = set(json.loads(known.read_text())) if known.exists() else set()
        while True:
            self.in_build = {n: m for n, m in self.in_build.items() if n not in out}
            for path, source in right.items():
                there = {n: m for n, m in self.in_build.items() if m.path == path}
                wrong = switches.with_switches(path, source, there)
                if (SOURCE / path).read_bytes() != wrong:
                    (SOURCE / path).write_bytes(wrong)
            command = ["cmake", "--build", BUILD, "--target", "all", "tests/cpp/all"]
            code, said = self.call([*command, "--", "-k", "0"])
            if not code:
                return True
            bad = switches.not_compiled(said, SOURCE, self.in_build)
            if not bad:
                return False
            out |= bad
            known.write_text(json.dumps(sorted(out)))

    def unswitched(self) -> Outcome:
        """Run the tests of the core with no mutant switched on."""
        outcome = self.asked_of_ctest()
        return outcome if outcome.by else self.asked_of_tests(without_documents(""), KINDS[:1])

    def measured(self) -> Outcome:
        """Run all tests without a mistake; learn which of them run a line of the package."""
        known = TESTS_OF_LINES.with_suffix(f".{self.commit}.json")
        if not known.exists():
            data = PLACE / "coverage/data"
            shutil.rmtree(data.parent, ignore_errors=True)
            data.parent.mkdir()
            settings = data.with_name("settings.ini")
            settings.write_text(coverage.SETTINGS.format(data=data, source=SITE / "pendcore"))
            measuring = ["--cov", "--cov-context=test", "--cov-append", "--cov-report="]
            outcome = self.asked_of_tests(
                related_first(SOURCE, ""), more=[*measuring, f"--cov-config={settings}"]
            )
            if outcome.what != "alive":
                return outcome
            coverage.saved(coverage.told(data, SITE), known)
        self.tests_of_lines = coverage.loaded(known)
        return Outcome("alive")

    def tested(self, mutant: Mutant) -> Outcome:
        """Return what becomes of a mutant of the core; those tests run first that speak of it."""
        file = SOURCE / mutant.path
        right = file.read_bytes()
        file.write_bytes(mutant.applied(right))
        try:
            if not self.built("tests/cpp/all"):
                return Outcome("no program")
            if (outcome := self.asked_of_ctest()).what == "killed":
                return outcome
            if not self.built("all"):
                return Outcome("no program")
            file.write_bytes(right)  # tests that build anew build what is right
            self.installed()
            if self.bytes_of_core() == self.core:
                return Outcome("same program")
            return self.asked_of_tests(related_first(SOURCE, mutant.path))
        finally:
            file.write_bytes(right)

    def those_that_run(self, mutant: Mutant) -> list[str]:
        """Return the tests that run the line of a mutant of the package, and files to run whole.

        A line that runs in a process of its own may be run by any test that starts one. What a line
        returned may be kept, and be used by tests that do not run it: the files that speak most of
        it are asked, too.
        """
        source = (SOURCE / mutant.path).read_text()
        path = mutant.path.removeprefix("python/")
        tests = coverage.tests_that_run(self.tests_of_lines, path, source, mutant.line)
        files = related_first(SOURCE, mutant.path)
        tests += files[:SPEAK_OF_IT]
        if coverage.OUTSIDE in tests:
            tests += [file for file in files if "subprocess" in (SOURCE / file).read_text()]
        return [test for test in tests if test != coverage.OUTSIDE]

    def output(self, *words: str) -> bytes:
        """Return what git says of the clone."""
        return subprocess.check_output(["git", *words], cwd=SOURCE)

    def built(self, *targets: str) -> bool:
        return self.call(["cmake", "--build", BUILD, "--target", *targets])[0] == 0

    def installed(self) -> None:
        run(["cmake", "--install", BUILD, "--prefix", SITE / "pendcore"])

    def bytes_of_core(self) -> str:
        (core,) = (SITE / "pendcore").glob("_core*.so")
        return sha256(core.read_bytes()).hexdigest()

    def asked_of_ctest(self, number: int = 0) -> Outcome:
        """Run the C++ tests; the hash of trajectories is quick, and sees most."""
        ctest = ["ctest", "--test-dir", BUILD, "--stop-on-failure", "--timeout", "120"]
        for chosen in ("-R", "-E"):
            code, said = self.call([*ctest, chosen, "trajectory_hash"], number)
            if code:
                return Outcome("killed", first(r"\d+ - (\S+) \(", said) or "ctest")
        return Outcome("alive")

    def asked_of_tests(
        self, tests: list[str], kinds: Sequence[str] = KINDS, more: Sequence[str] = ()
    ) -> Outcome:
        """Run tests of `make test` in an order until one fails."""
        pytest = [
            sys.executable,
            "-m",
            "pytest",
            *PYTEST,
            "-n",
            "auto",
            "--maxschedchunk",
            "8",
            *more,
        ]
        names = PLACE / "tests.txt"  # they may be more than a command takes
        names.write_text("\n".join(tests))
        for chosen in kinds:
            code, said = self.call([*pytest, "-m", chosen, f"@{names}"])
            if code not in (0, 5):  # 5: no test is chosen
                return Outcome("killed", first(r"^(?:FAILED|ERROR) (\S+)", said) or last_line(said))
        return Outcome("alive")

    def call(self, command: list[object], number: int = 0) -> tuple[int, str]:
        """Return how a command ended, and what it said; all that it started ends with it."""
        environment = self.environment | {switches.VARIABLE: str(number)}
        process = subprocess.Popen(
            [*map(str, command)], cwd=SOURCE, env=environment, text=True, errors="replace",
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            said, _ = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return 1, f"{process.communicate()[0]}\nlonger than {PATIENCE:g} s"
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
        return process.returncode, said


class Place:
    """A package of its own, in which one mutant at a time is tested, beside others."""

    def __init__(self, workshop: Workshop, number: int) -> None:
        self.workshop, self.folder = workshop, PLACE / f"place-{number}"
        self.site = self.folder / "site"
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(SITE, self.site)
        environment = workshop.environment | {"PYTEST_DEBUG_TEMPROOT": str(self.folder)}
        self.server = subprocess.Popen(
            [sys.executable, SERVER], cwd=SOURCE, env=environment, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip

    def tested_in_build(self, number: int, mutant: Mutant) -> Outcome:
        """Return what becomes of a mutant of the core that is in the build."""
        right = self.workshop.output("show", f"{self.workshop.commit}:{mutant.path}")
        if number not in self.workshop.in_build or switches.is_constant(right, mutant):
            return Outcome("not switched")
        if (outcome := self.workshop.asked_of_ctest(number)).what == "killed":
            return outcome
        files = without_documents(mutant.path)
        environment = {switches.VARIABLE: str(number)}
        return self.outcome(*self.run(files[:ASKED_OF_CORE], environment))

    def tested(self, mutant: Mutant) -> Outcome:
        """Return what becomes of a mutant of the package."""
        file = self.site / mutant.path.removeprefix("python/")
        right = file.read_bytes()
        wrong = mutant.applied(right)
        if not compiles(wrong):
            return Outcome("no program")
        file.write_bytes(wrong)
        try:
            code, said = self.run(self.workshop.those_that_run(mutant))
        finally:
            file.write_bytes(right)
        return self.outcome(code, said)

    def outcome(self, code: int, said: str) -> Outcome:
        """Return what a run of pytest says of a mutant."""
        if code in (0, 5, NOT_ENDED):  # 5: no test is chosen
            return Outcome("alive")
        failed = r"^(?:FAILED|ERROR|ImportError while loading) (\S+)"
        by = first(failed, said) or first(r"(Timeout .*|Fatal Python error.*)", said)
        if not by:
            raise RuntimeError(f"pytest did not run: {said[-1000:]}")
        return Outcome("killed", by)

    def run(
        self, tests: list[str], environment: Mapping[str, str] = MappingProxyType({})
    ) -> tuple[int, str]:
        """Return how pytest ended with these tests, and what it said."""
        output = self.folder / "output.txt"
        order = {
            "site": str(self.site), "tests": tests, "output": str(output), "patience": NOTICED_IN,
            "seconds": str(self.folder.with_suffix(".json")), "environment": dict(environment),
            "arguments": [*PYTEST, "-m", KINDS[0], *sorted({t.partition("::")[0] for t in tests})],
        }  # fmt: skip
        if not tests:
            return 5, ""
        assert self.server.stdin is not None
        assert self.server.stdout is not None
        print(json.dumps(order), file=self.server.stdin, flush=True)
        code = int(self.server.stdout.readline())
        return code, output.read_text(errors="replace")


def without_documents(path: str) -> list[str]:
    """Return the tests that do not read the sources, which have all mutants in them."""
    return [file for file in related_first(SOURCE, path) if "/documents/" not in file]


def compiles(source: bytes) -> bool:
    try:
        compile(source, "mutant", "exec")
    except SyntaxError:
        return False
    return True


def run(command: list[object]) -> None:
    subprocess.run([*map(str, command)], check=True, stdout=subprocess.DEVNULL)


def first(pattern: str, said: str) -> str:
    found = re.search(pattern, said, re.MULTILINE)
    return found[1] if found else ""


def last_line(said: str) -> str:
    return said.strip().rpartition("\n")[2][:200]
