"""What tells the members of an ensemble apart: starts and parameters that broadcast."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore._messages.arguments import Floats, real_array
from pendcore._scene.scene import Scene, check_parameter_names

Index = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Members:
    """The members of an ensemble; arrays that were broadcast take the memory of what was given."""

    scene: Scene
    """What they have in common."""
    shape: Index
    """The shape of the ensemble."""
    q0: Floats
    qd0: Floats
    """(*shape, n), rad and rad/s."""
    vary: dict[str, Floats]
    """The values of each parameter by its name, (*shape)."""

    @property
    def count(self) -> int:
        """The number of members."""
        return int(np.prod(self.shape, dtype=np.int64))

    def scene_of(self, index: Index) -> Any:
        """Return the scene of a member."""
        values = {name: float(varied[index]) for name, varied in self.vary.items()}
        return self.scene.with_parameters(values) if values else self.scene

    def block(self, block: tuple[slice, ...]) -> Members:
        """Return the members of a block, in memory of their own."""
        shape = tuple(one.stop - one.start for one in block)
        return self._picked(shape, lambda values: values[block].copy())

    def selected(self, places: npt.NDArray[np.intp]) -> Members:
        """Return the members at flat places, along one axis."""
        shape = self.shape or (1,)  # an ensemble without axes has one member
        where = np.unravel_index(places, shape)
        axes = len(self.shape)
        return self._picked(
            places.shape, lambda x: np.broadcast_to(x, shape + x.shape[axes:])[where]
        )

    def _picked(self, shape: Index, pick: Callable[[Floats], Floats]) -> Members:
        """Return members of a shape, with what is picked of each array."""
        vary = {name: pick(values) for name, values in self.vary.items()}
        return replace(self, shape=shape, q0=pick(self.q0), qd0=pick(self.qd0), vary=vary)


def members_of(
    scene: Scene,
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike,
    vary: Mapping[str, npt.ArrayLike] | None,
) -> Members:
    """Return the members that starts and parameters make together, by NumPy's broadcasting."""
    n = len(scene.links)
    angles, rates = _start("q0", q0, n, "rad"), _start("qd0", qd0, n, "rad/s")
    given = _parameters(scene, vary)
    leading = {"q0": angles.shape[:-1], "qd0": rates.shape[:-1]}
    leading |= {f'vary["{name}"]': values.shape for name, values in given.items()}
    try:
        shape = np.broadcast_shapes(*leading.values())
    except ValueError:
        shapes = ", ".join(f"{name} {shape}" for name, shape in leading.items() if shape)
        raise ValueError(
            f"the members' axes do not broadcast: {shapes}; the last axis of q0 and qd0, which "
            "runs over the links, is left out here"
        ) from None
    q, qd = (np.broadcast_to(one, (*shape, n)) for one in (angles, rates))
    varied = {name: np.broadcast_to(values, shape) for name, values in given.items()}
    return Members(scene, shape, q, qd, varied)


def _start(name: str, value: npt.ArrayLike, n: int, unit: str) -> Floats:
    array = real_array(name, value, unit)
    if array.ndim == 0:
        return np.broadcast_to(array, (n,))
    if array.shape[-1] != n:
        raise ValueError(
            f"{name}: shape {array.shape}: must be (..., {n}): the last axis runs over the links, "
            f"the axes before it over the members ({unit})"
        )
    return array


def _parameters(scene: Scene, vary: Mapping[str, npt.ArrayLike] | None) -> dict[str, Floats]:
    if vary is None:
        return {}
    if not isinstance(vary, Mapping):
        raise TypeError(
            f"vary = {vary!r}: must be a dictionary of names and values, such as "
            '{"link[1].mass": [0.9, 1.0, 1.1]}'
        )
    check_parameter_names(scene._compiled, vary)
    return {name: real_array(f'vary["{name}"]', value, "") for name, value in vary.items()}


class Coordinate(NamedTuple):
    """Values that tell members apart, without the axes along which they were broadcast."""

    name: str
    axes: tuple[str, ...]
    values: Floats
    unit: str


def member_axes(shape: Index) -> list[str]:
    """Return the names of the axes of an ensemble."""
    return [f"member_{k}" for k in range(len(shape))]


def coordinates(members: Members) -> list[Coordinate]:
    """Return the coordinates of the members: q0, qd0, and what varies."""
    units = members.scene.parameter_units()
    axes = member_axes(members.shape)
    starts = ("q0", members.q0, "rad"), ("qd0", members.qd0, "rad/s")
    found = [Coordinate(name, *_needed([*axes, "link"], x), unit) for name, x, unit in starts]
    varied = members.vary.items()
    return [*found, *(Coordinate(name, *_needed(axes, x), units[name]) for name, x in varied)]


def members_from(
    scene: Scene, shape: Index, found: Mapping[str, tuple[Sequence[str], Floats]]
) -> Members:
    """Return the members of a scene that have these coordinates: name to axes and values."""
    axes, n = member_axes(shape), len(scene.links)
    lengths = dict(zip(axes, shape, strict=True)) | {"link": n}

    def whole(name: str) -> Floats:
        own, values = found[name]
        all_axes = [*axes, "link"] if name in ("q0", "qd0") else axes
        index = tuple(slice(None) if axis in own else np.newaxis for axis in all_axes)
        return np.broadcast_to(values[index], tuple(lengths[axis] for axis in all_axes))

    vary = {name: whole(name) for name in found if name not in ("q0", "qd0")}
    return Members(scene, shape, whole("q0"), whole("qd0"), vary)


def _needed(axes: list[str], values: Floats) -> tuple[tuple[str, ...], Floats]:
    """Return the axes that were not broadcast, and the values along them."""
    is_empty = 0 in values.shape
    own = [k for k, step in enumerate(values.strides) if step != 0 or is_empty]
    index = tuple(slice(None) if k in own else 0 for k in range(values.ndim))
    return tuple(axes[k] for k in own), values[index]
