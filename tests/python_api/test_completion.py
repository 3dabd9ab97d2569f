"""A shell completes the words of `pendcore`; its script comes from the command itself."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pendcore.cli import main

pytest.importorskip("argcomplete")


def completions(line: str, folder: Path) -> set[str]:
    """Return what a shell that asks how a line goes on is told."""
    told = folder / "told"
    asked = {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(told),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "COMP_TYPE": "9",
    }
    subprocess.run([sys.executable, "-m", "pendcore"], env=os.environ | asked, check=True)
    return {word.strip() for word in told.read_text().split("\n")}


@pytest.mark.outside_build
@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("pendcore ", {"run", "explain", "plot", "trust", "cost", "derive", "completion"}),
        ("pendcore co", {"cost", "completion"}),
        ("pendcore run --no", {"--no-horizon"}),
        ("pendcore completion ", {"bash", "zsh", "fish"}),
    ],
)
def test_a_line_is_completed(line: str, words: set[str], tmp_path: Path) -> None:
    assert words <= completions(line, tmp_path)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_has_its_script(shell: str, capsys: Any) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert "pendcore" in script
    assert "_ARGCOMPLETE" in script


def test_without_the_library_the_remedy_is_named(monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setitem(sys.modules, "argcomplete", None)
    assert main(["completion", "bash"]) == 2
    assert "pip install argcomplete" in capsys.readouterr().err
