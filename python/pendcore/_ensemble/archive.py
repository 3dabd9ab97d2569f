"""An ensemble in one file: NumPy's npz, readable without pendcore."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from pendcore._cases.npz import Entries, entries_of
from pendcore._cases.whole_file import whole_file
from pendcore._ensemble.about import SHAPE, VARY, about, read_about, read_sizes, require
from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.members import coordinates, members_from
from pendcore._ensemble.run import SUMMED

ENTRY = "ensemble"
"""The entry with everything that is no array, in JSON."""


def save(found: Ensemble, path: str | os.PathLike[str]) -> None:
    """Write an ensemble to a file, under just that name, and not before it is whole."""
    if Path(path).suffix == ".zarr":
        raise ValueError(
            f"path = {os.fspath(path)!r}: a file of npz is written, which would not be a store: "
            'name it .npz, or compute with pc.ensemble(store="NAME.zarr")'
        )
    members, request = found.members, found.request
    starts = coordinates(members)
    told = about(members.scene, list(members.vary), request) | {
        "shape": members.shape,
        "axes": {one.name: one.axes for one in starts},
        "ending": found.ending,
        "statistics": found.statistics,
    }
    arrays = {one.name: one.values for one in starts}
    arrays |= {name: np.asarray(values[...]) for name, values in found.arrays.items()}
    if request.t_eval is not None:
        arrays["time"] = request.t_eval
    entries: dict[str, Any] = {ENTRY: np.array(json.dumps(told))} | arrays
    with whole_file(path) as name, name.open("wb") as file:
        np.savez(file, **entries)


def is_ensemble(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is an npz file with an ensemble."""
    try:
        with Path(path).open("rb") as file, entries_of(file) as entries:
            return ENTRY in entries
    except Exception:  # whatever a damaged file makes of zip and npy
        return False


def load(path: str | os.PathLike[str]) -> Ensemble:
    """Read what `save` wrote."""
    try:
        with Path(path).open("rb") as file, entries_of(file) as entries:
            return _loaded(entries)
    except Exception as error:  # whatever a damaged file makes of zip, npy, JSON or TOML
        raise ValueError(f"{path}: is no ensemble that pendcore saved ({error})") from None


def _loaded(entries: Entries) -> Ensemble:
    told = json.loads(str(entries[ENTRY]))
    if not isinstance(told, dict):
        raise ValueError(f"{ENTRY}: must be a table")
    shape = read_sizes(told, SHAPE, 0)
    scene, request = read_about(told, entries.get("time"))
    endings = ("finished", "time_limit", "interrupted")
    require(told, "ending", told.get("ending") in endings, f"one of {', '.join(endings)}")
    statistics: Any = told.get("statistics")
    axes: Any = told.get("axes")
    keys = {*statistics} if isinstance(statistics, dict) else {""}
    require(told, "statistics", keys in ({*()}, {*SUMMED}), f"of {', '.join(SUMMED)}, or nothing")
    names = ["q0", "qd0", *told[VARY]]
    has_all = isinstance(axes, dict) and all(isinstance(axes.get(name), list) for name in names)
    require(told, "axes", has_all, f"lists of axes of {', '.join(names)}")
    starts = {name: (tuple(axes[name]), entries[name]) for name in names}
    for name, (_, values) in starts.items():
        if values.dtype != np.float64:
            raise ValueError(f"{name} is of type {values.dtype}: must be float64")
    members = members_from(scene, shape, starts)
    arrays = {}
    for one in request.variables(len(scene.links)):
        found = arrays[one.name] = entries[one.name]
        if found.shape != (*shape, *one.shape) or found.dtype != one.dtype:
            raise ValueError(f"{one.name} has another shape or type than that of the members")
    return Ensemble(members, request, arrays, told["ending"], statistics)
