"""Results on disk, block by block: a group of Zarr 3, which xarray reads.

Each variable of the result is an array whose chunks are the blocks of the ensemble. A block counts
as done if all of its files are there. A store holds neither times of day nor names of machines: two
runs of one ensemble write the same bytes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np

from pendcore._ensemble import about
from pendcore._ensemble.blocks import Block, Blocks, require_few_blocks, size_of
from pendcore._ensemble.members import Index, Members, member_axes, members_from
from pendcore._ensemble.new_store import create, named, zarr_module
from pendcore._ensemble.one_writer import one_writer
from pendcore._ensemble.request import Request, Variable
from pendcore._ensemble.run import Arrays
from pendcore._ensemble.stored_array import StoredArray, file_of, is_there, moved
from pendcore._ensemble.stored_metadata import DOCUMENT, attributes_of, axes_of

_OTHER = {
    about.CASE: "another scene, or other options or events",
    about.KEEP: "other reducers",
    about.VARY: "other parameters that vary",
}


@dataclass(frozen=True, slots=True, eq=False)
class Store:
    """A store that is open; `opened` makes one."""

    path: Path
    place: Path
    """The folder as it was named, and where it is."""
    told: dict[str, Any]
    """The attributes of the group."""
    members: Members
    request: Request
    blocks: Blocks
    """What was asked for, and into which blocks its members are cut."""
    zarr_arrays: dict[str, Any]
    """The arrays of the result, the status first."""
    folder: os.stat_result
    """The folder that was opened."""

    @property
    def arrays(self) -> dict[str, StoredArray]:
        """Return the arrays of the result, which read from the disk when they are indexed."""
        found, status = self.zarr_arrays.items(), self.zarr_arrays["status"]
        return {name: StoredArray(self.path, self.place, one, status) for name, one in found}

    def not_done(self) -> tuple[int, str]:
        """Return the number of members whose files are missing, and the first missing file.

        Nothing is read.
        """
        arrays = self.zarr_arrays.values()
        if all(one.nchunks_initialized == one.nchunks for one in arrays):
            return 0, ""
        lost = [(block, files) for block in self.blocks if (files := [*self._missing(block)])]
        first_file = lost[0][1][0] if lost else ""
        return sum(size_of(block) for block, _ in lost), first_file

    def is_done(self, block: Block) -> bool:
        """Return whether all files of a block are there."""
        return not any(self._missing(block))

    def _missing(self, block: Block) -> Iterator[str]:
        files = _files(self.zarr_arrays, block)
        return (file for file in files if not (self.place / file).exists())

    def write(self, block: Block, arrays: Arrays) -> None:
        """Write the results of a block."""
        self.require_there()
        _write(self.path, self.place, lambda: self.zarr_arrays, block, arrays)

    def remove_unfinished(self) -> None:
        """Remove the files of blocks that nobody finished: a worker died while it wrote them."""
        for left in self.place.rglob("*.partial"):
            left.unlink(missing_ok=True)

    def require_there(self) -> None:
        """Raise an OSError if the folder that was opened is no longer under its name."""
        if not is_there(self.place) or not os.path.samestat(self.place.stat(), self.folder):
            raise moved(self.path)

    def require_all(self) -> None:
        """Raise an OSError if files are missing, now that every block was written."""
        self.require_there()
        self.remove_unfinished()
        lost_members, first_file = self.not_done()
        if lost_members:
            raise OSError(
                f"store = {str(self.path)!r}: files of {lost_members} of {self.members.count} "
                f"members are gone, the first of them is {first_file}: something removed them "
                "while it was written; the same call computes these members again"
            )


def write_block(path: Path, variables: list[Variable], block: Block, arrays: Arrays) -> None:
    """Write the results of a block into a store, without reading the rest of it."""

    def opened() -> dict[str, Any]:
        return {one.name: _zarr_array(path, one.name, "r+") for one in variables}

    _write(path, path, opened, block, arrays)


def _write(
    path: Path, place: Path, opened: Callable[[], dict[str, Any]], block: Block, arrays: Arrays
) -> None:
    """See that a store is there before and after it is written: Zarr would make folders anew."""
    if not is_there(place):
        raise moved(path)
    files: list[str] = []
    try:
        with named(path):
            zarr_arrays = opened()
            files = _files(zarr_arrays, block)
            for name in reversed(zarr_arrays):  # the status is the first, and is written last
                zarr_arrays[name][block] = arrays[name]
    except Exception as error:
        if is_there(place) and not isinstance(error, FileNotFoundError):
            raise
        raise moved(path) from error
    finally:
        if not is_there(place):
            _take_back(place, files)
    if not is_there(place):
        raise moved(path)


def _take_back(place: Path, files: list[str]) -> None:
    """Remove files, and the folders down to the place itself that hold nothing else."""
    for name in files:
        with suppress(OSError):
            (place / name).unlink(missing_ok=True)
        with suppress(OSError):
            for folder in Path(name).parents:
                (place / folder).rmdir()
    with suppress(OSError):  # Zarr makes it anew when it opens it, before any file
        place.rmdir()


def _files(zarr_arrays: dict[str, Any], block: Block) -> list[str]:
    """Return the names of the files of a block in a store, without arrays that hold nothing."""
    some = [one for one in zarr_arrays.values() if 0 not in one.shape]
    return [file_of(one, _chunk(one, block)) for one in some]


def _chunk(zarr_array: Any, block: Block) -> Index:
    """Return the place of a block among the chunks of an array."""
    sizes = zarr_array.chunks
    first = [one.start for one in block] + [0] * (len(sizes) - len(block))
    return tuple(start // size for start, size in zip(first, sizes, strict=True))


def _zarr_array(path: Path, name: str, mode: str) -> Any:
    """Open an array, which writes chunks of nothing but fill values too: a missing one is lost."""
    zarr = zarr_module()
    try:
        found = zarr.open_array(path, path=name, mode=mode, zarr_format=3)
    except OSError:
        raise
    except Exception as error:  # whatever Zarr makes of a value that it does not expect
        raise ValueError(f"{name}/{DOCUMENT}: {error}") from error
    config = {"write_empty_chunks": True}
    return zarr.Array(zarr.AsyncArray(found.metadata, found.store_path, config=config))


@contextmanager
def store_for(
    path: Path, members: Members, request: Request, chunk: int, time_limit: float
) -> Iterator[Store | None]:
    """Hold the store at a path, to go on with it, or a new one; nothing else may write into it.

    ``chunk`` is the number of members in a block of a new store; 0 leaves it to their work. There
    is none if the limit is too short to know that.
    """
    if path.exists() and not path.is_dir():
        raise FileExistsError(f"store = {str(path)!r}: is a file: choose another name")
    is_new = not path.exists() or not any(path.iterdir())
    if is_new and not create(path, members, request, chunk, time_limit):
        yield None
        return
    with one_writer(path):
        yield opened(path, "r+") if is_new else continued(path, members, request)


def opened(path: Path, mode: str = "r") -> Store:
    """Open a store that `create` made; a ValueError says that it is none, or what is damaged."""
    zarr_module()
    if not (path / DOCUMENT).is_file():
        raise ValueError(f"store = {str(path)!r}: is no store of an ensemble: name another folder")
    try:
        return _opened(path, mode)
    except FileNotFoundError as error:
        told: object = f"{error.filename} is missing"
        cause: Exception = error
    except (RuntimeError, MemoryError) as error:
        raise OSError(
            f"store = {str(path)!r}: its starts cannot be read ({error}): put q0, qd0 and the "
            "varied parameters back from a copy, or remove the store"
        ) from error
    except (KeyError, TypeError, ValueError) as error:
        told = cause = error
    raise ValueError(
        f"store = {str(path)!r}: is no store of an ensemble, or is damaged ({told}): put the file "
        "back from a copy, or name another folder"
    ) from cause


def _opened(path: Path, mode: str) -> Store:
    place = path.resolve()  # whatever becomes the current folder
    told = attributes_of(place)
    shape = about.read_sizes(told, about.SHAPE, 0)
    block_shape = about.read_sizes(told, about.BLOCK, 1)
    if len(shape) != len(block_shape):
        raise ValueError(f"{about.BLOCK} = {list(block_shape)}: must have {len(shape)} numbers")
    blocks = Blocks(shape, block_shape)
    require_few_blocks(blocks)
    t_eval = _read(place, "time", {"time": None})[1] if (place / "time").exists() else None
    scene, request = about.read_about(told, t_eval)
    n, axes = len(scene.links), member_axes(shape)
    lengths: dict[str, int | None] = dict(zip(axes, shape, strict=True))
    found = {name: _read(place, name, lengths | {"link": n}) for name in ("q0", "qd0")}
    found |= {name: _read(place, name, lengths) for name in told[about.VARY]}
    zarr_arrays: dict[str, Any] = {}
    for one in request.variables(n):
        name = PureWindowsPath(one.name)  # it knows the separators of every system
        if name.drive or name.root or ".." in name.parts:
            raise ValueError(f"{about.KEEP}: {one.name!r} is no name of a reducer")
        own = lengths | dict(zip(one.labels, one.shape, strict=True))
        chunk = [max(size, 1) for size in (*block_shape, *one.shape)]
        axes_of(place, one.name, np.dtype(one.dtype).name, own, chunk)
        zarr_arrays[one.name] = _zarr_array(place, one.name, mode)
    members = members_from(scene, shape, found)
    return Store(path, place, told, members, request, blocks, zarr_arrays, place.stat())


def _read(path: Path, name: str, lengths: Mapping[str, int | None]) -> tuple[list[str], Any]:
    """Return axes and values of starts, of a parameter or of times."""
    axes = axes_of(path, name, "float64", lengths)
    values = np.asarray(_zarr_array(path, name, "r")[...])
    if not np.isfinite(values).all():  # so reads a file that is gone
        raise ValueError(f"{name}: a file of it is missing, or it has a value that is not finite")
    return axes, values


def continued(path: Path, members: Members, request: Request) -> Store:
    """Open a store to go on with it. It must be that of the same ensemble and version."""
    store = opened(path, "r+")
    told = about.about(members.scene, list(members.vary), request)
    for name, value in told.items():
        there = store.told[name]
        if there != value:
            what = f"pendcore {there}, not {value}" if name == about.VERSION else _OTHER[name]
            if name == about.CASE:
                old, new = there.splitlines(), value.splitlines()
                was = next((line for line in old if line not in new), "nothing")
                what += f" ({was}, and now {next((x for x in new if x not in old), 'nothing')})"
            raise ValueError(
                f"store = {str(path)!r}: has results of {what}: results are never mixed; choose "
                "another name, or remove it"
            )
    there, here = ({"q0": x.q0, "qd0": x.qd0, **x.vary} for x in (store.members, members))
    same = store.members.shape == members.shape and _equal(store.request.t_eval, request.t_eval)
    same = same and all(_equal(there[name], values) for name, values in here.items())
    if not same:
        raise ValueError(
            f"store = {str(path)!r}: has other starts, parameters or times: results are never "
            "mixed; choose another name, or remove it"
        )
    store.remove_unfinished()
    return store


def _equal(one: Any, other: Any) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other, equal_nan=True)
