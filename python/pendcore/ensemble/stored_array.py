"""An array of a store, which says which of its files cannot be read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, slots=True)
class StoredArray:
    """An array of results on disk; an index reads from it.

    Attributes
    ----------
    path : Path
        The store.
    array, status : zarr.Array
        The array, and that of the statuses, whose chunks say which blocks were written.
    """

    path: Path
    array: Any
    status: Any

    @property
    def shape(self) -> tuple[int, ...]:
        """Return the shape, without reading."""
        shape: tuple[int, ...] = self.array.shape
        return shape

    @property
    def dtype(self) -> np.dtype[Any]:
        """Return the type of the numbers, without reading."""
        dtype: np.dtype[Any] = self.array.dtype
        return dtype

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return np.asarray(self[...], dtype)

    def __getitem__(self, index: Any) -> Any:
        """Read; an OSError names a chunk that is damaged, and says how it is made anew."""
        try:
            return self.array[index]
        except (RuntimeError, ValueError) as error:
            for place in np.ndindex(self.array.cdata_shape):
                try:
                    self.array.blocks[place]
                except (RuntimeError, ValueError):
                    raise OSError(self._complaint(place, error)) from error
            raise

    def _complaint(self, place: tuple[int, ...], error: Exception) -> str:
        block = place[: self.status.ndim]
        return (
            f"store = {str(self.path)!r}: {_file(self.array, place)} cannot be read ({error}): "
            f"remove {_file(self.status, block)} from the store, and the call of pc.ensemble that "
            "made it computes these members again"
        )


def _file(array: Any, place: tuple[int, ...]) -> str:
    return f"{array.basename}/{array.metadata.encode_chunk_key(place)}"
