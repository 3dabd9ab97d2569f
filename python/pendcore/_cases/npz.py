"""NumPy's npz files from anywhere: numbers and texts, never a pickle, and none of boundless size.

An entry is read only if its length is that of the shape and type at its head.
"""

from __future__ import annotations

import math
import os
import threading
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import IO, Any, BinaryIO

import numpy as np
import numpy.typing as npt

MOST_TIMES_PACKED = 100
"""The most that entries unpack to, as a multiple of their file. What pendcore and `numpy.savez`
write is not compressed; zeros that are compressed come to a thousand."""

_ONE_HEAD = threading.Lock()
"""NumPy parses heads with `ast`, whose depth CPython before 3.11.8 counts for all threads together:
two that parse at once may end with a SystemError (python/cpython#113035)."""


class Entries(Mapping[str, npt.NDArray[Any]]):
    """The arrays of an npz file by name, each of which is read when it is asked for."""

    def __init__(self, archive: zipfile.ZipFile, size: int) -> None:
        self._archive = archive
        members = archive.infolist()
        unpacked = sum(one.file_size for one in members)
        if unpacked > MOST_TIMES_PACKED * size:
            raise ValueError(
                f"it has {size:,} bytes and unpacks to {unpacked:,}: at most {MOST_TIMES_PACKED} "
                "times as many are read"
            )
        self._members = {one.filename.removesuffix(".npy"): one for one in members}

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Read an array."""
        member = self._members[name]
        entry: Any  # that of zipfile also reads into an array
        with self._archive.open(member) as entry:
            shape, is_fortran, dtype = _head(entry)
            if dtype.kind not in "biufU":
                raise ValueError(f"{name}: is of type {dtype}: numbers and texts are read")
            count = math.prod(shape)
            length = entry.tell() + count * dtype.itemsize
            if min(shape, default=0) < 0 or member.file_size != length:
                raise ValueError(f"{name}: is not as long as its shape {shape}")
            values = np.empty(count, dtype)
            if values.nbytes and entry.readinto(values.view(np.uint8)) != values.nbytes:
                raise ValueError(f"{name}: was cut short")
        return values.reshape(shape[::-1]).T if is_fortran else values.reshape(shape)

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def __len__(self) -> int:
        return len(self._members)


@contextmanager
def entries_of(file: BinaryIO) -> Iterator[Entries]:
    """Read an npz file; a ValueError says that it is none."""
    if not zipfile.is_zipfile(file):
        raise ValueError("it is no npz file, or was cut short")
    with zipfile.ZipFile(file) as archive:
        yield Entries(archive, os.fstat(file.fileno()).st_size)


def _head(entry: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Return shape, whether the first axis runs fastest, and type."""
    with _ONE_HEAD:
        if np.lib.format.read_magic(entry) == (1, 0):
            return np.lib.format.read_array_header_1_0(entry)
        return np.lib.format.read_array_header_2_0(entry)
