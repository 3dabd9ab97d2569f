"""What the files zarr.json of a store say, checked before Zarr reads or makes room for numbers.

A store may come from anywhere. Zarr also opens groups of its format 2, whose codecs can run code,
and takes an array of any shape; what is not as `new_store.create` writes it is refused here.
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
    attributes = _document(path, DOCUMENT, "group").get("attributes")
    if not isinstance(attributes, dict):
        raise ValueError(f"{DOCUMENT}: attributes = {_short(attributes)}: must be a table")
    return attributes


def axes_of(path: Path, name: str, lengths: Mapping[str, int | None]) -> tuple[str, ...]:
    """Return the axes of a start, which are some of those that have these lengths, in order."""
    found = _document(path, f"{name}/{DOCUMENT}", "array").get("dimension_names")
    names = [] if found is None else found  # Zarr writes none for an array without axes
    if not isinstance(names, list) or names != [axis for axis in lengths if axis in names]:
        known = ", ".join(lengths)
        raise ValueError(
            f"{name}/{DOCUMENT}: dimension_names = {_short(found)}: must be of {known}, in order"
        )
    return tuple(names)


def require_array(
    path: Path,
    name: str,
    dtype: str,
    axes: Sequence[str],
    shape: Sequence[int | None],
    chunk: Sequence[int] | None = None,
) -> None:
    """Refuse the file of an array that has other axes, lengths, numbers or codecs.

    A length of None may be any. Without ``chunk``, those of starts, a chunk is at most the array.
    """
    where = f"{name}/{DOCUMENT}"
    told = _document(path, where, "array")

    def require(key: str, is_right: bool, wanted: str) -> None:
        if not is_right:
            raise ValueError(f"{where}: {key} = {_short(told.get(key))}: must be {wanted}")

    found = told.get("shape")
    require("data_type", told.get("data_type") == dtype, dtype)
    require("dimension_names", (told.get("dimension_names") or []) == [*axes], f"{[*axes]}")
    lengths = [
        size if one is None else one for one, size in zip(shape, _sizes(found), strict=False)
    ]
    require("shape", _sizes(found) == lengths and len(lengths) == len(shape), str(list(shape)))
    own = _sizes(_at(told, "chunk_grid", "configuration", "chunk_shape"))
    fits = len(own) == len(lengths) and all(
        1 <= one <= max(size, 1) for one, size in zip(own, lengths, strict=True)
    )
    is_own = fits if chunk is None else own == list(chunk)
    is_own = is_own and _at(told, "chunk_grid", "name") == "regular"
    require("chunk_grid", is_own, f"regular, {list(chunk or lengths)} or less")
    keys = _at(told, "chunk_key_encoding", "name")
    require("chunk_key_encoding", keys == "default", "default")
    codecs = told.get("codecs")
    names = [_at(one, "name") for one in codecs] if isinstance(codecs, list) else [None]
    known = all(isinstance(one, str) and one in CODECS for one in names)
    require("codecs", known, f"of {', '.join(sorted(CODECS))}: others may run code")


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
            raise ValueError(f"{name}: {key} = {_short(told.get(key))}: must be {value}")
    return told


def _at(told: Any, *keys: str) -> Any:
    """Return what stands under keys of tables in tables; None if something does not."""
    for key in keys:
        told = told.get(key) if isinstance(told, dict) else None
    return told


def _sizes(found: Any) -> list[int]:
    """Return a list of whole numbers from 0; an empty one for anything else."""
    is_list = isinstance(found, list) and all(type(one) is int and one >= 0 for one in found)
    return found if is_list else []


def _short(value: Any) -> str:
    """Return a value for a message, which need not show all of it."""
    told = json.dumps(value)
    return told if len(told) < 60 else f"{told[:50]} ..."
