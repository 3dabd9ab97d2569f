"""A store has one run at a time that writes into it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]


@contextmanager
def one_writer(path: Path) -> Iterator[None]:
    """Hold a store; an OSError says that another run of this machine holds it.

    The system lets go of it when this process ends, however it ends. A file system that knows no
    such locks lets everyone in.
    """
    if fcntl is None:
        yield
        return
    folder = os.open(path, os.O_RDONLY)
    try:
        _lock(folder, path)
        try:
            yield
        finally:  # a process that this one made may still have the folder open
            with suppress(OSError):
                fcntl.flock(folder, fcntl.LOCK_UN)
    finally:
        os.close(folder)


def _lock(folder: int, path: Path) -> None:
    try:
        fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise is_being_written(path) from None
    except OSError:  # this file system has no such locks
        pass


def is_being_written(path: Path) -> OSError:
    """Return the error that another run is writing a store."""
    return OSError(
        f"store = {str(path)!r}: another run is writing it: wait until that has ended, or choose "
        "another name"
    )
