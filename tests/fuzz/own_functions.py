"""Functions of users, of the kinds that they write: ones that work, that raise, that give NaN."""

from __future__ import annotations

from typing import Any

import numpy as np


class Raised(Exception):
    """The exception that a user's function raises."""


class Forces:
    """A law of the user's for a chain of n links, by its name; it prints as its constructor."""

    def __init__(self, name: str, n: int) -> None:
        self.name = name
        self.n = n

    def __call__(self, t: float, q: Any, qd: Any) -> Any:
        if self.name == "raises" and abs(qd[0]) > 1.0:
            raise Raised(f"qd_1 = {qd[0]}")
        if self.name == "is no number" and qd[0] > 1.0:
            return np.full(self.n, np.nan)
        if self.name == "is infinite" and q[0] > 2.0:
            return np.full(self.n, np.inf)
        if self.name == "has a wrong shape" and qd[0] > 0.5:
            return np.zeros(self.n + 1)
        if self.name == "is no array" and qd[0] > 0.5:
            return "torque"
        if self.name == "jumps":
            return -np.sign(qd)
        return -0.1 * qd

    def __repr__(self) -> str:
        return f"Forces({self.name!r}, {self.n})"


class Watched:
    """The function of a user's event, by its name; it prints as its constructor."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, t: float, q: Any, qd: Any) -> Any:
        if self.name == "raises" and qd[0] > 1.0:
            raise Raised(f"qd_1 = {qd[0]}")
        if self.name == "is no number" and q[0] > 1.0:
            return float("nan")
        if self.name == "is no scalar" and qd[0] > 0.5:
            return qd
        if self.name == "is zero":
            return 0.0
        if self.name == "jumps":
            return 1.0 if qd[0] > 0 else -1.0
        return np.sin(q[-1])

    def __repr__(self) -> str:
        return f"Watched({self.name!r})"


WATCHED = ("a sine", "a sine", "a sine", "jumps", "is zero", "raises", "is no number",
           "is no scalar")  # fmt: skip
NAMES = ("damps", "raises", "is no number", "is infinite", "has a wrong shape", "is no array",
         "jumps")  # fmt: skip
