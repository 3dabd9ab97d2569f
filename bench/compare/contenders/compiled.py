"""The C++ contenders that solve cases: a program that answers (solves.cpp has the words)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from cases import Case

from contenders.contender import Contender, Outcome, Run
from contenders.conversation import Conversation, find_executable, words


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
    conversation = Conversation(find_executable("pendcore_contenders", "PENDCORE_CONTENDERS"))
    return [
        Contender(name=name, label=label, about=about, prepare=partial(prepare, conversation, name))
        for name, label, about in conversation.described()
    ]


CONTENDERS = contenders()
