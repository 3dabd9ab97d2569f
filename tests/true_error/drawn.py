"""A scene that was drawn, and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf
from typing import Any

import pendcore as pc

SWITCHED = ("dry_joint_friction", "joint_stop", "user")


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A scene, its start and span, and the keywords of its runs.

    Attributes
    ----------
    family, seed : str, int
        What it was drawn from.
    scene : pendcore.Scene
    q0, qd0 : tuple of float, (n,)
        rad and rad/s.
    t_start, t_end : float
        s.
    error : float
        The error that is asked for, as a share of the total length.
    options : dict
        Further keywords of ``simulate`` beside ``error``.
    rtol, limit : float
        The tolerance of the run that is asked for its ``valid_until``, and the limit, rad.
    """

    family: str
    seed: int
    scene: pc.Scene
    q0: tuple[float, ...]
    qd0: tuple[float, ...]
    t_start: float
    t_end: float
    error: float
    options: dict[str, Any] = field(default_factory=dict)
    rtol: float
    limit: float

    @property
    def span(self) -> tuple[float, float]:
        return self.t_start, self.t_end

    @property
    def is_switched(self) -> bool:
        """Whether joints stick, stops are met, or laws have kinks or jumps: see `switches`."""
        return any(
            effect.kind in SWITCHED
            or any(getattr(effect, name, None) for name in ("table", "spline", "damping2"))
            or getattr(effect, "limit", inf) < inf
            for effect in self.scene.effects
        )

    @property
    def is_dense(self) -> bool:
        """Whether the run that is asked for can be compared at any time."""
        return "t_eval" not in self.options and self.options.get("store", "dense") == "dense"
