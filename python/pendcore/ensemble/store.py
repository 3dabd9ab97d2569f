"""Results on disk, block by block: a group of Zarr 3, which xarray reads.

Each variable of the result is an array whose chunks are the blocks of the ensemble. The status of a
block is written last, so that a block counts as done only if all of it is there. A store holds
neither times of day nor names of machines: two runs of one ensemble write the same bytes.
"""

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
from pendcore.ensemble.about import CASE, KEEP, VARY, VERSION, about, read_about
from pendcore.ensemble.blocks import Block, Blocks, blocks_of, usual_block
from pendcore.ensemble.coordinates import coordinates, member_axes, members_from
from pendcore.ensemble.members import Members
from pendcore.ensemble.one_writer import one_writer, other_writer
from pendcore.ensemble.request import NOT_RUN, Request, Variable
from pendcore.ensemble.run import Arrays
from pendcore.ensemble.stored_array import StoredArray

if TYPE_CHECKING:
    import zarr

SHAPE, BLOCK = "shape", "block_shape"
_OTHER = {
    CASE: "another scene, or other options or events",
    KEEP: "other reducers",
    VARY: "other parameters that vary",
}


class Store:
    """A store that is open; `opened` makes one.

    Attributes
    ----------
    path : Path
        The folder.
    members, request, blocks
        What is run, and how it is cut.
    """

    __slots__ = ("blocks", "group", "members", "path", "request", "variables")

    def __init__(
        self, path: Path, group: zarr.Group, members: Members, request: Request, blocks: Blocks
    ) -> None:
        self.path, self.group = path, group
        self.members, self.request, self.blocks = members, request, blocks
        self.variables = request.variables(len(members.scene.links))

    @property
    def arrays(self) -> dict[str, StoredArray]:
        """Return the arrays of the result, which read from the disk when they are indexed."""
        return {one.name: self._array(one.name) for one in self.variables}

    def _array(self, name: str) -> StoredArray:
        return StoredArray(self.path, self.group[name], self.group["status"])

    @property
    def is_complete(self) -> bool:
        """Return whether every block was written, without reading any."""
        status: Any = self.group["status"]
        return bool(status.nchunks_initialized == status.nchunks)

    def is_done(self, block: Block) -> bool:
        """Return whether a block was written."""
        first = tuple(slice(one.start, one.start + 1) for one in block)
        return bool((np.asarray(self._array("status")[first]) != NOT_RUN).all())

    def write(self, block: Block, arrays: Arrays) -> None:
        """Write the results of a block."""
        _write(self.path, self.group, self.variables, block, arrays)


def write_block(path: Path, variables: list[Variable], block: Block, arrays: Arrays) -> None:
    """Write the results of a block into a store, without reading the rest of it."""
    _write(path, _zarr().open_group(path, mode="r+"), variables, block, arrays)


def _write(path: Path, group: Any, variables: list[Variable], block: Block, arrays: Arrays) -> None:
    with _named(path):
        for one in reversed(variables):  # the status is the first of them, and is written last
            group[one.name][block] = arrays[one.name]


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


@contextmanager
def store_for(path: Path, members: Members, request: Request, chunk: int) -> Iterator[Store]:
    """Hold the store at a path, to go on with it, or a new one; nothing else may write into it.

    ``chunk`` is the number of members in a block of a new store; 0 leaves it to their work.
    """
    if path.exists() and not path.is_dir():
        raise FileExistsError(f"store = {str(path)!r}: is a file: choose another name")
    if is_new := not path.exists() or not any(path.iterdir()):
        create(path, members, request, chunk)
    with one_writer(path):
        yield opened(path, "r+") if is_new else continued(path, members, request)


def create(path: Path, members: Members, request: Request, chunk: int) -> None:
    """Make a store without results. It appears under its name when it has all starts."""
    zarr = _zarr()
    if path.exists() and (path.samefile(Path.cwd()) or path.is_mount()):
        raise OSError(
            f"store = {str(path)!r}: is the current folder or a disk: name a folder in it"
        )
    told = about(members.scene, list(members.vary), request)  # says what cannot be saved
    require_space(path, bytes_of(members, request))
    blocks = blocks_of(members.shape, chunk or usual_block(members, request))
    axes = member_axes(members.shape)
    building = path.with_name(f"{path.name}.{uuid4().hex}.part")
    with _named(path):
        try:
            group = zarr.create_group(building)
            starts = coordinates(members)
            for start in starts:
                _put(group, start.name, start.values, start.axes, start.unit)
            variables = request.variables(len(members.scene.links))
            labels = {axis: values for one in variables for axis, values in one.labels.items()}
            for axis, values in labels.items():
                _put(group, axis, np.asarray(values), (axis,), "s" if axis == "time" else "")
            for one in variables:
                _create_array(group, one, axes, members.shape, blocks)
            own = {"coordinates": " ".join(one.name for one in starts)}  # as xarray reads them
            group.attrs.update(own | told | {SHAPE: members.shape, BLOCK: blocks.block_shape})
            with warnings.catch_warnings():  # readers of the bare format pass over what it adds
                warnings.simplefilter("ignore")
                zarr.consolidate_metadata(building)
            _appear(building, path)
        finally:
            shutil.rmtree(building, ignore_errors=True)


