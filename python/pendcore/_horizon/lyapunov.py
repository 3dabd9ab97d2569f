"""Lyapunov exponents: how fast motions that begin close together part."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._accuracy.position_error import time_grid
from pendcore._messages.arguments import Floats, number, time_span
from pendcore._messages.handed_over import raise_with
from pendcore._messages.progress import Progress, reporting
from pendcore._messages.warning import warn
from pendcore._run.solution import Solution
from pendcore._run.statistics import Statistics
from pendcore._scene.scene import Scene, require_scene
from pendcore.options import RUN_DEFAULTS

if TYPE_CHECKING:
    from matplotlib.lines import Line2D

TIMES = 201
"""The number of times in the result, unless they are given."""
TELLING = 10.0
"""Errors of a regular motion grow in proportion to time: by less than e to this power in 20,000
characteristic times. Growth beyond it tells of an exponent."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LyapunovExponents:
    """The result of `lyapunov`: k exponents at n_t times.

    Attributes
    ----------
    t : ndarray, (n_t,)
        s.
    growth : ndarray, (n_t, k)
        The logarithm of the factors by which the k changes of the state have grown since ``since``,
        without a unit: the length of the first change, then the area of the first two over that
        length, and so on.
    since : float
        The time from which growth counts, s.
    q, qd : ndarray, (n_t, n)
        The motion, rad and rad/s.
    status, message : str
        How the run ended, as of a `Solution`.
    success : bool
        Whether the run reached its end.
    stats : Statistics
        What the run took; ``nfev`` counts right-hand sides, or Taylor series, with all k changes.

    Examples
    --------
    >>> found = pc.lyapunov(pc.Scene.textbook(), (0, 15), 0.0, count=1)
    >>> found.growth.shape, found.finite_time.shape
    ((201, 1), (201, 1))
    >>> f"an error grows by e in {found.time:.2f} s"
    'an error grows by e in 0.98 s'
    """

    t: Floats
    growth: Floats
    since: float
    q: Floats
    qd: Floats
    status: str
    message: str
    success: bool
    stats: Statistics

    @property
    def finite_time(self) -> Floats:
        """Finite-time exponents from ``since`` (NaN there) to each of the times, 1/s, (n_t, k)."""
        with np.errstate(invalid="ignore", divide="ignore"):
            rates: Floats = self.growth / np.abs(self.t - self.since)[:, np.newaxis]
        rates[self.t == self.since] = np.nan
        return rates

    @property
    def exponents(self) -> Floats:
        """The exponents over the whole time, 1/s, (k,), the largest first."""
        if len(self.t) == 0:
            return np.full(self.growth.shape[1], np.nan)
        return np.sort(self.finite_time[-1])[::-1]

    @property
    def largest(self) -> float:
        """The largest exponent, 1/s: above 0 in a chaotic motion, the longer the run the surer.

        NaN if there is none: all joints are locked, or no time has passed.
        """
        return float(self.exponents[0]) if self.exponents.size else nan

    @property
    def time(self) -> float:
        """The Lyapunov time, 1/largest, s, in which an error grows by e; inf if none grows."""
        return 1 / self.largest if self.largest > 0 else inf

    @property
    def seconds_a_digit(self) -> float:
        """ln(10)/largest, s: how much longer a run is right that has one more right digit."""
        return float(np.log(10)) * self.time

    def __repr__(self) -> str:
        if not self.growth.shape[1]:
            return "no Lyapunov exponents: nothing of the scene can move"
        until = f" to {self.t[-1]:.6g} s" if len(self.t) else ", where no time was reached"
        some = [f"{rate:.3g}" for rate in self.exponents[:6]]
        some += ["..."] * (len(some) < self.growth.shape[1])
        told = f"Lyapunov exponents {', '.join(some)} 1/s, from t = {self.since:.6g}{until}"
        if self.time < inf:
            told += f": an error grows by e in {self.time:.3g} s, tenfold in "
            told += f"{self.seconds_a_digit:.3g} s"
            if self.largest * abs(self.t[-1] - self.since) < TELLING:
                told += "; the run is too short to tell this from growth that slows down"
        return told if self.success else f"{told}; {self.status}: {self.message}"

    def plot(self, ax: Any = None, **line_properties: Any) -> list[Line2D]:
        """Draw the finite-time exponents over time, each in its colour.

        ``ax`` is an axes of matplotlib's; the rest are properties of its ``Line2D``.
        """
        from pendcore.plotting.axes import grid, legend_above, new_axes
        from pendcore.plotting.style import theme_of

        (ax,) = new_axes((6.4, 4.0)) if ax is None else (ax,)
        lines: list[Line2D] = []
        for i, values in enumerate(self.finite_time.T):
            ours = {"color": theme_of(ax).link(i), "label": rf"$\lambda_{{{i + 1}}}$"}
            lines += ax.plot(self.t, values, **(ours | line_properties))
        ax.set(xlabel="t (s)", ylabel="Lyapunov exponents (1/s)")
        ax.axhline(0.0, color=theme_of(ax).quiet, linewidth=0.8, zorder=0)
        ax.margins(x=0)
        grid(ax)
        legend_above(ax, columns=len(lines))
        return lines


