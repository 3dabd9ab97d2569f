"""The command, run in a folder of its own."""

from __future__ import annotations

from collections import namedtuple

import pytest
from pendcore.cli import main

Told = namedtuple("Told", "status out err")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def pendcore(folder, capsys):
    """Run `pendcore` with the words of a line, in an empty folder; return what it told."""

    def run(line):
        capsys.readouterr()
        status = main(line.split())
        return Told(status, *capsys.readouterr())

    return run
