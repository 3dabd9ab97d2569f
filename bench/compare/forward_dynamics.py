"""Forward dynamics: chains of rods in several states, and who computes their accelerations."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cases import Array
from contenders.contender import Contender, Unsupported
from contenders.programs import CHAIN, Calls, Conversation, described, find_executable
from effect_list import parameters
from record import Point

GRAVITY = 9.807
NUMBERS_IN_ALL = 256  # angles; a short chain's states stay in the nearest memory
PROGRAMS = tuple(
    f"forward_dynamics_{side}"
    for side in ("pendcore", "pinocchio_native", "pinocchio_v3", "mujoco")
)
MOST_LINKS_OF_MUJOCO = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainScene:
    """Masses (n,) are in kg, lengths (n,) in m; q and qd (n_states, n) are in rad and rad/s.

    Angles are absolute, from +x towards +y, y down. The calls go through the states in turn; their
    number is a power of two.
    """

    masses: Array
    lengths: Array
    gravity: float
    effect: str
    q: Array
    qd: Array

    def described(self, **more: str) -> str:
        """Write the scene as the programs read it."""
        given = {name: getattr(self, name) for name in (*CHAIN, "q", "qd")}
        return described(parameters(self.effect), {"effect": self.effect, **more}, **given)


def chain_scene(n: int, effect: str = "none", seed: int = 1) -> ChainScene:
    """Draw a hanging, swinging chain of n rods of about 1 kg and 1 m."""
    random = np.random.default_rng(seed)
    n_states = 1 << max(1, (NUMBERS_IN_ALL // n).bit_length() - 1)
    return ChainScene(
        masses=random.uniform(0.8, 1.2, n),
        lengths=random.uniform(0.8, 1.2, n),
        gravity=GRAVITY,
        effect=effect,
        q=np.pi / 2 + random.uniform(-0.8, 0.8, (n_states, n)),
        qd=random.uniform(-1.0, 1.0, (n_states, n)),
    )


def prepare(conversation: Conversation, name: str, scene: ChainScene) -> Calls:
    if not name.startswith("mujoco"):
        number = conversation.ask(f"prepare {name} {scene.described()}")
        return Calls(conversation, number)
    if len(scene.masses) > MOST_LINKS_OF_MUJOCO:
        raise Unsupported("its mass matrix is dense, and its time grows with n^3")
    import mujoco_models

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.mjb"
        mujoco_models.write_lean(scene, parameters(scene.effect), file)
        number = conversation.ask(f"prepare {name} {scene.described(model=str(file))}")
    return Calls(conversation, number)


def contenders() -> list[Contender]:
    """Start the programs that have been built; stderr says why others are left out."""
    found = []
    for program in PROGRAMS:
        try:
            found += Conversation(find_executable(program)).contenders(prepare)
        except ImportError as absence:
            print(f"left out: {absence}", file=sys.stderr)
    return found


def facts(contender: Contender) -> Point:
    return {"label": contender.label, "about": contender.about}


def disagreement(found: Array, known: Array) -> float:
    """Return the largest difference as a share of the largest acceleration."""
    return float(np.abs(found - known).max() / np.abs(known).max())
