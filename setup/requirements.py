"""Print requirements that pyproject.toml lists, one a line: of `build`, or of an extra."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())
extras = pyproject["project"]["optional-dependencies"]

for name in sys.argv[1:]:
    listed = pyproject["build-system"]["requires"] if name == "build" else extras[name]
    print("\n".join(listed))
