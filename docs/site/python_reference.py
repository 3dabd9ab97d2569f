"""Writes the pages of the Python reference: one for each public name, from its docstring."""

from __future__ import annotations

import inspect
import shutil
from pathlib import Path
from typing import Any

import pendcore
from pendcore import (
    build,
    case_files,
    effects,
    events,
    messages,
    methods,
    options,
    plotting,
    reducers,
    sampling,
)

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


EXTENDED_BY = {
    "Methods": methods,
    "Options of a run": options,
    "Figures": plotting,
    "For extras: messages, checks, files": messages,
    "For extras: case files": case_files,
    "This build": build,
}
"""Modules for those who build on pendcore."""


def callables(module: Any) -> list[str]:
    """Return the functions and classes of a module that `pendcore` itself does not offer."""
    own = {name: getattr(module, name) for name in module.__all__ if name not in pendcore.__all__}
    return [name for name, x in own.items() if inspect.isclass(x) or inspect.isroutine(x)]


def public_names() -> set[str]:
    """Return what `pendcore` offers, without its modules."""
    modules = {"effects", "events", "reducers", "sampling"}
    return {*pendcore.__all__} - modules - {"__version__"}


def write(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    listed = {name for names in GROUPS.values() for name in names}
    if listed != public_names():
        raise ValueError(f"GROUPS and pendcore.__all__ differ in {listed ^ public_names()}")
    sections = [
        *((title, "pendcore", names) for title, names in GROUPS.items()),
        ("Effects", "pendcore.effects", effects.__all__),
        ("Events", "pendcore.events", events.__all__),
        ("What ensembles keep", "pendcore.reducers", reducers.__all__),
        ("Random starts", "pendcore.sampling", sampling.__all__),
        *((title, module.__name__, callables(module)) for title, module in EXTENDED_BY.items()),
    ]
    lines = ["Python", "======", "", "Everything public, from the docstrings.", ""]
    options = ["   :toctree: .", "   :template: page", "   :nosignatures:"]
    for title, module, names in sections:
        lines += [title, "-" * len(title), "", ".. autosummary::", *options]
        lines += [f"   :caption: {title}", "", *(f"   ~{module}.{name}" for name in names), ""]
    (folder / "index.rst").write_text("\n".join(lines))
