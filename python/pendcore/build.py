"""What this build of pendcore is: its version, its compiler, the instruction set that it takes."""

from __future__ import annotations

from pendcore._core import __version__ as version
from pendcore._core import compiler, instruction_set

__all__ = ["compiler", "instruction_set", "version"]
