"""Print requirements that pyproject.toml lists, one a line: of `build`, `run`, or of an extra."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())
listed = {
    "build": pyproject["build-system"]["requires"],
    "run": pyproject["project"]["dependencies"],
    **pyproject["project"]["optional-dependencies"],
}

for name in sys.argv[1:]:
    print("\n".join(listed[name]))
