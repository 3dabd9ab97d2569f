"""What a digit is worth: seconds of validity against the work that they take.

In a chaotic motion an error e grows like e exp(lambda t). So a run that is right to one more digit
is right for ln(10)/lambda seconds longer, whatever the method; what the digit costs depends on it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import inf, nan
from textwrap import wrap
from time import monotonic, perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore.accuracy.estimate import ErrorEstimate, error_estimate
from pendcore.accuracy.run import Choice, Start, atol_beside, carries, forget_inner_runs, run
from pendcore.arguments import known_keywords, numbers, positive, time_limit_of, time_span
from pendcore.horizon.lyapunov import LyapunovExponents, lyapunov
from pendcore.methods import has_error_estimate, known_methods, methods_named
from pendcore.progress import Progress, callback, close
from pendcore.scene import Scene, require_start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

METHODS = ("dopri5", "dop853", "taylor")
"""That are tried where the scene can be carried by them."""
RTOLS = tuple(10.0**-k for k in range(3, 15))
TIGHT = 1e-14
"""rtol of the exponent: it is to follow the true motion for as long as any of the runs."""
REPEATS = 5
"""Runs that are timed; the quickest counts."""


class HorizonPoint(NamedTuple):
    """One method at one tolerance.

    Attributes
    ----------
    method : str
    rtol : float
    valid : float
        s, from the start to where the estimated error passes the limit.
    seconds : float
        s of computing that a run takes so far, nothing stored.
    nfev : int
        Its right-hand sides.
    early : float
        rad, the error at the time ``HorizonWork.early``.
    """

    method: str
    rtol: float
    valid: float
    seconds: float
    nfev: int
    early: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HorizonWork:
    """What `horizon_work` found.

    Attributes
    ----------
    limit : float
        rad, of the error of the angles.
    t_span : (float, float)
        s.
    points : tuple of HorizonPoint
        A method after the other, from loose to tight.
    early : float
        s after the start, the shortest of the horizons: where the errors of all runs are compared.
    growth : LyapunovExponents or None
        How fast neighbours part between the shortest and the longest of the horizons; None where
        exponents mean nothing (dry friction, stops), where the horizons are one, and of what was
        stopped before.
    refusal : str
        Why there is no exponent, where it was refused; else empty.
    untried : tuple of (str, float)
        The methods and tolerances that were left when the time was up, or at an interrupt.
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
        """ln(10)/exponent, s: what one more right digit is worth; inf where nothing grows."""
        return float(np.log(10)) / self.exponent if self.exponent > 0 else inf

    @property
    def methods(self) -> list[str]:
        """Names of the methods, as they come."""
        return list(dict.fromkeys(point.method for point in self.points))

    def of(self, method: str) -> list[HorizonPoint]:
        """Return the points of a method."""
        return [point for point in self.points if point.method == method]

    def is_to_the_end(self, point: HorizonPoint) -> bool:
        """Whether a point is valid to the end of the span: a longer one may find more."""
        return point.valid >= abs(self.t_span[1] - self.t_span[0])

    def measured(self, method: str) -> float:
        """Return the slope that the points of a method have: s for each digit that is right early.

        A line through those whose horizon lies within the run, by least squares; NaN of fewer than
        three. Of one start it scatters by a tenth about ``seconds_a_digit``: neighbours do not part
        evenly.
        """
        inside = [p for p in self.of(method) if not self.is_to_the_end(p) and p.early > 0]
        if len(inside) < 3:
            return nan
        digits = -np.log10([point.early for point in inside])
        return float(np.polyfit(digits, [point.valid for point in inside], 1)[0])

    def plot(self) -> Figure:
        """Draw seconds of validity against digits and against work; see `pendcore.views.horizon`.

        Returns a new figure of pyplot's.
        """
        from pendcore.views.horizon import plot_work

        return plot_work(self)

    def __str__(self) -> str:
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
        rows: dict[str, list[str]] = {}
        for method, rtol in self.untried:
            rows.setdefault(method, []).append(f"{rtol:.0e}")
        tried = self.methods
        return ", ".join(
            f"{method} at rtol {', '.join(rtols)}" if method in tried else method
            for method, rtols in rows.items()
        )


