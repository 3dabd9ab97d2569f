"""Solutions on disk: NumPy's npz, readable without pendcore, and without pickle.

Entries: ``t``, ``q``, ``qd``, ``y`` (as in `Solution`), ``case`` (TOML), ``statistics`` (JSON),
``version``, ``sensitivities`` and their names, where they were asked for, ``accuracy`` (JSON) and
``error.*`` (how far off it is) where an error was asked for, and ``run.*``, from which the whole
object comes back: interpolants, and what is needed to resume.
"""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

from pendcore import _core
from pendcore._cases.case import refuse_functions
from pendcore._cases.case_file import case_from_text
from pendcore._cases.npz import Entries, entries_of
from pendcore._cases.whole_file import whole_file
from pendcore._messages.progress import Progress, reporting
from pendcore._messages.warning import silence
from pendcore._run.accuracy import Accuracy
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution
from pendcore._scene.link import Link
from pendcore._scene.scene import Scene
from pendcore.effects import KINDS, made

_RUN, _ERROR = "run.", "error."
_KEEP = ": keep the numbers, sol.to_pandas() or numpy.savez(path, t=sol.t, y=sol.y)"


def save(solution: Solution, path: str | os.PathLike[str], *, progress: Progress = None) -> None:
    """Write a solution to the file ``path``, under just that name, and not before it is whole."""
    refuse_functions(solution.scene, solution.events_asked_for(), "saved", _KEEP)
    entries: dict[str, Any] = {
        "t": solution.t,
        "q": solution.q,
        "qd": solution.qd,
        "y": solution.y,
        "case": solution.case().to_toml(),
        "statistics": json.dumps(solution.stats._asdict()),
        "version": _core.__version__,
    }
    if solution.accuracy is not None:
        entries["accuracy"] = json.dumps(solution.accuracy.to_dict())
        if (error := solution.known_error) is not None:
            entries |= {_ERROR + one.name: getattr(error, one.name) for one in fields(error)}
    if solution.sensitivities is not None:
        entries["sensitivities"] = solution.sensitivities
        entries["sensitivity_names"] = solution.sensitivity_names
    with reporting(progress, f"writing {os.fspath(path)}") as report:
        state = {_RUN + key: value for key, value in solution._run.__getstate__().items()}
        with whole_file(path) as name, name.open("wb") as file:
            _write(file, entries | state, report)


def _write(file: BinaryIO, entries: dict[str, Any], report: Callable[[float], object]) -> None:
    """Write arrays as `numpy.savez` does, and report the share that is written."""
    arrays = {key: np.asanyarray(value) for key, value in entries.items()}
    told = _Told(report, sum(array.nbytes for array in arrays.values()))
    with zipfile.ZipFile(file, "w") as archive:
        for key, array in arrays.items():
            with archive.open(f"{key}.npy", "w", force_zip64=True) as told.entry:
                np.lib.format.write_array(told, array, allow_pickle=False)


class _Told:
    """An entry of an archive that reports the share of all that is written, piece by piece."""

    entry: IO[bytes]

    def __init__(self, report: Callable[[float], object], whole: int) -> None:
        self.report = report
        self.whole = whole
        self.written = 0

    def write(self, piece: bytes) -> None:
        """Write a piece, and report."""
        self.entry.write(piece)
        self.written += len(piece)
        self.report(min(self.written / self.whole, 1.0))  # the heads of the arrays count as well


def load(path: str | os.PathLike[str]) -> Solution:
    """Read what `save` wrote; see `pendcore.load`."""
    with Path(path).open("rb") as file:
        try:
            with entries_of(file) as entries:
                return _loaded(entries)
        except Exception as error:  # whatever a damaged file makes of zip, npy, TOML or the core
            if Path(path).suffix == ".toml":
                raise ValueError(
                    f"{path}: is a case, not a solution: `pendcore run` solves and saves it, "
                    "`pendcore show` draws it, pc.read_case reads it"
                ) from None
            raise ValueError(f"{path}: is not a solution that pendcore saved ({error})") from None


def _loaded(entries: Entries) -> Solution:
    with silence():  # what is implausible was said when the scene was made
        case = case_from_text(str(entries["case"]), "case")
    state, error = _group(entries, _RUN), _group(entries, _ERROR)
    told = json.loads(str(entries["accuracy"])) if "accuracy" in entries else None
    run = _core.Run.__new__(_core.Run)
    run.__setstate__(state)
    accuracy = None if told is None else Accuracy.from_dict(told)
    verified = ErrorEstimate(**error) if error else None
    solution = Solution(_scene(state), run, case.name, accuracy, verified)
    if "sensitivities" in entries or "sensitivity_names" in entries:
        solution.sensitivities, solution.sensitivity_names = _sensitivities(entries, solution)
    if solution.case() != case:
        raise ValueError("its case is not that of its run")
    return solution


def _sensitivities(entries: Entries, solution: Solution) -> tuple[Any, tuple[str, ...]]:
    """Return the derivatives of a run and their names, or raise an error for what are none."""
    values, names = entries["sensitivities"], entries["sensitivity_names"]
    if names.dtype.kind != "U" or names.ndim != 1:
        raise ValueError("the names of its sensitivities are no texts")
    known = tuple(names.tolist())
    _core.Sensitivities(solution.scene._compiled, list(known))
    if values.dtype != float or values.shape != (*solution.y.T.shape, len(known)):
        raise ValueError("its sensitivities do not fit its states")
    return values, known


def _group(entries: Entries, prefix: str) -> dict[str, Any]:
    """Return the entries under a prefix; numbers and strings are arrays without axes there."""
    found = {key.removeprefix(prefix): entries[key] for key in entries if key.startswith(prefix)}
    return {key: one.item() if one.ndim == 0 else one for key, one in found.items()}


def _scene(state: dict[str, Any]) -> Scene:
    """Return what the run itself moved."""
    names = ("mass", "length", "center", "inertia")
    rows = state["links"].reshape(-1, 4).tolist()
    links = [Link(**dict(zip(names, row, strict=True))) for row in rows]
    effects = [made(KINDS[kind], values) for kind, values in json.loads(state["effects"])]
    return Scene._unpickled(links, state["gravity"], effects)
