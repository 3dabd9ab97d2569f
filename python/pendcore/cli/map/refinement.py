"""A map that is computed finely only where it changes.

The map begins with large pixels. A pixel that differs from a neighbour is divided into four, which
are computed; where nothing changes, four take the value of the one. So an island may be missed that
is smaller than a large pixel; the pixels that were computed are told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore.messages import Floats

Mask = npt.NDArray[np.bool_]

DIFFERS = 0.05
"""The share of the range of colours by which neighbours may differ."""


def levels_of(shape: tuple[int, int], levels: int) -> list[tuple[int, int]]:
    """Return the shapes of the maps from the coarsest on; the last one is ``shape``."""
    for size in shape:
        if size % 2**levels:
            raise ValueError(f"count = {size}: must be a multiple of {2**levels} to be refined")
    return [(shape[0] >> k, shape[1] >> k) for k in range(levels, -1, -1)]


def refined(
    shape: tuple[int, int],
    levels: int,
    compute: Callable[[tuple[int, int], Mask], tuple[Floats, Mask]],
) -> Iterator[tuple[Floats, Mask, Mask]]:
    """Yield the map after each level: its values, which are resolved, and which were computed.

    ``compute`` gets the shape of a level and a mask of its pixels, and returns, in the order of the
    mask, their values and which of them are resolved.
    """
    coarsest, *finer = levels_of(shape, levels)
    wanted = np.ones(coarsest, dtype=bool)
    values, resolved = np.full(coarsest, np.nan), np.zeros(coarsest, dtype=bool)
    for level in (coarsest, *finer):
        if level != coarsest:
            wanted = _enlarged(_differs(values))
            values, resolved = _enlarged(values), _enlarged(resolved)
        values[wanted], resolved[wanted] = compute(level, wanted)
        factor = shape[0] // level[0]
        yield _enlarged(values, factor), _enlarged(resolved, factor), _enlarged(wanted, factor)


def _differs(values: Floats) -> Mask:
    """Return which pixels differ from one of their eight neighbours."""
    colours = _colours(values)
    found = np.zeros(values.shape, dtype=bool)
    padded = np.pad(colours, 1, mode="edge")
    nothing = np.isnan(colours)
    rows, columns = values.shape
    for i in range(3):
        for k in range(3):
            other = padded[i : i + rows, k : k + columns]
            with np.errstate(invalid="ignore"):
                found |= np.abs(other - colours) > DIFFERS
            found |= np.isnan(other) != nothing
    return found


def _colours(values: Floats) -> Floats:
    """Return values as shares of the range of colours, logarithmic where all are positive."""
    some = values[np.isfinite(values)]
    if not some.size:
        return values
    scale = np.log if some.min() > 0 else np.asarray
    low, high = scale(some.min()), scale(some.max())
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray((scale(values) - low) / max(float(high - low), 1e-300))


def _enlarged(pixels: npt.NDArray[Any], factor: int = 2) -> npt.NDArray[Any]:
    return pixels.repeat(factor, axis=0).repeat(factor, axis=1)
