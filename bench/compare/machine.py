"""The machine on which figures were measured, without which they mean nothing."""

from __future__ import annotations

import datetime
import os
import platform
import time
from pathlib import Path
from typing import Any

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
    """Name the set that pendcore chose here, or that PENDCORE_INSTRUCTION_SET prescribes."""
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


def circumstances(begin: float, rounds: int, burst_seconds: float) -> dict[str, Any]:
    """Say when and how a record was measured; `begin` is the performance counter's at its start."""
    return {
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "rounds": rounds,
        "burst_seconds": burst_seconds,
        "seconds_in_all": round(time.perf_counter() - begin, 1),
        "machine": machine(),
    }
