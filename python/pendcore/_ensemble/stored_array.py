"""An array of a store, which says which of its files cannot be read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore._ensemble.stored_metadata import DOCUMENT


@dataclass(frozen=True, slots=True)
class StoredArray:
    """An array of results on disk; an index reads from it."""

    path: Path
    place: Path
    """The store as it was named, and where it is."""
    array: Any
    status: Any
    """The array, and that of the statuses, whose chunks say which blocks were written."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Return the shape, without reading."""
        return tuple(self.array.shape)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Return the type of the numbers, without reading."""
        dtype: np.dtype[Any] = self.array.dtype
        return dtype

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return np.asarray(self[...], dtype)

    def __getitem__(self, index: Any) -> Any:
        """Read; an OSError names a chunk that is damaged, and says how it is made anew."""
        if not is_there(self.place):
            raise moved(self.path)
        try:
            return self.array[index]
        except (RuntimeError, ValueError, MemoryError) as error:
            for place in np.ndindex(self.array.cdata_shape):
                try:
                    self.array.blocks[place]
                except (RuntimeError, ValueError, MemoryError):
                    raise OSError(self._complaint(place, error)) from error
            raise

    def _complaint(self, place: tuple[int, ...], error: Exception) -> str:
        block = place[: self.status.ndim]
        return (
            f"store = {str(self.path)!r}: {file_of(self.array, place)} cannot be read ({error}): "
            f"remove {file_of(self.status, block)} from the store, and the call of pc.ensemble "
            "that made it computes these members again"
        )


def file_of(array: Any, place: tuple[int, ...]) -> str:
    """Return the name of the file of a chunk in its store."""
    return f"{array.path}/{array.metadata.encode_chunk_key(place)}"


def is_there(place: Path) -> bool:
    """Return whether a store is still where it was opened."""
    try:
        (place / DOCUMENT).stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def moved(path: Path) -> OSError:
    """Return the error that a store is no longer where it was opened."""
    return OSError(
        f"store = {str(path)!r}: is no longer there: it was moved or removed while it was used; "
        "what was finished is where it went: put it back, and the same call goes on with it"
    )
