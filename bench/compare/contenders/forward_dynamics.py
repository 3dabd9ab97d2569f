"""The contenders of forward dynamics: programs that answer requests (see forward_dynamics.hpp)."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np
from chain_scenes import Array, ChainScene

from contenders.conversation import Conversation, Prepared, find_executable, words

PROGRAMS = tuple(
    f"forward_dynamics_{side}"
    for side in ("pendcore", "pinocchio_native", "pinocchio_v3", "mujoco")
)


def described(scene: ChainScene) -> str:
    """Write the scene as the programs read it."""
    n_states, n = scene.q.shape
    described = [scene.effect, str(n), str(n_states), words(scene.masses), words(scene.lengths)]
    described += [repr(scene.gravity), words(scene.q.flat), words(scene.qd.flat)]
    return " ".join(described)


class Calls(Prepared):
    """Calls of a scene's right-hand side; a burst lists the seconds of a right-hand side."""

    def bytes(self) -> int | None:
        """Return the bytes of the heap that the preparation holds, if that is known."""
        return int(self.ask("bytes")) or None

    def accelerations(self) -> Array:
        """Return qdd (n,) at the first of the scene's states."""
        return np.array(self.ask("accelerations").split(), dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class ForwardDynamics:
    """`prepare` raises Unsupported for a scene that the contender does not support."""

    name: str
    label: str
    about: str
    conversation: Conversation

    def facts(self) -> dict[str, str]:
        return {"label": self.label, "about": self.about}

    def prepare(self, scene: ChainScene) -> Calls:
        number = self.conversation.ask(f"prepare {self.name} {described(scene)}")
        return Calls(self.conversation, number)


@contextmanager
def contenders() -> Iterator[list[ForwardDynamics]]:
    """Start the programs that have been built; stderr says why others are left out."""
    with ExitStack() as programs:
        found = []
        for program in PROGRAMS:
            try:
                conversation = Conversation(find_executable(program, "PENDCORE_FORWARD_DYNAMICS"))
            except ImportError as absence:
                print(f"left out: {absence}", file=sys.stderr)
                continue
            programs.callback(conversation.close)
            found += [
                ForwardDynamics(name=name, label=label, about=about, conversation=conversation)
                for name, label, about in conversation.described()
            ]
        yield found
