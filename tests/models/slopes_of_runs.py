"""Slopes of what a run gives by a start, a torque or a parameter, from runs beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pendcore as pc

Found = Callable[[pc.Scene, list[float]], Any]


def slope_of_runs(
    found: Found, scene: pc.Scene, start: Sequence[float], name: str,
    held: Sequence[str] = (), step: float = 1e-4,
) -> Any:  # fmt: skip
    """The derivative of found(scene, start) by a name, extrapolated from two central differences.

    A start has the angles of the links, then their rates. Parameters that are held stay as they are
    where a rod stays uniform.
    """
    known = scene.parameters()
    named = {one: known[one] for one in held if one in known}

    def beside(change: float) -> Any:
        y, there = list(start), scene
        if name.startswith("q"):
            y[int(name[-2]) - 1 + len(scene.links) * name.startswith("qd")] += change
        elif name.startswith("torque"):
            motor = pc.effects.Motor(joint=1, constant=change)
            there = scene.replace(effects=[*scene.effects, motor])
        else:
            there = scene.with_parameters(named | {name: known[name] + change})
        return found(there, y)

    coarse, fine = ((beside(h) - beside(-h)) / (2 * h) for h in (2 * step, step))
    return (4 * fine - coarse) / 3


def assert_slopes(
    told: Any, found: Found, scene: pc.Scene, start: Sequence[float], names: Sequence[str],
    atol: float = 1e-8, **how: Any,
) -> None:  # fmt: skip
    """What is told by each of the names, along the last axis, is the slope of what is found."""
    for column, name in enumerate(names):
        slopes = slope_of_runs(found, scene, start, name, **how)
        size = max(1.0, np.abs(slopes).max())
        np.testing.assert_allclose(
            told[..., column], slopes, rtol=0, atol=atol * size, err_msg=name
        )
