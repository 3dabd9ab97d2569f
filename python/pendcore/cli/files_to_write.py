"""The files of a command, each of which is written even if others cannot be."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pendcore.cases.whole_file import whole_file
from pendcore.cli.usage import written


class FilesToWrite:
    """Files of a folder, to be written one after the other, each whole or not at all.

    Ctrl-C or an error of the system leaves out the file that is being written; a line on standard
    error says so at once.
    """

    def __init__(self, folder: Path, names: Iterable[str]) -> None:
        self.folder = folder
        self.names = tuple(names)
        self.left_out: list[str] = []
        self._told = written(folder, [folder / name for name in self.names])
        self._last: BaseException | None = None

    @contextmanager
    def needed_for(self, *names: str) -> Iterator[None]:
        """Leave out these files if the body of the `with` statement is interrupted or fails."""
        try:
            yield
        except (KeyboardInterrupt, OSError) as stop:
            why = (stop.strerror or stop) if isinstance(stop, OSError) else "interrupted"
            for name in names:
                path = self.folder / name
                earlier = "; the earlier one is still there" if path.exists() else ""
                print(f"{path}: not written: {why}{earlier}", file=sys.stderr)
            self.left_out += names
            self._last = stop

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
        """Raise what kept the last file from being written, if none was written."""
        if self._last is not None and len(self.left_out) == len(self.names):
            raise self._last
