"""How much longer a run stays valid with one more digit, and what that digit costs.

In a chaotic motion an error e grows like e exp(lambda t). So a run that is right to one more digit
is right for ln(10)/lambda seconds longer, whatever the method. The method decides what it costs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import inf, nan
from time import monotonic, perf_counter

import numpy as np
import numpy.typing as npt

from pendcore import ErrorEstimate, LyapunovExponents, Scene, lyapunov, messages
from pendcore.cost.horizon_work import HorizonPoint, HorizonWork
from pendcore.cost.runs import Start, has_error_estimate, methods_named
from pendcore.methods import known_methods
from pendcore.options import atol_beside

METHODS = ("dopri5", "dop853", "taylor")
"""The methods that are tried by default, where they support the scene."""
RTOLS = tuple(10.0**-k for k in range(3, 15))
TIGHT = 1e-14
"""The rtol of the exponent's run, which must be right for as long as any of the runs."""
REPEATS = 5
"""The number of timed runs at each point; the quickest counts."""


def horizon_work(
    scene: Scene,
    t_span: Iterable[float],
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike = 0.0,
    *,
    limit: float = 0.1,
    methods: str | Iterable[str] | None = None,
    rtols: npt.ArrayLike = RTOLS,
    time_limit: float = 60.0,
    progress: messages.Progress = None,
) -> HorizonWork:
    """Measure how long runs of a scene are to be trusted, and what that costs.

    Parameters
    ----------
    scene, t_span, q0, qd0
        As in `simulate`. Take a span that is longer than any run stays right: up to thirty
        Lyapunov times.
    limit : float
        rad; a run counts as valid until the error of an angle passes it.
    methods : str or iterable of str, optional
        Methods that choose their steps, but not ``"auto"``, which is a rule. Default: dopri5,
        dop853 and taylor, where they support the scene.
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

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> rtols = [1e-3, 1e-9]
    >>> work = pc.horizon_work(scene, (0, 40), 0.0, methods="taylor", rtols=rtols)
    >>> [f"{point.rtol:.0e}: {point.valid:.0f} s" for point in work.points]
    ['1e-03: 8 s', '1e-09: 18 s']
    """
    messages.require_scene(scene)
    start = Start(scene, q0, qd0, *messages.time_span(t_span))
    start.check("dopri5")
    limit = messages.positive("limit", limit, "rad")
    names = _methods(methods, start)
    tolerances = messages.numbers("rtols", rtols, "")
    if not tolerances or not all(0 < rtol < 1 for rtol in tolerances):
        raise ValueError(f"rtols = {rtols!r}: must hold a tolerance, and each be > 0 and < 1")
    choices = [(method, rtol) for method in names for rtol in tolerances]
    until = monotonic() + messages.time_limit_of(time_limit)
    found: list[tuple[ErrorEstimate, HorizonPoint]] = []
    try:
        with messages.reporting(progress, "measuring") as report:
            for done, (method, tolerance) in enumerate(choices):
                if monotonic() > until:
                    break
                report(done / len(choices))
                found.append(_point(start, method, tolerance, limit))
        work = _work(start, limit, choices, found)
        try:
            return replace(work, growth=_growth(start, work))
        except ValueError as refusal:  # dry friction and stops have no exponents
            return replace(work, refusal=str(refusal))
    except BaseException as stopped:
        messages.forget_inner_runs(stopped)
        messages.hand_over(stopped, work=_work(start, limit, choices, found))
        raise


def _methods(given: Iterable[str] | str | None, start: Start) -> list[str]:
    """Return the names of the methods to try, without aliases and each once."""
    if given is None:
        return [method for method in METHODS if start.is_supported_by(method)]
    names = methods_named(given)
    for method in names:
        if not has_error_estimate(method):
            known = [name for name in known_methods() if has_error_estimate(name)]
            raise ValueError(
                f"methods: {method!r} takes fixed steps and has no tolerance to vary: must be of "
                f"{', '.join(known)}; pendcore.accuracy_cost measures it too"
            )
        start.check(method)
    return names


def _point(
    start: Start, method: str, rtol: float, limit: float
) -> tuple[ErrorEstimate, HorizonPoint]:
    tolerances = {"rtol": rtol, "atol": atol_beside(rtol)}
    error = start.run(method, **tolerances).estimate_error(progress=False)
    valid = error.valid_until(limit)
    so_far = start._replace(t_end=valid)
    seconds, nfev = inf, 0
    for _ in range(REPEATS):
        began = perf_counter()
        made = so_far.run(method, **tolerances, store="end")
        seconds = min(seconds, perf_counter() - began)
        nfev = made.stats.nfev
    return error, HorizonPoint(method, rtol, abs(valid - start.t_start), seconds, nfev, nan)


def _work(
    start: Start,
    limit: float,
    choices: list[tuple[str, float]],
    found: list[tuple[ErrorEstimate, HorizonPoint]],
) -> HorizonWork:
    """Return the result without its exponent, which is computed from it."""
    early = min((point.valid for _, point in found), default=0.0)
    points = [
        point._replace(early=float(error.angle[np.abs(error.t - start.t_start) <= early].max()))
        for error, point in found
    ]
    return HorizonWork(
        limit=limit, t_span=(start.t_start, start.t_end), points=tuple(points), early=early,
        growth=None, untried=tuple(choices[len(found) :]),
    )  # fmt: skip


def _growth(start: Start, work: HorizonWork) -> LyapunovExponents | None:
    """Return how fast neighbours part between the shortest and the longest of the horizons."""
    longest = max((point.valid for point in work.points), default=0.0)
    if not longest > work.early:
        return None
    end = start.t_start + np.copysign(longest, start.t_end - start.t_start)
    with messages.silence():
        return lyapunov(
            start.scene, (start.t_start, end), start.q0, start.qd0, count=1, transient=work.early,
            rtol=TIGHT, atol=atol_beside(TIGHT), progress=False,
        )  # fmt: skip
