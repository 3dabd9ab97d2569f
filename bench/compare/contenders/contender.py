"""What a contender is: it prepares runs of a case at a tolerance, to be timed and looked at.

To add one: a file beside this with a list `CONTENDERS`, and its name in the list of `__init__.py`.
A C++ contender is a .cpp file and a line in `solves.cpp`; `compiled.py` then finds it.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from cases import Array, Case

Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True)
class Outcome:
    """States (n_t, 2n) at the case's times, and the right-hand sides they took (None: unknown)."""

    states: Array
    evaluations: int | None


class Run(Protocol):
    """A case at a tolerance, everything built that can be built beforehand."""

    def burst(self, seconds: float) -> list[float]:
        """Call for about so long and list each call's seconds; a first of several only warms up."""

    def outcome(self) -> Outcome: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Contender:
    """`about` says version and settings; `prepare` raises Unsupported for a case it cannot carry.

    `compile_seconds` is what a user waits, once a process, before the first solve; None where
    nothing is compiled then.
    """

    name: str
    label: str
    about: str
    prepare: Callable[[Case, float], Run]
    compile_seconds: float | None = None


class Unsupported(Exception):
    """Raised by a contender that does not carry the case."""


def compiled(build: Callable[[], Answer]) -> tuple[Answer, float]:
    """Build, and count the seconds it takes."""
    begin = time.perf_counter()
    return build(), time.perf_counter() - begin


@dataclass(frozen=True, slots=True)
class PythonRun(Generic[Answer]):
    """A run in this process: `solve` is timed and ends with the states in hand; `read` looks."""

    solve: Callable[[], Answer]
    read: Callable[[Answer], Outcome]

    def burst(self, seconds: float) -> list[float]:
        solve, clock, taken = self.solve, time.perf_counter, []
        collecting = gc.isenabled()
        gc.disable()
        try:
            begin = clock()
            while True:
                before = clock()
                solve()
                after = clock()
                taken.append(after - before)
                if after - begin >= seconds:
                    return taken[1:] or taken
        finally:
            if collecting:
                gc.enable()

    def outcome(self) -> Outcome:
        return self.read(self.solve())
