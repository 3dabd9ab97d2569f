"""Writes the pages of the Python reference: one for each public name, from its docstring."""

from __future__ import annotations

import inspect
from importlib import import_module
from pathlib import Path
from typing import Any

import pendcore

GROUPS = {
    "Scenes": ["Scene", "Link", "Linearization", "Mobility", "Explanation"],
    "Runs": [
        "simulate", "Solution", "Statistics", "EventSensitivities", "ExtremeSensitivities",
        "RunError", "PendcoreWarning",
    ],
    "Many runs at once": ["ensemble", "Ensemble"],
    "What a run can be trusted for": [
        "Accuracy", "AccuracyError", "ErrorEstimate", "Defect", "LyapunovExponents", "lyapunov",
        "HorizonWork", "horizon_work", "AccuracyCost", "accuracy_cost",
    ],
    "Equilibria and periodic orbits": [
        "equilibria", "Equilibrium", "periodic_orbit", "PeriodicOrbit", "Manifold", "connections",
        "Connection",
    ],
    "Energies and forces": ["Energy", "Ledger", "LargestReaction"],
    "Cases and files": ["Case", "read_case", "load"],
    "Angles": ["angles_from_vertical", "angles_to_vertical"],
}  # fmt: skip

MODULES = {
    "Effects": "effects",
    "Events": "events",
    "What ensembles keep": "reducers",
    "Random starts": "sampling",
    "Methods": "methods",
    "Options of a run": "options",
    "Figures": "plotting",
    "For extras: messages, checks, files": "messages",
    "For extras: case files": "case_files",
    "This build": "build",
}
"""The last are for those who build on pendcore."""


def callables(module: Any) -> list[str]:
    """Return the functions and classes that a module offers."""
    own = {name: getattr(module, name) for name in module.__all__}
    return [name for name, x in own.items() if inspect.isclass(x) or inspect.isroutine(x)]


def write(folder: Path) -> None:
    folder.mkdir(parents=True)
    listed = {name for names in GROUPS.values() for name in names}
    if differing := listed ^ {*callables(pendcore)}:
        raise ValueError(f"GROUPS and pendcore.__all__ differ in {differing}")
    sections = [(title, "pendcore", names) for title, names in GROUPS.items()]
    for title, module in MODULES.items():
        offered = callables(import_module(f"pendcore.{module}"))
        own = [name for name in offered if name not in listed]
        sections.append((title, f"pendcore.{module}", own))
    lines = ["Python", "======", "", "Everything public, from the docstrings.", ""]
    options = ["   :toctree: .", "   :template: page", "   :nosignatures:"]
    for title, module, names in sections:
        lines += [title, "-" * len(title), "", ".. autosummary::", *options]
        lines += [f"   :caption: {title}", "", *(f"   ~{module}.{name}" for name in names), ""]
    (folder / "index.rst").write_text("\n".join(lines))
