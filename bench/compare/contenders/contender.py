"""What a contender is: it prepares runs of a case at a setting, to be timed and examined.

To add one, write a file beside this one with a list `CONTENDERS`, and add its name to the list in
`__init__.py`. A C++ contender is a .cpp file and a line in `programs.py`.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from cases import Array, Case

Answer = TypeVar("Answer")
COMPILED, COMPILED_V3, PYTHON = "compiled", "compiled_v3", "python"


@dataclass(frozen=True, slots=True)
class Outcome:
    """States (n_t, 2n) at the case's times, and the work that they took, None if not counted.

    `said` is what the contender remarks on a run that it finished.
    """

    states: Array
    evaluations: int | None = None
    steps: int | None = None
    said: str = ""


class Timed(Protocol):
    def burst(self, seconds: float) -> list[float]:
        """Call for about that long and list each call's seconds; a first of several warms up."""


class Run(Timed, Protocol):
    """A case at a setting; everything that can be built beforehand is built.

    `compile_seconds` is how long a user waits for compilation in each process; None if nothing is
    compiled.
    """

    @property
    def compile_seconds(self) -> float | None: ...

    def outcome(self) -> Outcome:
        """Solve and return the result; raise RuntimeError with a reason if there are no states."""


def tolerances(finest: int, per_decade: int) -> list[float]:
    """List tolerances from 1e-1 to 1e-`finest`; whole decades are exact."""
    finer = [10.0 ** -(part / per_decade) for part in range(per_decade)]
    whole = [float(f"1e-{decade}") for decade in range(1, finest)]
    return [decade * share for decade in whole for share in finer] + [float(f"1e-{finest}")]


def fixed_steps(longest: float, shortest: float, per_decade: int) -> list[float]:
    """List steps, in s, for a method that does not choose its own."""
    steps = [longest]
    while steps[-1] > shortest:
        steps.append(longest * 10.0 ** -(len(steps) / per_decade))
    return steps


@dataclass(frozen=True, slots=True)
class Contender:
    """`prepare` makes a run of a case at a setting, or raises Unsupported if it cannot solve that.

    `about` gives version and settings. `sides` are the sides on which the contender takes part: its
    time is that of compiled code, or it includes a call from Python. `settings` are tolerances or
    steps, from the loosest; `slow` contenders get few of them.
    """

    name: str
    label: str
    about: str
    prepare: Callable[..., Any]
    sides: tuple[str, ...] = (PYTHON,)
    ours: bool = False
    setting: str = "tolerance"
    settings: Callable[[int], list[float]] = lambda per_decade: tolerances(13, per_decade)
    slow: bool = False


class Unsupported(Exception):
    """Raised by a contender that does not support the case."""


def compiled(build: Callable[[], Answer]) -> tuple[Answer, float]:
    """Build, and measure the seconds that this takes."""
    begin = time.perf_counter()
    return build(), time.perf_counter() - begin


known: dict[tuple[str, str], tuple[Any, float]] = {}


def once(kind: str, case: Case, build: Callable[[], Any]) -> tuple[Any, float]:
    """Compile what does not depend on the tolerance once for a case."""
    if (kind, case.name) not in known:
        known[kind, case.name] = compiled(build)
    return known[kind, case.name]


@dataclass(frozen=True, slots=True)
class PythonRun(Generic[Answer]):
    """A run in this process: `solve` is timed and ends with the states; `read` examines them."""

    solve: Callable[[], Answer]
    read: Callable[[Answer], Outcome]
    compile_seconds: float | None = None

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
