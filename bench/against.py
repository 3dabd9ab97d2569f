"""Is one commit slower than another? Builds both and times the same calls of both in turns.

    python bench/against.py OLD [NEW] [--only WORDS ...]
                            [--processes 8] [--rounds 30] [--seconds 300]

Both are built with the packages of this Python's environment and run in it, so nothing but
pendcore differs; builds are kept in build/against. What is not committed is not built.

Where memory happens to lie makes a process fast or slow for as long as it lives: for ensembles, by
up to 1.4. So the calls are timed in several pairs of fresh processes, one of each commit, and a
process counts by the least time that it took for a call. The table has the least time of each call
over all processes of a commit, the ratio of these, the ratio of the processes' medians, and between
which ratios half of the pairs lie: with OLD twice, that is the noise of the machine. A call that a
commit lacks has a "-". The exit status is 1 where by both ratios a call is slower by more than 5 %.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from timed_calls import prepared_calls

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "build" / "against"
FELT = 1.05
LEAST_TURNS = 2
BURST_SECONDS = 0.02
PIP_INSTALL = ["pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
# A compiler's cache would hide what a build costs.
UNCACHED = {"CMAKE_CXX_COMPILER_LAUNCHER": "", "CCACHE_DISABLE": "1"}


@dataclass(frozen=True, slots=True)
class Build:
    commit: str
    folder: Path  # what pip installed
    processor_seconds: float


@dataclass(frozen=True, slots=True)
class Comparison:
    """A call's least times in the processes of both commits; none where one lacks the call."""

    name: str
    old: list[float]
    new: list[float]

    @property
    def ratio(self) -> float:
        return min(self.new) / min(self.old)

    @property
    def median(self) -> float:
        return statistics.median(self.new) / statistics.median(self.old)

    @property
    def is_slower(self) -> bool:
        """One ratio alone may be chance: disturbed processes, or one that was lucky."""
        return bool(self.old and self.new) and min(self.ratio, self.median) > FELT

    def __str__(self) -> str:
        times = " ".join(
            f"{min(side):12.2f}" if side else f"{'-':>12}" for side in (self.old, self.new)
        )
        line = f"{self.name:36} {times}"
        if not (self.old and self.new):
            return line
        line += f" {self.ratio:7.3f} {self.median:7.3f}"
        if len(self.old) > 1:
            pairs = [new / old for old, new in zip(self.old, self.new, strict=True)]
            low, _, high = statistics.quantiles(pairs, n=4, method="inclusive")
            line += f"  {low:.3f} to {high:.3f}"
        return line + (" slower" if self.is_slower else "")


def git(*arguments: str) -> str:
    return subprocess.check_output(["git", *arguments], cwd=ROOT, text=True).strip()


def build(revision: str) -> Build:
    """Return the build of a commit, which is made now if none is kept."""
    commit = git("rev-parse", "--short=10", f"{revision}^{{commit}}")
    home = KEPT / f"{commit}-{sys.implementation.cache_tag}"
    if not home.exists():
        print(f"building {commit}: some four minutes of one processor", file=sys.stderr)
        begun = home.with_suffix(".begun")
        shutil.rmtree(begun, ignore_errors=True)
        source = begun / "source"
        source.mkdir(parents=True)
        git("archive", f"--output={source / 'archive.tar'}", commit)
        shutil.unpack_archive(source / "archive.tar", source)
        before = processor_seconds()
        places = ["--target", str(begun / "installed"), str(source)]
        command = [sys.executable, "-m", *PIP_INSTALL, *places]
        if subprocess.run(command, env={**os.environ, **UNCACHED}).returncode:
            raise SystemExit(f"{commit} does not build with the packages of {sys.prefix}")
        (begun / "processor_seconds").write_text(f"{processor_seconds() - before:.1f}")
        shutil.rmtree(source)
        begun.rename(home)
    seconds = float((home / "processor_seconds").read_text())
    return Build(commit, home / "installed", seconds)


