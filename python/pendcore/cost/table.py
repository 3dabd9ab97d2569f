"""The table of a sweep, for people."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import shorten, wrap
from typing import TYPE_CHECKING

from pendcore.cost.point import Point

if TYPE_CHECKING:
    from pendcore.cost.accuracy_cost import AccuracyCost

_UNITS = ((1e-3, 1e6, "us"), (1.0, 1e3, "ms"), (float("inf"), 1.0, "s"))


def duration(seconds: float) -> str:
    """Return a time in three digits and the unit that suits it."""
    for below, factor, unit in _UNITS:
        if seconds < below:
            return f"{seconds * factor:.3g} {unit}"
    return "-"


def text(cost: AccuracyCost, error: float = 1e-6) -> str:
    """Return everything that was measured, and what to take for an error."""
    start, end = cost.t_span
    head = [
        f"What accuracy costs: {cost.name or 'chain of links'}, {start:.6g} ... {end:.6g} s",
        *_wrapped(
            "error",
            f"largest distance of a joint or the tip from the reference at {cost.times} times, "
            "as a share of the total length",
        ),
        *_wrapped("reference", f"{cost.references[0]}; the other way round {cost.references[1]}"),
        *_wrapped("uncertainty", f"{cost.uncertainty:.1e}: the distance of the two"),
        *_wrapped("time", cost.timed),
        *_wrapped("machine", cost.machine),
    ]
    for remark in cost.remarks:
        head += _wrapped("note", remark)
    return "\n".join([*head, "", *_rows(cost), "", *wrap(cost.sentence(error), 96)]) + "\n"


def _rows(cost: AccuracyCost) -> Iterator[str]:
    best = cost.pareto()
    yield "    method   setting           error      time    median  right-hand sides    steps"
    for point in cost.points:
        mark = "*" if point in best else " "
        yield f"  {mark} {_row(point)}"
    yield "  * no other is both more accurate and faster"
    if any(point.method == "taylor" and not point.failure for point in cost.points):
        yield "  of taylor it is series that are counted, each as long as many right-hand sides"


def _row(point: Point) -> str:
    name = f"{point.method:8} {point.setting:14}"
    if point.failure:
        return f"{name} {shorten(point.failure, 76, placeholder=' ...')}"
    times = f"{duration(point.seconds):>9} {duration(point.median):>9}"
    return f"{name} {point.error:8.1e} {times} {point.nfev:17d} {point.accepted:8d}"


def _wrapped(name: str, sentence: str) -> list[str]:
    first, *more = wrap(sentence, 82)
    return [f"  {name:11} {first}", *(f"{'':14}{line}" for line in more)]
