"""The figures of right-hand sides, of chains and with effects, drawn from the record alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from figures import GOAL, circumstances, plt, save
from forward_tables import CORE, PEER, STEP, added, effects_of, of_links, share
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from pendcore.plotting import LIGHT
from record import Record

# The lines of chains, each of the best of the contenders whose names begin so.
CHAINS: dict[str, tuple[str, dict[str, Any]]] = {
    CORE: ("pendcore", {"color": LIGHT.ink, "linestyle": "-", "marker": "o", "linewidth": 2.2}),
    "pinocchio": (
        "Pinocchio's ABA, the best of its ways",
        {"color": LIGHT.red, "linestyle": "--", "marker": "^"},
    ),
    "mujoco": (
        "MuJoCo, the best of its ways",
        {"color": LIGHT.blue, "linestyle": "-.", "marker": "s"},
    ),
    STEP: (
        "pendcore, in a step of dopri5",
        {"color": LIGHT.quiet, "linestyle": ":", "marker": ".", "linewidth": 1.4},
    ),
}


def least(record: Record, start: str, metric: str) -> list[tuple[int, float]]:
    """List (n, the least value of the contenders of that name, or of a peer's beginning)."""
    best: dict[int, float] = {}
    for name in record.contenders:
        if name == start or (name.startswith(start) and not start.startswith(CORE)):
            for n, value in of_links(record, name, metric).items():
                best[n] = min(best.get(n, float("inf")), value)
    return sorted(best.items())


def draw_chains(record: Record, path: Path) -> None:
    """Draw time and memory against the number of links, all axes logarithmic."""
    drawn, both = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
    for axes, metric, shown in zip(both, ("minimum_ns", "bytes"), (4, 3), strict=True):
        for start, (label, how) in list(CHAINS.items())[:shown]:
            line = least(record, start, metric)
            if not line:
                continue
            axes.plot(*zip(*line, strict=True), label=label, markersize=5, **how)
            axes.set(xscale="log", yscale="log")
            if start == CORE:  # a guide through the last point, of growth in proportion to n
                (first, _), (n, value) = line[0], line[-1]
                guide: dict[str, Any] = {"color": LIGHT.lost, "linewidth": 0.8, "zorder": 0}
                axes.plot([first, n], [value * first / n, value], **guide)
                middle = (first * n) ** 0.5
                words: dict[str, Any] = {"textcoords": "offset points", "fontsize": 8}
                at = (middle, value * middle / n)
                axes.annotate("proportional to n", at, (8, -12), color=LIGHT.quiet, **words)
        axes.set_xlabel("number of links n")
        axes.grid(which="major", color=LIGHT.line, linewidth=0.6)
    if both[0].lines:
        both[0].legend(loc="upper left", frameon=False, fontsize=9)
    both[0].set_ylabel("time of a right-hand side (ns)")
    both[1].set_ylabel("memory of its equations (bytes)")
    drawn.suptitle("Forward dynamics of a planar chain of n links, C++", fontsize=11)
    drawn.text(0.01, -0.03, circumstances(record), fontsize=7, color=LIGHT.quiet)
    save(drawn, path, 160, bbox_inches="tight")


BARS = {
    STEP: ("pendcore, in a step", LIGHT.ink, 0.2),
    PEER: ("MuJoCo, mj_forward", LIGHT.teal, -0.2),
}
BAR = 0.36
LEAST = 0.2  # ns; smaller values, and those lost in the noise, are drawn as this


def draw_effects(record: Record, path: Path) -> None:
    """Draw what each effect adds, and for pendcore the instructions, with what is promised.

    A bar ends with what is added and its share of the bare scene; a stroke across its row is the
    most that pendcore promises.
    """
    found = list(effects_of(record).items())[::-1]
    drawn, (times, instructions) = plt.subplots(
        1, 2, figsize=(11, 0.44 * len(found) + 1.7), width_ratios=(2.2, 1), sharey=True,
        layout="constrained",
    )  # fmt: skip

    def write(axes: Axes, x: float, y: float, text: str, color: str = "0") -> None:
        axes.text(x, y, f" {text}", fontsize=7, va="center", color=color)

    def stroke(axes: Axes, most: float | None, place: float) -> None:
        if most is not None:
            axes.plot([most, most], [place - BAR / 2, place + BAR / 2], color=GOAL)

    for place, (name, facts) in enumerate(found):
        for side, (_, color, offset) in BARS.items():
            more, part = added(record, name, side), share(record, name, side)
            if more is None or part is None:
                words = "not yet" if side == STEP else "has none"
                write(times, LEAST, place + offset, words, "0.5")
                continue
            length, most = max(more, LEAST), facts["most_ns"] if side == STEP else None
            times.barh(place + offset, length - LEAST, BAR, left=LEAST, color=color)
            text = f"{more:+.1f} ns ({part:+.0%})" if more > LEAST else "nothing seen"
            write(times, max(length, most or 0.0), place + offset, text)
            stroke(times, most, place + offset)
        counted = added(record, name, STEP, "instructions")
        if counted is None:
            write(instructions, 0.0, place, "not counted" if facts["ours"] else "not yet", "0.5")
            continue
        most = facts["most_instructions"]
        instructions.barh(place, max(counted, 0.0), BAR, color=BARS[STEP][1])
        write(instructions, max(counted, most or 0, 0.0), place, f"{counted:+.0f}")
        stroke(instructions, most, place)
    times.set(xscale="log", xlim=(LEAST, 8000), ylim=(-0.6, len(found) - 0.4))
    times.set_xlabel("added to a right-hand side (ns)\n(in parentheses: of the side's bare scene)")
    times.set_yticks(range(len(found)), [facts["label"] for _, facts in found], fontsize=9)
    instructions.set_xlim(0, 1.2 * max(instructions.get_xlim()[1], 200.0))
    instructions.set_xlabel("added to a right-hand side\nin a step (instructions)")
    instructions.tick_params(left=False)
    for axes in (times, instructions):
        axes.grid(axis="x", which="major", color=LIGHT.line, linewidth=0.6)
        axes.set_axisbelow(True)
    drawn.suptitle("What an effect adds to the right-hand side of two links, C++", fontsize=11)
    known = [Patch(color=color, label=label) for label, color, _ in BARS.values()]
    goal = Line2D([], [], color=GOAL, label="promised: at most")
    drawn.legend(handles=[*known, goal], loc="outside lower right", ncols=3, frameon=False)
    drawn.text(0.01, 0.01, circumstances(record), fontsize=7, color=LIGHT.quiet)
    save(drawn, path, 160, bbox_inches="tight")
