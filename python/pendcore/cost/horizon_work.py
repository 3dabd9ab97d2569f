"""The horizons of runs against their work: as numbers, as a table, as a figure."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from math import inf, nan
from operator import itemgetter
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from pendcore import LyapunovExponents
from pendcore.cost.runs import line_style
from pendcore.plotting import grid, new_axes, theme_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NARROW, FEW_DECADES = 6, 200
"""Axes that span a smaller factor than these show few one-digit numbers, or few powers of ten."""


class HorizonPoint(NamedTuple):
    """One method at one tolerance.

    Attributes
    ----------
    method : str
    rtol : float
    valid : float
        s, from the start to where the estimated error passes the limit.
    seconds : float
        s of computing that a run takes to its horizon, with nothing stored.
    nfev : int
        The number of right-hand sides of that run.
    early : float
        rad, the largest error up to the time ``HorizonWork.early``.
    """

    method: str
    rtol: float
    valid: float
    seconds: float
    nfev: int
    early: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class HorizonWork:
    """The result of `horizon_work`.

    Attributes
    ----------
    limit : float
        rad, the limit of the error of the angles.
    t_span : (float, float)
        s.
    points : tuple of HorizonPoint
        One method after the other, from loose to tight tolerances.
    early : float
        The shortest of the horizons, s after the start, where the errors of all runs are compared.
    growth : LyapunovExponents or None
        How fast neighbours part between the shortest and the longest of the horizons. None where
        exponents mean nothing (dry friction, stops), where all horizons are equal, and where the
        work was stopped before.
    refusal : str
        Why the exponent was refused; else empty.
    untried : tuple of (str, float)
        The methods and tolerances that were left when the time was up or the work was interrupted.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> rtols = [1e-3, 1e-9]
    >>> work = pc.horizon_work(scene, (0, 40), 0.0, methods="taylor", rtols=rtols)
    >>> f"a digit more is worth {work.seconds_a_digit:.1f} s"
    'a digit more is worth 2.5 s'
    """

    limit: float
    t_span: tuple[float, float]
    points: tuple[HorizonPoint, ...]
    early: float
    growth: LyapunovExponents | None
    refusal: str = ""
    untried: tuple[tuple[str, float], ...] = ()

    @property
    def exponent(self) -> float:
        """The largest Lyapunov exponent between these horizons, 1/s; NaN where there is none."""
        return nan if self.growth is None else self.growth.largest

    @property
    def seconds_a_digit(self) -> float:
        """ln(10)/exponent, s: the time that one more right digit buys; inf if no error grows."""
        return inf if self.growth is None else self.growth.seconds_a_digit

    @property
    def methods(self) -> list[str]:
        """Names of the methods, in the order of the points."""
        return list(dict.fromkeys(point.method for point in self.points))

    def of(self, method: str) -> list[HorizonPoint]:
        """Return the points of a method."""
        return [point for point in self.points if point.method == method]

    def is_to_the_end(self, point: HorizonPoint) -> bool:
        """Whether a point is valid to the end of the span: a longer span may find more."""
        return point.valid >= abs(self.t_span[1] - self.t_span[0])

    def measured(self, method: str) -> float:
        """Return the slope of a method's points: s of horizon per right digit of the early error.

        It is fitted by least squares to the points whose horizon lies within the run; NaN for fewer
        than three. For a single start it scatters by a tenth about ``seconds_a_digit``, as
        neighbours do not part evenly.
        """
        inside = [p for p in self.of(method) if not self.is_to_the_end(p) and p.early > 0]
        if len(inside) < 3:
            return nan
        digits = -np.log10([point.early for point in inside])
        return float(np.polyfit(digits, [point.valid for point in inside], 1)[0])

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw seconds of validity against digits and against work; return the figure.

        ``figure`` is an empty one of matplotlib's. Default: a new one of pyplot's.
        """
        if figure is None:
            by_digits, by_cost = new_axes((9.6, 4.2), columns=2, sharey=True)
            figure = cast("Figure", by_digits.figure)
        else:
            by_digits, by_cost = figure.subplots(1, 2, sharey=True)
        theme = theme_of(by_digits)
        hollow: dict[str, Any] = {"linestyle": "", "markerfacecolor": theme.ground, "zorder": 3}
        for method in self.methods:
            how = {**line_style(method, theme), "markersize": 5}
            _draw(by_digits, by_cost, self.of(method), {"label": method, **how})
            if to_the_end := [point for point in self.of(method) if self.is_to_the_end(point)]:
                _draw(by_digits, by_cost, to_the_end, {**how, **hollow})
        if self.growth is not None:
            _as_neighbours_part(by_digits, self)
        if any(self.is_to_the_end(point) for point in self.points):
            hollow |= {"color": theme.ink, "marker": "o", "label": "hollow: to the end"}
            by_digits.plot([], [], **hollow)
        by_digits.invert_xaxis()
        by_digits.set_xlabel(f"error of the angles in the first {self.early:.2g} s (rad)")
        by_digits.set_ylabel(f"time until an angle is off by {self.limit:g} rad (s)")
        by_cost.set_xlabel("computing time for these seconds (\N{MICRO SIGN}s)")
        for axis in (by_digits, by_cost):
            axis.set_xscale("log")
            axis.set_ylim(bottom=0)
            grid(axis)
            _few_ticks(axis)
        _, names = by_digits.get_legend_handles_labels()
        figure.legend(loc="outside upper center", ncols=len(names), frameon=False)
        return figure

    def __repr__(self) -> str:
        lines = [f"how long the angles stay within {self.limit:g} rad"]
        lines.append(f"{'method':<8} {'rtol':>7} {'valid':>9} {'computing':>12}")
        for point in self.points:
            lines.append(
                f"{point.method:<8} {point.rtol:>7.0e} {point.valid:>7.2f} s "
                f"{1e6 * point.seconds:>9.0f} us{'  to the end' * self.is_to_the_end(point)}"
            )
        if self.exponent > 0:
            lines.append(
                f"Lyapunov exponent {self.exponent:.3g}/s: a digit more is worth "
                f"{self.seconds_a_digit:.2g} s"
            )
        if self.refusal:
            lines += wrap(f"no Lyapunov exponent: {self.refusal.partition(';')[0]}", 96)
        if self.untried:
            lines += wrap(f"not tried before it was stopped: {self._untried_by_method()}", 96)
        return "\n".join(lines)

    def _untried_by_method(self) -> str:
        told = []
        for method, pairs in groupby(self.untried, key=itemgetter(0)):
            rtols = ", ".join(f"{rtol:.0e}" for _, rtol in pairs)
            told.append(f"{method} at rtol {rtols}" if method in self.methods else method)
        return ", ".join(told)


