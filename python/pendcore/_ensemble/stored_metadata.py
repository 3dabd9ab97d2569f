"""What the files zarr.json of a store say, compared with what `new_store.create` writes.

A store may come from anywhere. Zarr also opens groups of its format 2, whose codecs can run code,
and makes room for an array of any shape: a file is compared before Zarr reads it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

DOCUMENT = "zarr.json"
CODECS = frozenset({"bytes", "vlen-utf8", "zstd"})
"""Those of the arrays that `new_store.create` makes."""
MOST_BYTES = 2**28
"""The largest zarr.json; that of a group holds the case, with the tables of its effects."""


def attributes_of(path: Path) -> dict[str, Any]:
    """Return the attributes of the group; a ValueError says what is wrong with its file."""
    told = _document(path, DOCUMENT, "group")
    attributes = told.get("attributes")
    if not isinstance(attributes, dict):
        raise _not_as_written(DOCUMENT, told, "attributes", "a table")
    return attributes


def axes_of(
    path: Path,
    name: str,
    dtype: str,
    lengths: Mapping[str, int | None],
    chunk: Sequence[int] | None = None,
) -> list[str]:
    """Return the axes of an array; a ValueError says what in its file is not as it was written.

    ``lengths`` has axes in their order, and how long they are; None stands for any length. With
    ``chunk`` the array has all of them. Without, it is one of the starts: it has some of them, and
    a chunk that Zarr chose, which is no larger than the array.
    """
    where = f"{name}/{DOCUMENT}"
    told = _document(path, where, "array")
    names = told.get("dimension_names") or []  # Zarr writes none for an array without axes
    try:
        axes = [axis for axis in lengths if chunk is not None or axis in names]
        shape: list[Any] = [told["shape"][0] if lengths[x] is None else lengths[x] for x in axes]
        sizes = told["chunk_grid"]["configuration"]["chunk_shape"] if chunk is None else chunk
        pairs = zip(sizes, shape, strict=True)
        fits = all(type(one) is int and 1 <= one <= max(size, 1) for one, size in pairs)
        codecs = {one["name"] for one in told["codecs"]}
    except (IndexError, KeyError, TypeError, ValueError):
        wanted = "shape, chunk_grid, codecs and dimension_names of an array of this store"
        raise ValueError(f"{where}: must have {wanted}") from None
    if not codecs <= CODECS:
        known = ", ".join(sorted(CODECS))
        raise _not_as_written(where, told, "codecs", f"of {known}: others may run code")
    written = {
        "data_type": dtype,
        "dimension_names": axes or None,
        "shape": shape,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [*sizes]}},
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
    }
    for key, value in written.items():
        if json.dumps(told.get(key)) != json.dumps(value):  # to Python, 1 and 1.0 are True
            raise _not_as_written(where, told, key, _short(value))
    if chunk is None and not fits:
        raise _not_as_written(where, told, "chunk_grid", f"of chunks of {shape} or less")
    return axes


def _document(path: Path, name: str, node: str) -> dict[str, Any]:
    with (path / name).open("rb") as file:
        if (size := os.fstat(file.fileno()).st_size) > MOST_BYTES:
            raise ValueError(f"{name}: has {size:,} bytes: must have at most {MOST_BYTES:,}")
        try:
            told = json.load(file)
        except RecursionError:
            raise ValueError(f"{name}: is nested too deeply") from None
        except ValueError as error:
            raise ValueError(f"{name}: is no JSON ({error})") from None
    if not isinstance(told, dict):
        raise ValueError(f"{name}: {_short(told)}: must be a table")
    for key, value in (("zarr_format", 3), ("node_type", node)):
        if told.get(key) != value:
            raise _not_as_written(name, told, key, value)
    return told


def _not_as_written(where: str, told: dict[str, Any], key: str, wanted: object) -> ValueError:
    return ValueError(f"{where}: {key} = {_short(told.get(key))}: must be {wanted}")


def _short(value: Any) -> str:
    """Return a value for a message, which need not show all of it."""
    told = json.dumps(value)
    return told if len(told) < 60 else f"{told[:50]} ..."
