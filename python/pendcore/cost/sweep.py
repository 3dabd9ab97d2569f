"""Methods and tolerances swept on a scene of the user's own: errors, times, right-hand sides."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import Scene, messages
from pendcore.cost.accuracy_cost import AccuracyCost
from pendcore.cost.measurement import Measurement
from pendcore.cost.runs import Start, methods_named
from pendcore.options import atol_beside, require_options, with_options

RTOL = tuple(float(f"1e-{k}") for k in range(2, 15))
"""The tolerances that are tried unless others are given."""
TIME_LIMIT = 20.0
"""s."""
REPEATS = 30
POINTS = 101
"""The number of times at which errors are measured, both ends included."""


@with_options(lambda option: option.limits_every_method)
def accuracy_cost(
    scene: Scene,
    t_span: Iterable[float],
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike = 0.0,
    *,
    methods: str | Iterable[str] | None = None,
    rtol: npt.ArrayLike = RTOL,
    atol: float | None = None,
    step: npt.ArrayLike | None = None,
    points: int = POINTS,
    repeats: int = REPEATS,
    time_limit: float = TIME_LIMIT,
    name: str = "",
    progress: messages.Progress = None,
    **limits: Any,
) -> AccuracyCost:
    """Measure what accuracy costs on a scene: every method at every tolerance, error and time.

    Parameters
    ----------
    scene, t_span, q0, qd0
        What is run, as in `simulate`. Where double precision cannot follow a chaotic motion to the
        end, the span is cut to where it can, and ``remarks`` says so.
    methods : str or iterable of str, optional
        As in `simulate`, but not ``"auto"``, which is a rule. Default: all that can carry the
        scene, and where it is stiff the pairs that change over.
    rtol : array_like, (k,), default 1e-2, 1e-3, ..., 1e-14
        Tolerances, > 0 and < 1.
    atol : float, optional
        rad and rad/s. Default: a thousandth of each rtol, as in the defaults of `simulate`.
    step : array_like, (k,), optional
        Steps of methods without an error estimate (``"rk4"``), s. Default: halved from the longest
        that the scene allows until one run takes too long.
    points : int
        >= 2. Times, evenly spaced, on which errors are measured. All runs have them as ``t_eval``.
    repeats : int
        >= 1. How many calls of each method at each tolerance are timed, as far as the time allows;
        in rounds, so that whatever slows the machine slows all alike.
    time_limit : float
        s, > 0, that the whole measurement may take. A run that alone would take too long is told as
        a failure; where even a loose run takes more than a two-hundredth of the limit, the span is
        cut, and ``remarks`` says so.
    name : str
        For people.
    progress
        As in `simulate`.
    {options}

    Returns
    -------
    AccuracyCost
        Points, table (``print``), figure (``plot``), JSON (``to_json``), and the ``best`` choice.

    Raises
    ------
    ValueError, TypeError
        If an argument is not what is asked for, or no two methods get through the scene.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's function
        With what was measured so far as the attribute ``accuracy_cost``: no points before there is
        a reference.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> cost = pc.accuracy_cost(
    ...     scene, q0=0.5, t_span=(0, 1), methods="dop853", rtol=[1e-3, 1e-9], repeats=1
    ... )
    >>> best = cost.best(error=1e-8)
    >>> f"{best.method} at {best.setting}"
    'dop853 at rtol 1e-09'
    """
    require_options(limits, accuracy_cost)
    messages.require_scene(scene)
    n = len(scene.links)
    span = messages.time_span(t_span)
    if span[0] == span[1]:
        raise ValueError(f"t_span = {t_span!r}: must be two different times (s)")
    angles, rates = messages.vector("q0", q0, n, "rad"), messages.vector("qd0", qd0, n, "rad/s")
    start = Start(scene, angles, rates, *span)
    tolerances = _positive("rtol", rtol, "", below=1.0)
    absolute = None if atol is None else messages.number("atol", atol, "")
    measurement = Measurement(
        start=start,
        name=messages.text("name", name),
        methods=None if methods is None else methods_named(methods),
        tolerances=[(r, atol_beside(r) if absolute is None else absolute) for r in tolerances],
        steps=None if step is None else _positive("step", step, "s"),
        limits=limits,
        points=messages.at_least("points", points, 2),
        repeats=messages.at_least("repeats", repeats, 1),
        time_limit=messages.time_limit_of(time_limit),
    )
    for message in scene.run_warnings(angles, span):
        messages.warn(message)
    try:
        with messages.silence(), messages.reporting(progress, "measuring") as measurement.report:
            measurement.measure()  # its warnings were given above
    except BaseException as stop:
        messages.forget_inner_runs(stop)
        measurement.remarks.append("it was interrupted: this is what was measured until then")
        messages.hand_over(stop, accuracy_cost=measurement.result())
        raise
    return measurement.result()


def _positive(name: str, values: npt.ArrayLike, unit: str, below: float = inf) -> list[float]:
    array = np.atleast_1d(messages.finite_array(name, values, unit))
    if array.ndim != 1 or not array.size or not (array > 0).all():
        raise ValueError(f"{name} = {values!r}: must be numbers > 0, (k,)")
    if not (array < below).all():
        raise ValueError(f"{name} = {values!r}: must be > 0 and < {below:g}, (k,)")
    return sorted(array.tolist(), reverse=True)
