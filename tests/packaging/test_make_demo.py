"""The first command of the README, as far as it can be read without running it."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_make_demo_says_what_takes_long_where_the_command_is_and_brings_what_comes_next() -> None:
    told = subprocess.run(
        ["make", "--always-make", "--dry-run", "demo"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert "compiles the core" in told
    assert ".venv/bin/pendcore --help" in told
    assert "requirements.py run symbolic" in told, "pendcore derive, which comes next, needs SymPy"
