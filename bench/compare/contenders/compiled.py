"""The C++ contenders: one program that answers line by line (conversation.cpp has the words).

So their bursts take their turns among the Python contenders'.
"""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from cases import Array, Case

from contenders.contender import Contender, Outcome, Run, Unsupported

EXECUTABLE = "pendcore_contenders"
PROJECT = Path(__file__).parents[3]


def find_executable() -> Path:
    """Find the file that PENDCORE_CONTENDERS names, else the newest under the project's build."""
    named = os.environ.get("PENDCORE_CONTENDERS")
    found = [Path(named)] if named else list(PROJECT.glob(f"build/**/{EXECUTABLE}"))
    found = [path for path in found if path.is_file()]
    if not found:
        raise ImportError(
            f"{named or EXECUTABLE}: not built; `make compare` builds it, or "
            "`cmake --preset bench && cmake --build --preset bench`"
        )
    return max(found, key=lambda path: path.stat().st_mtime)


def words(numbers: Array | tuple[float, ...]) -> str:
    return " ".join(repr(float(number)) for number in numbers)


class Conversation:
    """A request is a line, the answer is a line: `ok ...`, `unsupported ...` or `error ...`."""

    def __init__(self, path: Path) -> None:
        self.process = subprocess.Popen(
            [path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )

    def ask(self, request: str) -> str:
        if self.process.stdin is None or self.process.stdout is None:
            raise RuntimeError("the conversation has no pipes")
        self.process.stdin.write(request + "\n")
        verdict, _, answer = self.process.stdout.readline().rstrip("\n").partition(" ")
        if verdict == "unsupported":
            raise Unsupported(answer)
        if verdict != "ok":
            raise RuntimeError(f"{EXECUTABLE}: {request[:60]}: {answer or 'it ended'}")
        return answer


@dataclass(frozen=True, slots=True)
class CompiledRun:
    conversation: Conversation
    number: str
    width: int

    def burst(self, seconds: float) -> list[float]:
        answer = self.conversation.ask(f"burst {self.number} {seconds}")
        return [1e-9 * float(nanoseconds) for nanoseconds in answer.split()]

    def outcome(self) -> Outcome:
        evaluations, *states = self.conversation.ask(f"outcome {self.number}").split()
        return Outcome(np.array(states, dtype=np.float64).reshape(-1, self.width), int(evaluations))


def prepare(conversation: Conversation, name: str, case: Case, tolerance: float) -> Run:
    described = " ".join(
        [
            *(str(case.n), words(case.masses), words(case.lengths), repr(case.gravity)),
            *(words(case.start), str(len(case.times)), words(case.times)),
        ]
    )
    number = conversation.ask(f"prepare {name} {tolerance!r} {described}")
    return CompiledRun(conversation, number, 2 * case.n)


def contenders() -> list[Contender]:
    conversation = Conversation(find_executable())
    result = []
    for name in conversation.ask("names").split():
        label, _, about = conversation.ask(f"about {name}").partition(": ")
        result.append(
            Contender(
                name=name, label=label, about=about, prepare=partial(prepare, conversation, name)
            )
        )
    return result


CONTENDERS = contenders()
