"""The command, run in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from pendcore.cli import main


class Told(NamedTuple):
    """What a command ended with, and what it printed."""

    status: int
    out: str
    err: str


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def pendcore(folder: Path, capsys: pytest.CaptureFixture[str]) -> Callable[[str], Told]:
    """Run `pendcore` with the words of a line, in an empty folder."""

    def run(line: str) -> Told:
        capsys.readouterr()
        status = main(line.split())
        return Told(status, *capsys.readouterr())

    return run
