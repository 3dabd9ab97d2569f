"""Runs of one start by several methods, without warnings: the comparison has given them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy.typing as npt

import pendcore as pc
from pendcore.messages import silence
from pendcore.methods import known_methods


class Start(NamedTuple):
    """A scene, its angles (rad) and rates (rad/s) at the start, (n,) each, and a span (s)."""

    scene: pc.Scene
    q0: npt.ArrayLike
    qd0: npt.ArrayLike
    t_start: float
    t_end: float

    def run(self, method: str, **options: Any) -> pc.Solution:
        """Run it by a method, with the options of `simulate`."""
        span = (self.t_start, self.t_end)
        how: dict[str, Any] = {"on_failure": "ignore", "progress": False} | options
        with silence():
            return pc.simulate(self.scene, span, self.q0, self.qd0, method=method, **how)

    def check(self, method: str, step: float | None = None) -> None:
        """Run for no time at all, which raises what is wrong with the start or the method."""
        self._replace(t_end=self.t_start).run(method, step=step, store="end")

    def is_supported_by(self, method: str, step: float | None = None) -> bool:
        """Whether a method supports the scene; ``step`` is for those that need a fixed one, s."""
        if method not in known_methods():
            return False
        try:
            self.check(method, step)
        except ValueError:
            return False
        return True
