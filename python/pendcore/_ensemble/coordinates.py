"""Starts and varied parameters of an ensemble, along those axes of the members that they need."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pendcore._ensemble.members import Members
from pendcore._messages.arguments import Floats


class Coordinate(NamedTuple):
    """Values that tell members apart, without the axes along which they were broadcast."""

    name: str
    axes: tuple[str, ...]
    values: Floats
    unit: str


def member_axes(shape: tuple[int, ...]) -> list[str]:
    """Return the names of the axes of an ensemble."""
    return [f"member_{k}" for k in range(len(shape))]


def coordinates(members: Members) -> list[Coordinate]:
    """Return the coordinates of the members: q0, qd0, and what varies."""
    units = members.scene.parameter_units()
    axes = member_axes(members.shape)
    found = [
        Coordinate("q0", *_needed([*axes, "link"], members.q0), "rad"),
        Coordinate("qd0", *_needed([*axes, "link"], members.qd0), "rad/s"),
    ]
    for name, values in members.vary.items():
        found.append(Coordinate(name, *_needed(axes, values), units[name]))
    return found


def members_from(
    scene: Any, shape: tuple[int, ...], found: dict[str, tuple[tuple[str, ...], Floats]]
) -> Members:
    """Return the members of a scene that have these coordinates: name to axes and values."""
    axes, n = member_axes(shape), len(scene.links)
    lengths = dict(zip(axes, shape, strict=True)) | {"link": n}

    def whole(name: str, all_axes: list[str]) -> Floats:
        own, values = found[name]
        full = tuple(lengths[axis] for axis in all_axes)
        index = tuple(slice(None) if axis in own else np.newaxis for axis in all_axes)
        return np.broadcast_to(values[index], full)

    vary = {name: whole(name, axes) for name in found if name not in ("q0", "qd0")}
    return Members(scene, shape, whole("q0", [*axes, "link"]), whole("qd0", [*axes, "link"]), vary)


def _needed(axes: list[str], values: Floats) -> tuple[tuple[str, ...], Floats]:
    """Return the axes that were not broadcast, and the values along them."""
    is_empty = 0 in values.shape
    own = [k for k, step in enumerate(values.strides) if step != 0 or is_empty]
    index = tuple(slice(None) if k in own else 0 for k in range(values.ndim))
    return tuple(axes[k] for k in own), values[index]
