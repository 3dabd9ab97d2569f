"""Laws of a user's own, as Python functions; `switches` and `switched_equations` have the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from true_error.arithmetic import Floats

LAWS: dict[str, Callable[..., float]] = {
    "cubic spring": lambda t, phi, w, k3: -k3 * phi**3,
    "detent": lambda t, phi, w, strength, teeth: -strength * np.sin(teeth * phi),
    "pulse": lambda t, phi, w, height, middle, width: (
        height * np.exp(-(((t - middle) / width) ** 2))
    ),
    "quadratic damper": lambda t, phi, w, b2: -b2 * abs(w) * w,
    "clipped spring": lambda t, phi, w, k, most: -k * np.clip(phi, -most, most),
    "one-sided spring": lambda t, phi, w, k, free: -k * max(phi - free, 0.0),
}
"""The torque, N m, in a joint of angle phi, rad, and rate w, rad/s."""


@dataclass(frozen=True)
class OwnLaw:
    """A law in a joint, as ``pendcore.effects.User`` calls it."""

    name: str
    joint: int
    values: tuple[float, ...]

    def __call__(self, t: float, q: Floats, qd: Floats) -> Floats:
        j = self.joint - 1
        phi, w = (y[j] - (y[j - 1] if j else 0.0) for y in (q, qd))
        torque = LAWS[self.name](t, phi, w, *self.values)
        found = np.zeros(len(q))
        found[j] = torque
        if j:
            found[j - 1] = -torque
        return found