def _appear(building: Path, path: Path) -> None:
    try:
        building.rename(path)
    except OSError:
        if path.is_dir() and any(path.iterdir()):
            raise other_writer(path) from None
        raise


def opened(path: Path, mode: str = "r") -> Store:
    """Open a store that `create` made; a ValueError says that it is none."""
    zarr = _zarr()
    try:
        group = zarr.open_group(path, mode=mode)
        told = dict(group.attrs)
        shape, block_shape = tuple(told[SHAPE]), tuple(told[BLOCK])
        t_eval = np.asarray(group["time"][...]) if "time" in group else None
        scene, request = read_about(told, t_eval)
        names = ["q0", "qd0", *told[VARY]]
        found = {
            name: (tuple(group[name].metadata.dimension_names or ()), np.asarray(group[name][...]))
            for name in names
        }
        members = members_from(scene, shape, found)
    except (KeyError, TypeError, ValueError, FileNotFoundError):
        raise ValueError(
            f"store = {str(path)!r}: is no store of an ensemble: name another folder"
        ) from None
    except RuntimeError as error:
        raise OSError(
            f"store = {str(path)!r}: its starts cannot be read ({error}): put q0, qd0 and the "
            "varied parameters back from a copy, or remove the store"
        ) from error
    return Store(path, group, members, request, Blocks(shape, block_shape))


def continued(path: Path, members: Members, request: Request) -> Store:
    """Open a store to go on with it. It must be that of the same ensemble and version."""
    store = opened(path, "r+")
    told = about(members.scene, list(members.vary), request)
    for name, value in told.items():
        there = store.group.attrs[name]
        if there != value:
            what = f"pendcore {there}, not {value}" if name == VERSION else _OTHER[name]
            raise ValueError(
                f"store = {str(path)!r}: has results of {what}: results are never mixed; choose "
                "another name, or remove it"
            )
    same = store.members.shape == members.shape and _equal(store.request.t_eval, request.t_eval)
    for one in ("q0", "qd0"):
        same = same and _equal(getattr(store.members, one), getattr(members, one))
    for name, values in members.vary.items():
        same = same and _equal(store.members.vary[name], values)
    if not same:
        raise ValueError(
            f"store = {str(path)!r}: has other starts, parameters or times: results are never "
            "mixed; choose another name, or remove it"
        )
    for left in path.rglob("*.partial"):  # of a block that was not finished
        left.unlink(missing_ok=True)
    return store


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise ImportError("store needs zarr: pip install zarr") from None
    return zarr


def _compressor() -> Any:
    """Return the compressor of all arrays, which knows a chunk that a disk has changed."""
    return _zarr().codecs.ZstdCodec(checksum=True)


def _put(group: zarr.Group, name: str, values: Any, axes: tuple[str, ...], unit: str) -> None:
    attributes = {"units": unit} if unit else {}
    if values.dtype.kind == "U":  # of a fixed length, texts have no specification in Zarr 3
        array: Any = group.create_array(
            name, shape=values.shape, dtype="string", dimension_names=axes, attributes=attributes,
            compressors=_compressor(),
        )  # fmt: skip
        array[...] = values
    else:
        group.create_array(
            name, data=values, dimension_names=axes, attributes=attributes,
            compressors=_compressor(),
        )  # fmt: skip


def _create_array(
    group: zarr.Group, one: Variable, axes: list[str], shape: tuple[int, ...], blocks: Blocks
) -> None:
    attributes: dict[str, Any] = {"units": one.unit} if one.unit else {}
    if one.name == "status":  # as the CF conventions have it
        attributes["flag_values"] = list(range(len(_core.member_statuses)))
        attributes["flag_meanings"] = " ".join(_core.member_statuses)
    group.create_array(
        one.name,
        shape=(*shape, *one.shape),
        chunks=tuple(max(size, 1) for size in (*blocks.block_shape, *one.shape)),
        dtype=np.dtype(one.dtype),
        fill_value=one.fill,
        compressors=_compressor(),
        dimension_names=(*axes, *one.labels),
        attributes=attributes,
    )


def _equal(one: Any, other: Any) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other, equal_nan=True)


@contextmanager
def _named(path: Path) -> Iterator[None]:
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
