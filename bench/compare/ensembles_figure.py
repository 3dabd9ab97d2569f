"""Error against time of a trajectory, in a panel for each scene."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from equal_error import Record, curve
from matplotlib.ticker import LogLocator, NullFormatter
from work_precision import envelope


def draw(record: Record, path: Path) -> None:
    """Draw pendcore's contenders as whole lines, others dashed."""
    scenes = record["scenes"]
    drawn, panels = plt.subplots(
        1, len(scenes), figsize=(4.4 * len(scenes), 5.0), sharey=True, layout="constrained"
    )
    for panel, scene in zip(panels, scenes, strict=True):
        for k, one in enumerate(scene["contenders"]):
            if not one["points"]:
                continue
            style = "-" if one["ours"] else "--"
            points = zip(*envelope(curve(one)), strict=True)
            panel.plot(*points, style, marker=".", color=f"C{k}", label=one["label"])
        panel.set(xscale="log", yscale="log", xlim=(1e-1, 1e-14))
        panel.set_title(scene["label"], fontsize=9)
        panel.set_xlabel("median position error / length")
        panel.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.grid(color="0.88", linewidth=0.6)
    panels[0].set_ylabel("time of a trajectory / \N{MICRO SIGN}s")
    handles, labels = panels[0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    drawn.savefig(path, dpi=150)
    plt.close(drawn)
