"""The C++ contenders: programs with which we speak line by line (see program.hpp).

In this way their bursts take turns with those of the Python contenders and of other programs. On a
processor with AVX-512, pendcore solves cases twice: as it is, and held back to x86-64-v3.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from cases import Array, Case

from contenders.contender import COMPILED, COMPILED_V3, Contender, Outcome, Unsupported
from contenders.pendcore_python import FIXED, scene_of, settings_of

PROJECT = Path(__file__).parents[3]
LONGEST_ANSWER = 120.0  # s
SOLVERS = ("solves_pendcore", "solves_odeint", "solves_sundials")
OURS = "solves_pendcore"


def listed(numbers: Any) -> str:
    """Write how many numbers there are, and then each so that it reads back as the same double."""
    flat = np.ravel(numbers)
    return " ".join([str(flat.size), *(repr(float(number)) for number in flat)])


def parameters_of(part: Any, where: str = "") -> Iterator[str]:
    """Write the parameters of an effect, or of a part of one, that have a value."""
    for name, value in part.particulars().items():
        if hasattr(value, "particulars"):
            yield from parameters_of(value, f"{where}{name}.")
        elif value is not None:
            yield f"{where}{name} {listed(value)}"


def described(effects: Iterable[Any], words: Mapping[str, str] | None = None, **given: Any) -> str:
    """Write what is given to a contender as its program reads it."""
    written = [f"word {name} {word}" for name, word in (words or {}).items()]
    written += [f"{name} {listed(numbers)}" for name, numbers in given.items()]
    for effect in effects:
        written += [f"effect {effect.kind}", *parameters_of(effect)]
    return " ".join(written)


def find_executable(name: str) -> Path:
    """Find the newest file of that name under the project's build.

    An environment variable of that name, in capitals, may name the file or its folder instead.
    """
    named = os.environ.get(name.partition(".")[0].upper())
    if named and Path(named).is_dir():
        found = [Path(named) / name]
    else:
        found = [Path(named)] if named else list(PROJECT.glob(f"build/**/{name}"))
    found = [path for path in found if path.is_file()]
    if not found:
        raise ImportError(f"{name}: not built; `make build-bench` builds it")
    return max(found, key=lambda path: path.stat().st_mtime)


class Conversation:
    """A request is a line, the answer is a line: `ok ...`, `unsupported ...` or `error ...`."""

    def __init__(self, path: Path, environment: Mapping[str, str] | None = None) -> None:
        """Start the program; `environment` is added to this process's."""
        self.name = path.name
        # The program has a group of its own, so that a Ctrl-C reaches us alone. It ends when its
        # input ends.
        self.process = subprocess.Popen(
            [path],
            env={**os.environ, **(environment or {})},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
            process_group=0,
        )
        conversations.append(self)

    def ask(self, request: str) -> str:
        self.process.stdin.write(request + "\n")
        self.process.stdin.flush()
        alarm = threading.Timer(LONGEST_ANSWER, self.process.kill)
        alarm.start()
        try:
            line = self.process.stdout.readline()
        finally:
            alarm.cancel()
        verdict, _, answer = line.rstrip("\n").partition(" ")
        if verdict == "unsupported":
            raise Unsupported(answer)
        if verdict != "ok":
            raise RuntimeError(
                f"{self.name}: {request[:60]}: {answer or 'it ended, or took too long'}"
            )
        return answer

    def close(self) -> None:
        """End the program, which happens by itself when its input ends."""
        conversations.remove(self)
        try:
            self.process.communicate(timeout=LONGEST_ANSWER)
        except BaseException:
            self.process.kill()
            raise

    def contenders(self, prepare: Callable[..., Any]) -> list[Contender]:
        """List the program's contenders; `prepare` takes the conversation and the name first."""
        found = []
        for name in self.ask("names").split():
            label, _, about = self.ask(f"about {name}").partition(": ")
            prepared = partial(prepare, self, name)
            found.append(Contender(name, label, about, prepared, sides=(COMPILED,)))
        return found


conversations: list[Conversation] = []


@atexit.register
def end_conversations() -> None:
    """End all programs; their contenders no longer answer."""
    while conversations:
        conversations[-1].close()


@dataclass(frozen=True, slots=True)
class Prepared:
    """What a program has prepared, under a number."""

    conversation: Conversation
    number: str

    def ask(self, word: str, *more: float) -> str:
        return self.conversation.ask(" ".join([word, self.number, *map(str, more)]))

    def burst(self, seconds: float) -> list[float]:
        """Call for about that long and list seconds of a call, or batch by batch of many."""
        return [1e-9 * float(nanoseconds) for nanoseconds in self.ask("burst", seconds).split()]


@dataclass(frozen=True, slots=True)
class CompiledRun(Prepared):
    """A solve of a case, whose states are so wide."""

    width: int
    compile_seconds: float | None = None

    def outcome(self) -> Outcome:
        answer = self.ask("outcome")
        if answer.startswith("failed "):
            raise RuntimeError(answer.removeprefix("failed "))
        evaluations, steps, *states = answer.split()
        counted = [int(count) if int(count) >= 0 else None for count in (evaluations, steps)]
        return Outcome(np.array(states, dtype=np.float64).reshape(-1, self.width), *counted)


class Calls(Prepared):
    """Calls of a scene's right-hand side; a burst lists the seconds of a right-hand side."""

    def bytes(self) -> int | None:
        """Return the bytes of the heap that the preparation holds, if that is known."""
        return int(self.ask("bytes")) or None

    def outcome(self) -> Array:
        """Return qdd (n,) at the first of the scene's states, or its derivatives, row by row."""
        return np.array(self.ask("outcome").split(), dtype=np.float64)


CHAIN = ("masses", "lengths", "gravity")
CASE = (*CHAIN, "damping", "stiffness", "rest", "start", "times")


def prepare_case(conversation: Conversation, name: str, case: Case, setting: float) -> CompiledRun:
    given = {key: getattr(case, key) for key in CASE}
    description = described(scene_of(case).effects, setting=setting, **given)
    return CompiledRun(conversation, conversation.ask(f"prepare {name} {description}"), 2 * case.n)


def solvers_of(program: str) -> list[Contender]:
    """List the program's solvers of cases; raise ImportError if the program is not built."""
    path = find_executable(program)
    found = Conversation(path).contenders(prepare_case)
    if program != OURS:
        return found
    own = [as_own(contender) for contender in found]
    if not any("x86-64-v4" in contender.about for contender in own):
        return own
    held_back = Conversation(path, {"PENDCORE_INSTRUCTION_SET": "x86-64-v3"})
    return own + [
        replace(
            as_own(contender),
            name=f"{contender.name}_v3",
            label=f"{contender.label} (x86-64-v3)",
            sides=(COMPILED_V3,),
        )
        for contender in held_back.contenders(prepare_case)
    ]


def as_own(contender: Contender) -> Contender:
    method = contender.name.removeprefix("pendcore_").removesuffix("_cpp")
    setting = "step" if method in FIXED else "tolerance"
    return replace(contender, ours=True, setting=setting, settings=settings_of(method))
