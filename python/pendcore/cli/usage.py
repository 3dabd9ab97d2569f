"""Mistakes of the user, told in a line and without a traceback."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile


class UsageError(Exception):
    """The command cannot do what it was asked for; exit status 2."""


class NotWritten(Exception):
    """A file that was asked for is not there; exit status 1."""


@contextmanager
def blamed_on_usage(what: str = "") -> Iterator[None]:
    """Turn errors of files, values and missing packages in the body into `UsageError`."""
    try:
        yield
    except OSError as error:
        told = f"{error.filename}: {error.strerror}" if error.filename else str(error)
        raise UsageError(told) from None
    except (ValueError, TypeError, ModuleNotFoundError) as error:
        raise UsageError(f"{what}: {error}" if what else str(error)) from None


def written(to: Path, files: Iterable[Path]) -> str:
    """Return where files are about to be written, and whether they replace earlier ones."""
    gone = any(file.exists() for file in files)
    return f"written to {to}" + (", earlier files replaced" if gone else "")


@contextmanager
def new_folder(folder: Path) -> Iterator[None]:
    """Make the folder before a run that may take hours, and see that it can be written.

    It is removed if nothing is written.
    """
    new = [path for path in (folder, *folder.parents) if not path.exists()]
    with blamed_on_usage():
        folder.mkdir(parents=True, exist_ok=True)
    try:
        try:
            TemporaryFile(dir=folder).close()
        except OSError as error:
            told = f"{folder}: cannot be written: {error.strerror}: choose another folder"
            raise UsageError(told) from None
        yield
    except BaseException:
        with suppress(OSError):
            for path in new:
                path.rmdir()
        raise
