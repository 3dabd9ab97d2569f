"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield the name under which to write a file; it gets its own when all of it is written.

    If that fails or is interrupted, no new file is left, and an earlier file of that name stays as
    it was. Threads and processes that write to one path do not meet: the last to end has it. An
    `OSError` names the file, also where the system does not (a full disk). Devices and
    pipes, and files in a folder that takes no new ones, are written in place.
    """
    path = Path(path)
    end = path.resolve()
    in_place = (path.exists() and not path.is_file()) or not os.access(end.parent, os.W_OK)
    name = path if in_place else end.with_name(f"{end.stem[:40]}.{uuid4().hex}.part{end.suffix}")
    try:
        yield name
        if not in_place:
            name.replace(end)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(name)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        if not in_place:
            name.unlink(missing_ok=True)
