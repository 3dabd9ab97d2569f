"""The settings of pendcore's methods: tolerances, or steps if a method takes fixed ones."""

from __future__ import annotations

from collections.abc import Callable

from pendcore import _core

from contenders.contender import fixed_steps, tolerances

FIXED = {method["name"] for method in _core.methods() if method["error_order"] == 0}
FINEST = {"dop853": 15, "taylor": 16}  # where smaller tolerances still bring smaller errors


def settings_of(method: str) -> Callable[[int], list[float]]:
    """Map the number of settings per decade to the settings."""
    if method in FIXED:
        return lambda per_decade: fixed_steps(0.1, 1e-4, 2 * per_decade)
    return lambda per_decade: tolerances(FINEST.get(method, 13), per_decade)
