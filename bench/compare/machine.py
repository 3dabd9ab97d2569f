"""On what the figures were measured: without it they mean nothing."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import numpy as np


def processor() -> str:
    """Name the processor with family and model, as the kernel knows it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    lines = (line.split(":", 1) for line in text.splitlines() if ":" in line)
    facts = {key.strip(): value.strip() for key, value in lines}
    name = facts.get("model name", platform.machine())
    return f"{name} (family {facts.get('cpu family', '?')}, model {facts.get('model', '?')})"


def instruction_set() -> str:
    """Name the one that pendcore chose here, or was told by PENDCORE_INSTRUCTION_SET."""
    try:
        from pendcore import _core
    except ImportError:
        return "unknown"
    return str(_core.instruction_set())


def machine() -> dict[str, str | int | None]:
    """Collect processor, system and versions, by name."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "architecture": platform.machine(),
        "system": platform.freedesktop_os_release()["PRETTY_NAME"],
        "python": platform.python_version(),
        "numpy": np.__version__,
        "instruction set of pendcore": instruction_set(),
    }
