"""Print requirements that pyproject.toml lists, one a line: of `build`, `run`, or of an extra.

With `--lowest`, the lowest version that fulfils each.
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())
listed = {
    "build": pyproject["build-system"]["requires"],
    "run": pyproject["project"]["dependencies"],
    **pyproject["project"]["optional-dependencies"],
}

names = [name for name in sys.argv[1:] if name != "--lowest"]
lines = "\n".join(requirement for name in names for requirement in listed[name])
print(re.sub(r">=([\d.]+).*", r"==\1", lines) if "--lowest" in sys.argv else lines)
