"""Where mutants are built and tested: a clone, its core, and a package beside the installed one."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import pybind11

from mutants import which_tests as which
from mutants.mutation import Mutant

ROOT = Path(__file__).parents[2]
PLACE = ROOT / "build/mutants"
SOURCE, BUILD, SITE = PLACE / "source", PLACE / "core", PLACE / "site"
KINDS = ("not outside_build", "outside_build")
"""The tests that build something outside the project come last."""
SILENT = 180.0
"""A test that takes so long has lost its way, s."""
PATIENCE = 1800.0
"""No build and no run of all tests takes so long, s."""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant (killed, alive, no program, the same program), by which test."""

    what: str
    by: str = ""


class Workshop:
    """A clone of a commit, its core built, its package without a mistake."""

    def __init__(self, commit: str) -> None:
        self.commit = commit
        self.environment = os.environ | {"PYTHONPATH": str(SITE), "MPLBACKEND": "Agg"}
        if not (SOURCE / ".git").exists():
            shutil.rmtree(PLACE, ignore_errors=True)
            run(["git", "clone", "--quiet", ROOT, SOURCE])
        run(["git", "-C", SOURCE, "fetch", "--quiet"])
        run(["git", "-C", SOURCE, "checkout", "--quiet", "--force", commit])
        run([
            "cmake", "-G", "Ninja", "-S", SOURCE, "-B", BUILD, "-DCMAKE_BUILD_TYPE=Release",
            "-DPENDCORE_PYTHON=ON", "-DPENDCORE_TESTS=ON", f"-DPython_EXECUTABLE={sys.executable}",
            f"-Dpybind11_DIR={pybind11.get_cmake_dir()}",
        ])  # fmt: skip
        if not self.built():
            raise SystemExit(f"{commit} does not build: cmake --build {BUILD} says why")
        shutil.rmtree(SITE, ignore_errors=True)
        shutil.copytree(SOURCE / "python/pendcore", SITE / "pendcore")
        self.installed()
        self.core = self.bytes_of_core()
        self.contexts: dict[str, which.Contexts] = {}

    def measured(self) -> Outcome:
        """Run all tests without a mistake, and learn which of them run a line of the package."""
        known = PLACE / f"coverage.{self.commit}.json"
        if not known.exists():
            data = PLACE / "coverage/data"
            shutil.rmtree(data.parent, ignore_errors=True)
            data.parent.mkdir()
            settings = data.with_name("settings.ini")
            settings.write_text(which.SETTINGS.format(data=data, source=SITE / "pendcore"))
            report = data.with_name("report.json")
            measuring = ["--cov", "--cov-context=test", "--cov-append"]
            measuring += [f"--cov-report=json:{report}", f"--cov-config={settings}"]
            outcome = self.asked_of_tests(which.related_first(SOURCE, ""), more=measuring)
            if outcome.what != "alive":
                return outcome
            report.rename(known)
        self.contexts = which.told(known)
        return Outcome("alive")

    def tested(self, mutant: Mutant) -> Outcome:
        """Return what becomes of a mutant; those tests run first that speak of its file."""
        tests, kinds = which.related_first(SOURCE, mutant.path), KINDS
        file = SOURCE / mutant.path
        right = file.read_bytes()
        wrong = mutant.applied(right)
        if mutant.path.endswith(".py"):
            file = SITE / mutant.path.removeprefix("python/")
            if not compiles(wrong):
                return Outcome("no program")
            contexts = self.contexts.get(str(file), {})
            if known := those_that_run(contexts, mutant.line, right.decode(), tests):
                tests, kinds = known, KINDS[:1]  # what is built outside is the core
        file.write_bytes(wrong)
        try:
            if mutant.path.endswith(".py"):
                return self.asked_of_tests(tests, kinds)
            if not self.built():
                return Outcome("no program")
            file.write_bytes(right)  # tests that build anew build what is right
            self.installed()
            if self.bytes_of_core() == self.core:
                return Outcome("same program")
            outcome = self.asked_of_ctest()
            return outcome if outcome.what == "killed" else self.asked_of_tests(tests)
        finally:
            file.write_bytes(right)

    def built(self) -> bool:
        targets = ["all", "tests/cpp/all"]
        return self.call(["cmake", "--build", BUILD, "--target", *targets])[0] == 0

    def installed(self) -> None:
        run(["cmake", "--install", BUILD, "--prefix", SITE / "pendcore"])

    def bytes_of_core(self) -> str:
        (core,) = (SITE / "pendcore").glob("_core*.so")
        return sha256(core.read_bytes()).hexdigest()

    def asked_of_ctest(self) -> Outcome:
        code, said = self.call(
            ["ctest", "--test-dir", BUILD, "--stop-on-failure", "--timeout", "300"]
        )
        if code:
            return Outcome("killed", first(r"\d+ - (\S+) \(", said) or "ctest")
        return Outcome("alive")

    def asked_of_tests(
        self, tests: list[str], kinds: Sequence[str] = KINDS, more: Sequence[str] = ()
    ) -> Outcome:
        """Run tests of `make test` in an order until one fails."""
        pytest = [
            sys.executable, "-m", "pytest", "-q", "-x", "-n", "auto", "--maxschedchunk", "8",
            "-p", "no:cacheprovider", "-o", f"faulthandler_timeout={SILENT:g}",
            "-o", "faulthandler_exit_on_timeout=true", "--hypothesis-seed=0", *more,
        ]  # fmt: skip
        names = PLACE / "tests.txt"  # they may be more than a command takes
        names.write_text("\n".join(tests))
        for chosen in kinds:
            code, said = self.call([*pytest, "-m", chosen, f"@{names}"])
            if code not in (0, 5):  # 5: no test is chosen
                return Outcome("killed", first(r"^(?:FAILED|ERROR) (\S+)", said) or last_line(said))
        return Outcome("alive")

    def call(self, command: list[object]) -> tuple[int, str]:
        """Return how a command ended, and what it said; all that it started ends with it."""
        process = subprocess.Popen(
            [*map(str, command)], cwd=SOURCE, env=self.environment, text=True, errors="replace",
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


def those_that_run(contexts: which.Contexts, line: int, source: str, files: list[str]) -> list[str]:
    """Return the tests that run a line, or may in a process of their own.

    There are none where it runs outside tests alone.
    """
    tests = which.tests_that_run(contexts, source, line)
    if not tests:
        return []
    tests += [file for file in files if "subprocess" in (SOURCE / file).read_text()]
    place = {file: i for i, file in enumerate(files)}
    return sorted(tests, key=lambda test: place.get(test.partition("::")[0], len(place)))


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
