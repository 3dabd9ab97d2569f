"""Draws docs/figures/defect.png: the torque that is missing over time, for a few methods."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from pendcore.plotting import LIGHT, grid, legend_above, new_axes, sheet

plt.style.use(sheet())

START = [np.pi / 4, np.pi / 3]
RUNS = [
    ("dopri5", 1e-6, "-", LIGHT.lost),
    ("dopri5", 1e-9, "-", LIGHT.quiet),
    ("dop853", 1e-9, "--", LIGHT.red),
    ("taylor", 1e-13, ":", LIGHT.blue),
]


def draw() -> plt.Figure:
    """Draw each step's largest torque at any joint, in a step plot of the textbook's case."""
    scene = pc.Scene.textbook()
    (axes,) = new_axes((7, 4.2))
    for method, rtol, style, color in RUNS:
        sol = pc.simulate(scene, (0, 5), START, method=method, rtol=rtol, atol=rtol)
        found = sol.defect()
        edges = np.append(found.t, sol.t[-1])
        label = f"{method}, rtol = atol = {rtol:.0e}"
        axes.stairs(
            found.torque.max(axis=1), edges, baseline=None, ls=style, color=color, label=label
        )
    axes.set(yscale="log", xlim=(0, 5), xlabel="t (s)", ylabel="torque that is missing (N m)")
    weight = found.weight
    share = axes.secondary_yaxis("right", functions=(lambda x: x / weight, lambda x: x * weight))
    share.set_ylabel("share of m g L")
    grid(axes)
    legend_above(axes)
    return axes.figure


if __name__ == "__main__":
    draw().savefig(Path(__file__).parents[1] / "figures" / "defect.png", dpi=150)
