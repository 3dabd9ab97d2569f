"""Uniform rods: of moment of inertia 1, so that torques are accelerations; or as they are drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
from dense_chain import DenseChain


def rod(*effects: Any, gravity: float = 0.0, links: int = 1) -> pc.Scene:
    """Uniform rods of mass 3 and length 1, without gravity unless it is given."""
    return pc.Scene(
        links=[pc.Link(mass=3, length=1)] * links, gravity=gravity, effects=list(effects)
    )


def solve(scene: pc.Scene, q: Any, qd: Any, t_end: float, **options: Any) -> pc.Solution:
    """Simulate; max_steps ends a run that has lost its end and would go on for ever."""
    return pc.simulate(scene, q0=q, qd0=qd, t_span=(0, t_end), max_steps=10_000, **options)


def time_of_rest(sol: pc.Solution) -> float:
    """When the last moving link came to rest, or the start if nothing moved."""
    moving = np.flatnonzero(sol.qd.any(axis=1))
    return float(sol.t[moving[-1] + 1] if moving.size else sol.t[0])


def links(chain: DenseChain) -> list[pc.Link]:
    """The rods of a chain of dense_chain.py."""
    pairs = zip(chain.masses, chain.lengths, strict=True)
    return [pc.Link(mass=float(mass), length=float(length)) for mass, length in pairs]
