"""An ensemble in one file: NumPy's npz, readable without pendcore."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pendcore.cases.whole_file import whole_file
from pendcore.ensemble.about import VARY, about, read_about
from pendcore.ensemble.coordinates import coordinates, members_from
from pendcore.ensemble.result import EnsembleResult

ENTRY = "ensemble"
"""The entry with everything that is no array, in JSON."""


def save(found: EnsembleResult, path: str | os.PathLike[str]) -> None:
    """Write an ensemble to a file, under just that name, and not before it is whole."""
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
    with whole_file(path) as name, name.open("wb") as file:
        np.savez(file, **{ENTRY: np.array(json.dumps(told))}, **arrays)  # type: ignore[arg-type]


def is_ensemble(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is an npz file with an ensemble."""
    try:
        with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as entries:
            return ENTRY in entries
    except Exception:  # whatever a damaged file makes of zip and npy
        return False


def load(path: str | os.PathLike[str]) -> EnsembleResult:
    """Read what `save` wrote."""
    try:
        with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as entries:
            return _loaded({name: entries[name] for name in entries})
    except Exception as error:  # whatever a damaged file makes of zip, npy, JSON or TOML
        raise ValueError(f"{path}: is no ensemble that pendcore saved ({error})") from None


def _loaded(entries: Mapping[str, Any]) -> EnsembleResult:
    told = json.loads(str(entries[ENTRY]))
    scene, request = read_about(told, entries.get("time"))
    names = ["q0", "qd0", *told[VARY]]
    found = {name: (tuple(told["axes"][name]), entries[name]) for name in names}
    members = members_from(scene, tuple(told["shape"]), found)
    variables = request.variables(len(scene.links))
    arrays = {one.name: entries[one.name] for one in variables}
    for one in variables:
        if arrays[one.name].shape != (*members.shape, *one.shape):
            raise ValueError(f"{one.name} has another shape than the members")
    return EnsembleResult(members, request, arrays, told["ending"], told["statistics"])
