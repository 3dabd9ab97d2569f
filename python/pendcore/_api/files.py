"""Functions that read solutions and cases from files."""

from __future__ import annotations

import os
from pathlib import Path

from pendcore._cases import archive
from pendcore._cases.case import Case
from pendcore._cases.case_file import case_from_text, text_of
from pendcore._ensemble.archive import is_ensemble
from pendcore._ensemble.archive import load as load_ensemble
from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.store import opened
from pendcore._messages.warning import warn
from pendcore._run.solution import Solution


def load(path: str | os.PathLike[str]) -> Solution | Ensemble:
    """Read a solution or an ensemble that was saved.

    Parameters
    ----------
    path : path
        A file that `Solution.save` or `Ensemble.save` wrote, or the folder of an ensemble's store.

    Returns
    -------
    Solution or Ensemble
        With every number of the saved one to the last bit; a solution evaluates and resumes as
        that did. The arrays of a store are read when they are asked for.

    Raises
    ------
    ValueError
        If it is neither.
    OSError
        If the file cannot be read.

    Warns
    -----
    PendcoreWarning
        If members of a store were not run yet, or files of theirs are missing.

    Examples
    --------
    >>> sol = pc.Case.textbook().simulate()
    >>> sol.save("run.npz")
    >>> longer = pc.load("run.npz").resume(10.0)
    >>> f"to {longer.t[-1]:.0f} s"
    'to 10 s'
    """
    if Path(path).is_dir():
        return _from_store(Path(path))
    if is_ensemble(path):
        return load_ensemble(path)
    return archive.load(path)


def read_case(source: str | os.PathLike[str]) -> Case:
    """Read a case from TOML.

    Parameters
    ----------
    source : path or str
        A file, or the text itself: a string with a line break is text.

    Returns
    -------
    Case

    Raises
    ------
    ValueError
        If the text is not TOML, a key is unknown or missing, or a value is not what its key asks
        for. The message names the line and, for an unknown key, the nearest known one.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> with open("textbook.toml", "w") as file:
    ...     size = file.write(pc.Case.textbook().to_toml())
    >>> pc.read_case("textbook.toml") == pc.Case.textbook()
    True
    """
    if isinstance(source, str) and "\n" in source:
        return case_from_text(source, "case")
    return case_from_text(text_of(Path(source)), str(source))


def _from_store(path: Path) -> Ensemble:
    store = opened(path)
    found = Ensemble(store.members, store.request, store.arrays)
    missing, first_file = store.not_done()
    if missing:
        found.ending = "interrupted"
        warn(
            f"{path}: {missing} of {len(found)} members were not run, or files of theirs are "
            f"missing, the first of them is {first_file}: repeat the call of pc.ensemble that made "
            "the store to run them"
        )
    return found
