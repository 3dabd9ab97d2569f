"""How the programs are drawn in the figures of the hard cases."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes

from hard_cases.cases import PROGRAMS

# Colours differ in lightness, and dashes differ, so that the figures survive a grey printer.
STYLES: dict[str, dict[str, Any]] = {
    "pendcore": {"color": "#000000", "linestyle": "-", "linewidth": 2.0},
    "scipy": {"color": "#8a8a8a", "linestyle": "-.", "linewidth": 1.4},
    "mujoco": {"color": "#d1495b", "linestyle": "--", "linewidth": 1.4},
    "odeint": {"color": "#6fa8d6", "linestyle": ":", "linewidth": 2.0},
}


def label(one: Any) -> str:
    """Name a contender in a legend."""
    return f"{PROGRAMS[one['program']]}: {one['how'].replace('`', '')}"


def dress(axes: Axes) -> None:
    axes.grid(color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
