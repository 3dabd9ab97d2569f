"""A new store: it appears under its name when it has all starts and no results."""

from __future__ import annotations

import os
import shutil
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import numpy as np

from pendcore import _core
from pendcore._ensemble.about import BLOCK, SHAPE, about
from pendcore._ensemble.blocks import blocks_of, require_few_blocks, usual_block
from pendcore._ensemble.members import Members, coordinates, member_axes
from pendcore._ensemble.one_writer import other_writer
from pendcore._ensemble.request import Request

if TYPE_CHECKING:
    import zarr


def bytes_of(members: Members, request: Request) -> int:
    """Return the disk space that a store takes at most: nothing here counts on compression."""
    variables = request.variables(len(members.scene.links))
    starts = sum(one.values.nbytes for one in coordinates(members))
    return starts + members.count * sum(one.bytes_a_member for one in variables)


def require_space(path: Path, size: int) -> None:
    """Raise an OSError if the disk has less space than a store may take."""
    folder = path.resolve().parent
    if not folder.is_dir():
        raise FileNotFoundError(f"store = {str(path)!r}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"store = {str(path)!r}: the folder {folder} cannot be written")
    free = shutil.disk_usage(folder).free
    if size > free:
        raise OSError(
            f"store = {str(path)!r}: needs up to {in_words(size)}, but {in_words(free)} are free "
            f"in {folder}"
        )


def in_words(size: int) -> str:
    """Return a number of bytes for people."""
    for unit, one in (("GB", 10**9), ("MB", 10**6), ("kB", 10**3)):
        if size >= one:
            return f"{size / one:.3g} {unit}"
    return f"{size} bytes"


def create(path: Path, members: Members, request: Request, chunk: int, time_limit: float) -> bool:
    """Make a store without results. It appears under its name when it has all starts.

    There is none, and False, if the limit is too short to know how large a chunk should be.
    """
    zarr = zarr_module()
    if path.exists() and (path.samefile(Path.cwd()) or path.is_mount()):
        wanted = "is the current folder or a disk: name a folder in it"
        raise OSError(f"store = {str(path)!r}: {wanted}")
    told = about(members.scene, list(members.vary), request)  # says what cannot be saved
    require_space(path, bytes_of(members, request))
    count = chunk or usual_block(members, request, time_limit)
    if not count:
        return False
    blocks = blocks_of(members.shape, count)
    require_few_blocks(blocks)
    axes = member_axes(members.shape)
    building = path.with_name(f"{path.name}.{uuid4().hex}.part")
    with named(path):
        try:
            group = zarr.create_group(building, zarr_format=3)
            starts = coordinates(members)
            for start in starts:
                _put(group, start.name, start.values, start.axes, start.unit)
            variables = request.variables(len(members.scene.links))
            labels = {axis: values for one in variables for axis, values in one.labels.items()}
            for axis, values in labels.items():
                _put(group, axis, np.asarray(values), (axis,), "s" if axis == "time" else "")
            for one in variables:
                sizes = tuple(max(size, 1) for size in (*blocks.block_shape, *one.shape))
                array = _new_array(
                    group, one.name, (*members.shape, *one.shape), np.dtype(one.dtype), one.fill,
                    (*axes, *one.labels), one.unit, sizes,
                )  # fmt: skip
                if one.name == "status":  # as the CF conventions have it
                    flags = {"flag_values": list(range(len(_core.member_statuses)))}
                    array.attrs.update(flags | {"flag_meanings": " ".join(_core.member_statuses)})
            own = {"coordinates": " ".join(one.name for one in starts)}  # as xarray reads them
            group.attrs.update(own | told | {SHAPE: members.shape, BLOCK: blocks.block_shape})
            with warnings.catch_warnings():  # readers of the bare format pass over what it adds
                warnings.simplefilter("ignore")
                zarr.consolidate_metadata(building, zarr_format=3)
            _appear(building, path)
        finally:
            shutil.rmtree(building, ignore_errors=True)
    return True


def _appear(building: Path, path: Path) -> None:
    try:
        building.rename(path)
    except OSError:
        if path.is_dir() and any(path.iterdir()):
            raise other_writer(path) from None
        raise


def zarr_module() -> Any:
    """Return Zarr; an ImportError says how to get it."""
    try:
        import zarr
    except ImportError:
        raise ImportError("store needs zarr: pip install zarr") from None
    return zarr


def _put(group: zarr.Group, name: str, values: Any, axes: tuple[str, ...], unit: str) -> None:
    """Write an array that is whole."""
    fill = {"U": "", "f": np.nan}.get(values.dtype.kind, 0)
    # Zarr 3 has no specification of texts of a fixed length.
    dtype = "string" if values.dtype.kind == "U" else values.dtype
    _new_array(group, name, values.shape, dtype, fill, axes, unit)[...] = values


def _new_array(
    group: zarr.Group,
    name: str,
    shape: tuple[int, ...],
    dtype: Any,
    fill: Any,
    axes: tuple[str, ...],
    unit: str,
    chunks: Any = "auto",
) -> Any:
    """Make an array whose compressor knows a chunk that a disk has changed."""
    return group.create_array(
        name, shape=shape, dtype=dtype, fill_value=fill, chunks=chunks, dimension_names=axes,
        attributes={"units": unit} if unit else {},
        compressors=zarr_module().codecs.ZstdCodec(checksum=True),
    )  # fmt: skip


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Make an `OSError`, such as that of a full disk, name the store and what to do."""
    try:
        yield
    except OSError as error:
        if error.errno is None:  # it is one of ours
            raise
        raise OSError(
            error.errno,
            f"{error.strerror}: what was finished stays; the same call goes on with it",
            str(path),
        ) from error
