"""The C++ contenders that solve cases: programs that answer requests (see solves.hpp).

On a processor with AVX-512, pendcore takes part twice: as it is, and held back to x86-64-v3.
"""

from __future__ import annotations

import atexit
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from cases import Case

from contenders.contender import COMPILED, COMPILED_V3, Contender, Outcome, Run
from contenders.conversation import Conversation, Prepared, find_executable, words
from contenders.pendcore_python import FIXED, settings_of

PROGRAMS = ("solves_pendcore", "solves_odeint", "solves_sundials")
OURS = "solves_pendcore"


open_conversations: list[Conversation] = []


def begin_conversation(path: Path, environment: dict[str, str] | None = None) -> Conversation:
    open_conversations.append(Conversation(path, environment))
    return open_conversations[-1]


@atexit.register
def end_conversations() -> None:
    """End all programs; their contenders no longer answer."""
    while open_conversations:
        open_conversations.pop().close()


@dataclass(frozen=True, slots=True)
class CompiledRun(Prepared):
    width: int
    compile_seconds: float | None = None

    def outcome(self) -> Outcome:
        answer = self.ask("outcome")
        if answer.startswith("failed "):
            raise RuntimeError(answer.removeprefix("failed "))
        evaluations, steps, *states = answer.split()
        counted = [int(count) if int(count) >= 0 else None for count in (evaluations, steps)]
        found = np.array(states, dtype=np.float64).reshape(-1, self.width)
        return Outcome(found, evaluations=counted[0], steps=counted[1])


def prepare(conversation: Conversation, name: str, case: Case, setting: float) -> Run:
    described = [str(case.n), words(case.masses), words(case.lengths), repr(case.gravity)]
    described += [words(numbers) for numbers in (case.damping, case.stiffness, case.rest)]
    described += [str(int(case.controller)), words(case.start)]
    described += [str(len(case.times)), words(case.times)]
    number = conversation.ask(f"prepare {name} {setting!r} {' '.join(described)}")
    return CompiledRun(conversation, number, 2 * case.n)


def spoken_to(conversation: Conversation) -> Iterator[Contender]:
    for name, label, about in conversation.described():
        yield Contender(
            name=name,
            label=label,
            about=about,
            sides=(COMPILED,),
            prepare=partial(prepare, conversation, name),
        )


def of_program(program: str) -> list[Contender]:
    """List the program's contenders; raise ImportError if the program is not built."""
    path = find_executable(program, program.upper())
    peers = list(spoken_to(begin_conversation(path)))
    if program != OURS:
        return peers
    own = [as_own(contender) for contender in peers]
    if not any("x86-64-v4" in contender.about for contender in own):
        return own
    narrower = begin_conversation(path, {"PENDCORE_INSTRUCTION_SET": "x86-64-v3"})
    return own + [
        replace(
            as_own(contender),
            name=f"{contender.name}_v3",
            label=f"{contender.label} (x86-64-v3)",
            sides=(COMPILED_V3,),
        )
        for contender in spoken_to(narrower)
    ]


def as_own(contender: Contender) -> Contender:
    method = contender.name.removeprefix("pendcore_").removesuffix("_cpp")
    return replace(
        contender,
        ours=True,
        setting="step" if method in FIXED else "tolerance",
        settings=settings_of(method),
    )
