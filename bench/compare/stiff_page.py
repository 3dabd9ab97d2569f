"""The record of stiff scenes as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

from typing import Any

from tables import Record, number, table
from work_precision import Point, time_at

ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
OWN, PEERS = "radau5", ("scipy_numba", "scipy_python")
SHOWN = 1e-6

PAGE = """# Stiff scenes

Made by `make compare`; the raw figures are in [stiff.json](stiff.json). Do not edit: run again.

![Error against time on three stiff scenes](stiff.png)

Two rods of 1 kg and 1 m for 5 s, released from rest; in joint 2 a damper, a spring or a controller
that is far faster than the pendulum. The error is the largest distance of joints and tip from a
reference of SciPy's, as a share of the total length, at 101 times. Times are those of the call in
Python, the least of {rounds} or of as many as 2 s hold. Steps count the rejected ones.

{scenes}
## Who took part, and on what

{contenders}

{machine}
"""


def curve(points: list[dict[str, Any]], kind: str) -> list[Point]:
    return [(one["error"], one[kind]) for one in points if "error" in one]


def at_equal_error(scene: dict[str, Any], labels: dict[str, str]) -> str:
    """Tabulate steps and times of radau5 at equal errors, and their ratios to SciPy's."""
    header = ["achieved error", "steps", "us"]
    for peer in PEERS:
        header += [f"{labels[peer]}: steps", "ratio", "us", "ratio"]
    rows = []
    for error in ERRORS:
        mine = [time_at(curve(scene["points"][OWN], kind), error) for kind in KINDS]
        cells = [f"{error:.0e}", *map(number, mine)]
        for peer in PEERS:
            for own, kind in zip(mine, KINDS, strict=True):
                other = time_at(curve(scene["points"][peer], kind), error)
                ratio = own / other if own and other else None
                cells += [number(other), f"**{number(ratio)}**" if ratio else "—"]
        rows.append(cells)
    return table(header, rows)


KINDS = ("steps", "microseconds")


def at_tolerance(scene: dict[str, Any], labels: dict[str, str]) -> str:
    rows = []
    for name, points in scene["points"].items():
        for one in points:
            if abs(one["tolerance"] / SHOWN - 1) < 1e-9:
                error = f"{one['error']:.1e}" if "error" in one else "did not finish"
                rows.append([labels[name], error, str(one["steps"]), number(one["microseconds"])])
    return table(["at rtol = atol = 1e-6", "error", "steps", "us"], rows)


def said(scene: dict[str, Any]) -> str:
    """What dopri5 says of its run, at the tightest tolerance."""
    return f"> dopri5: {scene['points']['dopri5'][-1]['message']}\n"


def page(record: Record) -> str:
    labels = {one["name"]: one["label"] for one in record["contenders"]}
    scenes = [
        "\n".join(
            [
                f"## {scene['label']}\n",
                at_equal_error(scene, labels),
                at_tolerance(scene, labels),
                said(scene),
            ]
        )
        for scene in record["scenes"]
    ]
    return PAGE.format(
        rounds=record["rounds"],
        scenes="\n".join(scenes),
        contenders="\n".join(f"* {one['label']}: {one['about']}" for one in record["contenders"]),
        machine="\n".join(f"* {key}: {value}" for key, value in record["machine"].items()),
    )


def summary(record: Record) -> str:
    """Sum up in a line a scene: the worst ratios to the quicker of SciPy's two."""
    lines = []
    for scene in record["scenes"]:
        worst = []
        for kind in KINDS:
            ratios = [
                own / other
                for error in ERRORS
                for own in [time_at(curve(scene["points"][OWN], kind), error)]
                for other in [time_at(curve(scene["points"]["scipy_numba"], kind), error)]
                if own and other
            ]
            worst.append(number(max(ratios)) if ratios else "—")
        lines.append(f"{scene['label']}: steps x {worst[0]}, time x {worst[1]} of SciPy's at worst")
    return "\n".join(lines)