def _draw(by_digits: Axes, by_cost: Axes, points: list[HorizonPoint], how: dict[str, Any]) -> None:
    """Draw points on both axes; the legend is that of the first."""
    valid = [point.valid for point in points]
    by_digits.plot([point.early for point in points], valid, **how)
    by_cost.plot([1e6 * point.seconds for point in points], valid, **how | {"label": None})


def _few_ticks(axis: Axes) -> None:
    """Label a few round numbers where an axis shows hardly any powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

    low, high = sorted(axis.get_xlim())
    if 0 < high < FEW_DECADES * low:
        some = LogLocator(subs=(1, 3), numticks=20)
        axis.xaxis.set_major_locator(MaxNLocator(4) if high < NARROW * low else some)
        axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axis.xaxis.set_minor_formatter(NullFormatter())


def _as_neighbours_part(axis: Axes, work: HorizonWork) -> None:
    """Draw how the early error of a run depends on its horizon by the variational equations.

    Their curve has a free factor, for which the median of the points is taken.
    """
    assert work.growth is not None
    horizons = np.abs(work.growth.t - work.t_span[0])
    grown = np.maximum.accumulate(work.growth.growth[:, 0])
    at_points = np.interp([point.valid for point in work.points], horizons, grown)
    known = np.array([point.early > 0 for point in work.points])
    early = np.log([point.early for point in work.points if point.early > 0])
    label = rf"as neighbours part: ln(10)/$\lambda$ = {work.seconds_a_digit:.2f} s a digit"
    band: dict[str, Any] = {"color": "0.5", "linewidth": 4, "alpha": 0.5, "zorder": 1}
    axis.plot(np.exp(np.median(early + at_points[known]) - grown), horizons, label=label, **band)
