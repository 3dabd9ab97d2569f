"""When a run shows how far it is: after a second, on a terminal, unless told otherwise."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from tqdm import tqdm

Progress: TypeAlias = bool | Callable[[float], object] | None
"""None: a bar after a second, on a terminal. True: a bar at once. A callable gets the fraction."""

PATIENCE = 1.0
"""How long a run takes before a bar is drawn that nobody asked for, s."""


class ProgressBar:
    """A bar on standard error, drawn once a run on a terminal has taken a while.

    It costs a run nothing before its first call, which the core makes after 50 ms.
    """

    at_once = False
    """Whether it was asked for: it is then drawn at once, wherever standard error goes."""
    what = "simulating"
    """What the bar says is done."""
    count, unit = 100, "%"
    """What it counts, and how many there are."""
    _since: float | None = None
    bar: tqdm[Any] | None = None

    def __call__(self, fraction: float) -> None:
        if self._since is None:  # only people look at bars
            self._since = monotonic() if self.at_once or sys.stderr.isatty() else inf
        if not self.at_once and monotonic() - self._since < PATIENCE:
            return
        if self.bar is None:
            self.bar = _new_bar(self.what, self.count, self.unit)
        self.bar.update(self.count * fraction - self.bar.n)

    def close(self) -> None:
        """End the line of the bar, if there is one."""
        if self.bar is not None:
            self.bar.close()


def _new_bar(what: str, count: int, unit: str) -> tqdm[Any]:
    from tqdm import tqdm  # slow to import: a short run does not owe that

    layout = "{desc} {percentage:3.0f} % |{bar}| {elapsed}, {remaining} to go"
    if unit != ProgressBar.unit:
        layout += ", {rate_noinv_fmt}"
    return tqdm(total=count, desc=what, bar_format=layout, unit=f" {unit}", file=sys.stderr)


def callback(
    progress: Progress, what: str = "simulating", count: int = 100, unit: str = "%"
) -> Callable[[float], object] | None:
    """Return what the core is to call, or None; a bar says what is done, and how fast."""
    if progress is None or progress is True:
        bar = ProgressBar()
        bar.at_once = bool(progress)
        bar.what, bar.count, bar.unit = what, count, unit
        return bar
    if progress is False:
        return None
    if not callable(progress):
        wanted = "must be None, True, False, or a function of a fraction"
        raise TypeError(f"progress = {progress!r}: {wanted}")
    return progress


def close(report: Callable[[float], object] | None) -> None:
    """End the bar, where what was called is one of ours."""
    if isinstance(report, ProgressBar):
        report.close()


def part_of(
    report: Callable[[float], object], begin: float, share: float
) -> Callable[[float], object]:
    """Return what reports the progress of a part of a whole, which begins there."""
    return lambda fraction: report(begin + share * fraction)


@contextmanager
def reporting(
    progress: Progress, what: str, count: int = 100, unit: str = "%"
) -> Iterator[Callable[[float], object]]:
    """Yield what takes the fraction done, and end its bar; see `callback`."""
    report = callback(progress, what, count, unit)
    try:
        # A list that is called is false while it is empty.
        yield (lambda fraction: None) if report is None else report
    finally:
        close(report)