def lyapunov(
    scene: Scene,
    t_span: Iterable[float],
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike = 0.0,
    *,
    count: int | None = None,
    transient: float = 0.0,
    rtol: float = RUN_DEFAULTS["rtol"],
    atol: float = RUN_DEFAULTS["atol"],
    t_eval: npt.ArrayLike | None = None,
    max_step: float = inf,
    max_steps: int = RUN_DEFAULTS["max_steps"],
    time_limit: float | None = None,
    progress: Progress = None,
) -> LyapunovExponents:
    """Compute the finite-time Lyapunov exponents of a motion.

    Parameters
    ----------
    scene : Scene
        What moves, without dry friction and stops: the motion must not jump.
    q0, qd0 : array_like, (n,)
        Absolute angles and rates at the start, rad and rad/s.
    t_span : (float, float)
        Start and end, s. Changes that shrink forward in time grow backward.
    count : int, optional
        How many exponents to compute, the largest first. Default: the whole spectrum, 2n less 2 for
        each locked joint, so none if all joints are locked. One exponent is up to 2n times as fast.
    transient : float
        The time, s, in which the changes turn into their directions before growth counts. Use it
        for the exponents of an attractor or a chaotic sea, and 0 for those of this very run.
    rtol, atol : float
        As in `simulate`; the changes are integrated to a relative ``rtol`` too.
    t_eval : array_like, (k,), optional
        Times of the result, s. The time from which growth counts is put first if it is not among
        them. Default: 201 even times.
    max_step, max_steps, time_limit, progress
        As in `simulate`.

    Returns
    -------
    LyapunovExponents
        With ``.exponents`` (k,), 1/s, ``.largest``, ``.finite_time`` (n_t, k) over ``.t``; also of
        a run that could not be finished: see its ``status``.

    Raises
    ------
    ValueError, TypeError
        If an argument is not what is asked for (the message names it), and for dry friction and
        stops.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's function
        With what was found so far as the attribute ``exponents``.

    Notes
    -----
    The variational equations are integrated beside the motion. Two to four links go by Taylor
    series, with exact derivatives, if they have nothing but payloads, damping, springs and motors
    whose laws are in one piece, with two sinusoids at most. Other scenes go by dop853 with exact
    derivatives of the right-hand side (of a user's function, by differences). The changes Phi = Q R
    are made orthonormal as soon as an R_ii is not within [1/16, 16] (Benettin, Galgani, Giorgilli &
    Strelcyn, *Meccanica* 15 (1980), 9-20). Lengths are those of (dq, dqd) in rad and rad/s: over a
    long time they do not matter. The first change is one of q_1, the second of q_2, and so on; then
    those of the rates.

    Examples
    --------
    >>> found = pc.lyapunov(pc.Scene.textbook(), (0, 15), 0.0)
    >>> found.exponents.round(2)  # 1/s
    array([ 1.02,  0.3 , -0.16, -1.2 ])
    >>> f"chaotic: one more right digit is worth {found.seconds_a_digit:.2f} s"
    'chaotic: one more right digit is worth 2.27 s'
    """
    require_scene(scene)
    t_start, t_end = time_span(t_span)
    if t_start == t_end:
        raise ValueError(f"t_span = {t_span!r}: must be two different times (s)")
    since = t_start + np.copysign(number("transient", transient, "s"), t_end - t_start)
    if not 0 <= transient < abs(t_end - t_start) or since == t_end:
        raise ValueError(
            f"transient = {transient}: must be >= 0 and < {abs(t_end - t_start)} (s): growth "
            "counts from its end to that of t_span"
        )
    times = time_grid(since, t_end, TIMES) if t_eval is None else t_eval
    with reporting(progress, "following neighbours") as report:
        found = _core.lyapunov(
            scene._compiled, q0, qd0, t_start, t_end, count, rtol, atol, since, times,
            max_step, max_steps, time_limit, report, warn,
        )  # fmt: skip
    result = _exponents(found, since, len(scene.links))
    raise_with(found.pop("error"), exponents=result)
    if not result.success:
        warn(f"the exponents are not those of the whole span: {result.message}")
    return result


def lyapunov_of(solution: Solution, **how: Any) -> LyapunovExponents:
    """Compute the exponents of a solution's motion to its end, at its tolerances."""
    asked = solution._run.arguments
    if solution._run.t_reached == asked["t_start"]:
        raise ValueError("lyapunov: the run ended where it began: nothing had time to grow")
    return lyapunov(
        solution.scene, (asked["t_start"], solution._run.t_reached), asked["q0"], asked["qd0"],
        rtol=float(np.min(asked["rtol"])), atol=float(np.min(asked["atol"])),
        max_step=asked["max_step"], **how,
    )  # fmt: skip


def _exponents(found: dict[str, Any], since: float, n: int) -> LyapunovExponents:
    growth = found["growth"]
    if len(growth):
        growth = growth - growth[0]
    return LyapunovExponents(
        **{name: found[name] for name in ("t", "status", "message")},
        growth=growth,
        since=since,
        q=found["states"][:, :n],
        qd=found["states"][:, n:],
        success=found["status"] == "finished",
        stats=Statistics(**found["statistics"]),
    )
