"""Error against time on the stiff scenes, a panel each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from stiff_page import curve

COLORS = {
    "radau5": "#000000",
    "auto": "#888888",
    "dopri5": "#d1495b",
    "scipy_numba": "#6fa8d6",
    "scipy_python": "#2a6f97",
}


def draw(record: dict[str, Any], path: Path) -> None:
    """Draw a panel a scene; a run that did not finish has no point."""
    scenes = record["scenes"]
    figure, panels = plt.subplots(
        1, len(scenes), figsize=(4 * len(scenes), 3.8), sharey=True, layout="constrained"
    )
    for panel, scene in zip(panels, scenes, strict=True):
        for contender in record["contenders"]:
            name = contender["name"]
            points = curve(scene["points"][name], "microseconds")
            if points:
                errors, times = zip(*points, strict=True)
                panel.loglog(errors, times, "o-", ms=3, color=COLORS[name])
        panel.set_title(scene["label"], fontsize=9)
        panel.set_xlabel("largest position error / length")
        panel.invert_xaxis()
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("microseconds a call")
    labels = {one["name"]: one["label"] for one in record["contenders"]}
    lines = [
        Line2D([], [], color=COLORS[name], marker="o", ms=3, label=labels[name]) for name in labels
    ]
    figure.legend(handles=lines, loc="outside lower center", ncols=len(lines), fontsize=8)
    figure.savefig(path, dpi=150)
    plt.close(figure)