@known_keywords
def horizon_work(
    scene: Scene,
    q0: npt.ArrayLike | None = None,
    qd0: npt.ArrayLike = 0.0,
    t_span: Iterable[float] | None = None,
    *,
    limit: float = 0.1,
    methods: str | Iterable[str] | None = None,
    rtols: npt.ArrayLike = RTOLS,
    time_limit: float = 60.0,
    progress: Progress = None,
) -> HorizonWork:
    """Measure how long runs of a scene are to be trusted, and what that costs.

    Parameters
    ----------
    scene, q0, qd0, t_span
        As in `simulate`. Take a span that is longer than any run stays right: up to thirty
        Lyapunov times.
    limit : float
        rad; a run counts as valid until the error of an angle passes it.
    methods : str or iterable of str, optional
        Of those that choose their steps, but not ``"auto"``, which is a rule. Default: dopri5,
        dop853 and taylor, where the scene can be carried by them.
    rtols : array_like, (k,)
        Tolerances, > 0 and < 1, each with an ``atol`` of a thousandth.
    time_limit : float
        s of the clock, after which no further point is begun.
    progress
        As in `simulate`.

    Returns
    -------
    HorizonWork
        With ``.points``, ``.exponent``, ``.seconds_a_digit`` and ``.plot()``.

    Raises
    ------
    ValueError, TypeError
        If an argument is not what is asked for.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's function
        With what was found so far as the attribute ``work``.
    """
    q0 = require_start(scene, q0)
    start = Start(scene, q0, qd0, *time_span(t_span))
    _nothing(start, "dopri5")  # checks what it starts from
    limit = positive("limit", limit, "rad")
    names = _methods(methods, start)
    tolerances = numbers("rtols", rtols, "")
    if not tolerances or not all(0 < rtol < 1 for rtol in tolerances):
        raise ValueError(f"rtols = {rtols!r}: must hold a tolerance, and each be > 0 and < 1")
    choices = [Choice(method, r, atol_beside(r)) for method in names for r in tolerances]
    until = monotonic() + time_limit_of(time_limit)
    report = callback(progress, "measuring")
    found: list[tuple[ErrorEstimate, HorizonPoint]] = []
    try:
        for done, choice in enumerate(choices):
            if monotonic() > until:
                break
            if report is not None:
                report(done / len(choices))
            found.append(_point(start, choice, limit))
        work = _work(start, limit, choices, found)
        try:
            return replace(work, growth=_growth(start, work))
        except ValueError as refusal:  # dry friction, stops: what jumps has none
            return replace(work, refusal=str(refusal))
    except BaseException as stopped:
        forget_inner_runs(stopped)
        stopped.work = _work(start, limit, choices, found)  # type: ignore[attr-defined]
        raise
    finally:
        close(report)


def _nothing(start: Start, method: str) -> None:
    """Run no length at all: it is refused where the start is, or the method."""
    run(start._replace(t_end=start.t_start), Choice(method, 1e-6, 1e-9), store="end")


def _methods(given: Iterable[str] | str | None, start: Start) -> list[str]:
    """Return the methods to try, by their own names, each once."""
    if given is None:
        return [method for method in METHODS if carries(method, start)]
    names = methods_named(given)
    for method in names:
        if not has_error_estimate(method):
            known = [name for name in known_methods() if has_error_estimate(name)]
            raise ValueError(
                f"methods: {method!r} takes fixed steps and has no tolerance to vary: must be of "
                f"{', '.join(known)}; pendcore.accuracy_cost measures it too"
            )
        _nothing(start, method)
    return names


def _point(start: Start, choice: Choice, limit: float) -> tuple[ErrorEstimate, HorizonPoint]:
    error = error_estimate(run(start, choice), progress=False)
    valid = error.valid_until(limit)
    so_far = start._replace(t_end=valid)
    seconds, nfev = inf, 0
    for _ in range(REPEATS):
        began = perf_counter()
        made = run(so_far, choice, store="end")
        seconds = min(seconds, perf_counter() - began)
        nfev = made.stats.nfev
    rtol, horizon = float(np.min(choice.rtol)), abs(valid - start.t_start)
    return error, HorizonPoint(choice.method, rtol, horizon, seconds, nfev, nan)


def _work(
    start: Start,
    limit: float,
    choices: list[Choice],
    found: list[tuple[ErrorEstimate, HorizonPoint]],
) -> HorizonWork:
    """Return what the points tell; the exponent is yet to come."""
    early = min((point.valid for _, point in found), default=0.0)
    points = [
        point._replace(early=float(error.angle[np.abs(error.t - start.t_start) <= early].max()))
        for error, point in found
    ]
    span = start.t_start, start.t_end
    untried = tuple((one.method, float(np.min(one.rtol))) for one in choices[len(found) :])
    return HorizonWork(
        limit=limit, t_span=span, points=tuple(points), early=early, growth=None, untried=untried
    )


def _growth(start: Start, work: HorizonWork) -> LyapunovExponents | None:
    """Return how fast neighbours part between the shortest and the longest of the horizons."""
    longest = max((point.valid for point in work.points), default=0.0)
    if not longest > work.early:
        return None
    end = start.t_start + np.copysign(longest, start.t_end - start.t_start)
    return lyapunov(
        start.scene, start.q0, start.qd0, (start.t_start, end), count=1, transient=work.early,
        rtol=TIGHT, atol=atol_beside(TIGHT), progress=False,
    )  # fmt: skip
