"""Runs of one start by several methods, without warnings: the comparison has given them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy.typing as npt

import pendcore as pc
from pendcore.messages import silence
from pendcore.methods import known_methods
from pendcore.plotting import LIGHT, Theme


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
        try:
            self.check(method, step)
        except ValueError:
            return False
        return True


def methods_named(methods: str | Iterable[str]) -> list[str]:
    """Return the names of methods to compare, without aliases and each once.

    ``"auto"`` is refused: it may choose a different method at each tolerance.
    """
    names = {alias: name for name, m in known_methods().items() for alias in (name, *m["aliases"])}
    try:
        listed = [methods] if isinstance(methods, str) else list(methods)
    except TypeError:
        raise TypeError(f"methods = {methods!r}: must be names of methods, or one") from None
    if not listed:
        raise ValueError("methods: is empty: must name a method, or be left out")
    for method in listed:
        if method not in names:
            what = "is a rule that chooses one" if method == "auto" else "is none"
            raise ValueError(f"methods: {method!r} {what}: known are {', '.join(names)}")
    return [*dict.fromkeys(names[method] for method in listed)]


def has_error_estimate(method: str) -> bool:
    """Return whether a method chooses its steps from tolerances."""
    return bool(known_methods()[method]["error_order"])


def line_style(method: str, theme: Theme = LIGHT) -> dict[str, Any]:
    """Return how figures draw a method: matplotlib's colour, dash and marker."""
    name, dash, marker = known_methods()[method]["line"]
    linestyle = (0, tuple(map(float, dash.split()))) if dash[0].isdigit() else dash
    return {"color": getattr(theme, name), "linestyle": linestyle, "marker": marker}
