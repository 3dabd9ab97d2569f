"""The files of a command, each of which is written even if others cannot be."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pendcore.cli.usage import NotWritten, written
from pendcore.messages import whole_file


class FilesToWrite:
    """Files of a folder, to be written one after the other, each whole or not at all.

    Ctrl-C or an error leaves out the file that is being written; a line on standard error says so
    at once.
    """

    def __init__(self, folder: Path, names: Iterable[str]) -> None:
        self.folder = folder
        self.names = tuple(names)
        self.left_out: list[str] = []
        self._told = written(folder, [folder / name for name in self.names])

    @contextmanager
    def needed_for(self, *names: str) -> Iterator[None]:
        """Leave out these files if the body of the `with` statement is interrupted or fails."""
        try:
            yield
        except (KeyboardInterrupt, Exception) as stop:  # whatever it is, the others are written
            for name in names:
                print(_not_written(self.folder / name, stop), file=sys.stderr)
            self.left_out += names

    @contextmanager
    def one(self, name: str) -> Iterator[Path]:
        """Yield where to write a file."""
        with self.needed_for(name), whole_file(self.folder / name) as path:
            yield path

    def outcome(self) -> str:
        """Return what was written; if all files were, also whether they replaced earlier ones."""
        if not self.left_out:
            return self._told
        done = [name for name in self.names if name not in self.left_out]
        return f"written to {self.folder}: {', '.join(done) or 'nothing'}"

    def refuse_if_none(self) -> None:
        """Raise `NotWritten` if no file was written."""
        if len(self.left_out) == len(self.names):
            raise NotWritten(f"{self.folder}: nothing was written")


@contextmanager
def named_if_lost(path: Path) -> Iterator[None]:
    """Turn what keeps the only file of a command from being written into `NotWritten`.

    Errors of values stay: they are about what was asked for.
    """
    try:
        yield
    except (ValueError, TypeError):
        raise
    except Exception as stop:
        raise NotWritten(_not_written(path, stop)) from stop


def _not_written(path: Path, stop: BaseException) -> str:
    why = f"{type(stop).__name__}: {stop}"
    if isinstance(stop, OSError):
        why = stop.strerror or str(stop)
    if isinstance(stop, KeyboardInterrupt):
        why = "interrupted"
    earlier = "; the earlier one is still there" if path.is_file() else ""
    return f"{path}: not written: {why}{earlier}"