def processor_seconds() -> float:
    """Return what all programs that ended have taken, in seconds of one processor."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Worker:
    """Times calls of one build, in a process of its own."""

    def __init__(self, built: Build) -> None:
        self.built = built
        self.process = subprocess.Popen(
            [sys.executable, ROOT / "bench" / "timed_calls.py"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(built.folder)},
        )
        loaded = self.answer()
        if not Path(loaded).is_relative_to(built.folder):
            self.close()
            raise SystemExit(f"{built.commit}: the worker loads {loaded or 'nothing'}")

    def close(self) -> None:
        self.process.communicate()

    def answer(self) -> str:
        assert self.process.stdout
        return self.process.stdout.readline().strip()

    def microseconds(self, name: str, seconds: float) -> float | None:
        """Return a call's least time, or None where the build lacks the call."""
        assert self.process.stdin
        print(json.dumps([name, seconds]), file=self.process.stdin, flush=True)
        answer = self.answer()
        if not answer:
            raise SystemExit(f"{self.built.commit}: the worker ended in {name!r}")
        if answer.startswith("-"):
            print(f"{self.built.commit} has no {name!r}: {answer[2:]}", file=sys.stderr)
            return None
        return 1e6 * float(answer)


def in_turns(one: Comparison, old: Worker, new: Worker, rounds: int, seconds: float) -> None:
    """Time a call in two processes, each first in every other turn, until `seconds` are spent."""
    times: dict[Worker, list[float]] = {old: [], new: []}
    end = time.perf_counter() + seconds
    for turn in range(rounds):
        if turn >= LEAST_TURNS and time.perf_counter() > end:
            break
        for worker in (old, new) if turn % 2 else (new, old):
            found = worker.microseconds(one.name, BURST_SECONDS)
            if found is not None:
                times[worker].append(found)
        if not (times[old] and times[new]):
            break
    for side, worker in ((one.old, old), (one.new, new)):
        if times[worker]:
            side.append(min(times[worker]))


def in_pairs_of_processes(
    names: Sequence[str], old: Build, new: Build, processes: int, rounds: int, seconds: float
) -> list[Comparison]:
    """Time all calls in one pair of fresh processes after the other."""
    compared = [Comparison(name, [], []) for name in names]
    for pair in range(processes):
        print(f"processes {pair + 1} of {processes}", file=sys.stderr)
        with closing(Worker(old)) as first, closing(Worker(new)) as second:
            for one in compared:
                if pair == 0 or (one.old and one.new):
                    share = seconds / processes / len(names)
                    in_turns(one, first, second, math.ceil(rounds / processes), share)
    return compared


def chosen(words: Sequence[str]) -> list[str]:
    names = list(prepared_calls())
    found = [name for name in names if not words or any(word in name for word in words)]
    if not found:
        raise SystemExit(f"no call has {' or '.join(words)} in its name: {', '.join(names)}")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("old", metavar="OLD", help="a commit")
    parser.add_argument("new", metavar="NEW", nargs="?", default="HEAD", help="another: HEAD")
    parser.add_argument("--only", metavar="WORDS", nargs="+", default=[], help="calls with these")
    parser.add_argument("--processes", type=int, default=8, help="of each commit: 8")
    parser.add_argument("--rounds", type=int, default=30, help="turns of each call, in all: 30")
    parser.add_argument("--seconds", type=float, default=300.0, help="for all the timing: 300")
    given = parser.parse_args()
    names = chosen(given.only)
    old, new = build(given.old), build(given.new)
    build_times = ([one.processor_seconds] for one in (old, new))
    calls = in_pairs_of_processes(names, old, new, given.processes, given.rounds, given.seconds)
    compared = [Comparison("build, processor seconds", *build_times), *calls]
    print(
        f"{'microseconds':36} {old.commit:>12} {new.commit:>12}   ratio  median  half of the pairs"
    )
    print(*compared, sep="\n")
    slower = [one.name for one in compared if one.is_slower]
    medians = [one.median for one in calls if one.old and one.new]
    if medians:
        print(
            f"{len(medians)} calls: the median of their medians is {statistics.median(medians):.3f}"
        )
    lost = [one.name for one in compared if one.old and not one.new]
    print(f"slower by more than 5 %: {', '.join(slower) or 'none'}")
    if lost:
        print(f"calls that {new.commit} no longer has: {', '.join(lost)}")
    return bool(slower or lost)


if __name__ == "__main__":
    sys.exit(main())
