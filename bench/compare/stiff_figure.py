"""Error against time on the stiff scenes, in a panel each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from equal_error import Record
from figure import LEFT_OUT, draw_contender
from matplotlib.ticker import LogLocator, NullFormatter


def draw(record: Record, path: Path) -> None:
    """Draw a panel for each scene; a cross ends a line if tighter settings failed or never ran."""
    scenes = record["scenes"]
    drawn, panels = plt.subplots(
        1, len(scenes), figsize=(4.4 * len(scenes), 5.4), sharey=True, layout="constrained"
    )
    for panel, scene in zip(panels, scenes, strict=True):
        for contender in scene["contenders"]:
            if "compiled_v3" not in contender["sides"] and not all(
                word in contender["name"] for word in LEFT_OUT
            ):
                draw_contender(panel, contender, by_language=True)
        panel.set(xscale="log", yscale="log", xlim=(1e-1, 1e-9))
        panel.set_title(scene["label"], fontsize=9)
        panel.set_xlabel("largest position error / length")
        panel.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.grid(color="0.88", linewidth=0.6)
    panels[0].set_ylabel("time of a solve / \N{MICRO SIGN}s")
    by_label: dict[Any, Any] = {}
    for panel in panels:
        handles, labels = panel.get_legend_handles_labels()
        by_label |= dict(zip(labels, handles, strict=True))
    drawn.legend(
        list(by_label.values()),
        list(by_label),
        loc="outside lower center",
        ncols=5,
        fontsize=8,
        frameon=False,
    )
    drawn.savefig(path, dpi=150)
    plt.close(drawn)
