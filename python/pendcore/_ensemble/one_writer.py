"""A store has one run at a time that writes into it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform != "win32":
    import fcntl

_held: set[int] = set()
"""Descriptors of the folders that this process holds."""


@contextmanager
def one_writer(path: Path) -> Iterator[None]:
    """Hold a store; an OSError says that another run of this machine holds it.

    The system lets go of it when this process ends, however it ends. A file system that knows no
    such locks lets everyone in.
    """
    if sys.platform == "win32":
        yield
        return
    descriptor = os.open(path, os.O_RDONLY)
    _held.add(descriptor)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise other_writer(path) from None
        except OSError:  # this file system has no such locks
            pass
        yield
    finally:
        if descriptor in _held:  # not in a process that was forked meanwhile
            _held.remove(descriptor)
            with suppress(OSError):  # a worker that has just been forked may not have closed it yet
                fcntl.flock(descriptor, fcntl.LOCK_UN)
            os.close(descriptor)


def other_writer(path: Path) -> OSError:
    """Return the error that another run is writing a store."""
    return OSError(
        f"store = {str(path)!r}: another run is writing it: wait until that has ended, or choose "
        "another name"
    )


def _let_go() -> None:
    """Close what a forked process has inherited: it would hold the store longer than its parent."""
    for descriptor in _held:
        os.close(descriptor)
    _held.clear()


if sys.platform != "win32":
    os.register_at_fork(after_in_child=_let_go)
