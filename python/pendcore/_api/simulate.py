"""The call that everything is about: from a scene and a start to a solution."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Unpack

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import listed_names, no_time_span, number
from pendcore._messages.handed_over import hand_over
from pendcore._messages.progress import ProgressBar, callback, close
from pendcore._messages.warning import warn
from pendcore._run.call import Start, completed
from pendcore._run.run_error import checked, require_on_failure
from pendcore._run.solution import Solution
from pendcore._scene.scene import Scene, require_scene
from pendcore.events import events_asked_for
from pendcore.options import (
    ERROR,
    ON_FAILURE,
    OPTIONS,
    RUN_DEFAULTS,
    SENSITIVITIES,
    RunKeywords,
    require_options,
    with_options,
)


@with_options()
def simulate(
    scene: Scene,
    t_span: Iterable[float],
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike = 0.0,
    **options: Unpack[RunKeywords],
) -> Solution:
    """Solve the equations of motion of a scene from a start.

    Parameters
    ----------
    scene : Scene
        What moves.
    t_span : (float, float)
        Start and end, s. The end may lie before the start: the run then goes
        backward (refused with dry friction or inelastic stops, whose past is not unique).
    q0 : array_like, (n,)
        Absolute angles at the start, rad. A scalar holds for every link.
    qd0 : array_like, (n,), default 0
        Angular rates at the start, rad/s. A scalar holds for every link.
    {options}

    Returns
    -------
    Solution
        The run, also if it could not be finished: it is then shorter than ``t_span``, and its
        ``status`` and ``message`` say why. If friction and stops bring all links to rest for good,
        the status is ``at_rest``, which is a success: the message says since when, and the last
        step goes from there to ``t_end``.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of its range or of the wrong type; the message names it.
    AccuracyError
        If double precision cannot keep the ``error`` on this scene, or if the error could not be
        verified. The attribute ``solution`` is the most accurate run, ``least`` the least error
        that can be kept.
    RunError
        With ``on_failure="raise"``, if the run does not reach its end, for whatever reason. The
        attribute ``solution`` is the run so far.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's or event's function
        The attribute ``solution`` is the run so far; with an ``error`` it is the tightest run so
        far, and its ``accuracy`` says that it is not verified.

    Warns
    -----
    PendcoreWarning
        If the start or the interval looks wrong, such as angles in degrees (which is noticed only
        where all are multiples of 5 and one is 15 or more), or if the run does not reach its end,
        unless ``on_failure`` says otherwise.

    Notes
    -----
    The step control of Runge-Kutta methods is that of Hairer, Norsett and Wanner, *Solving Ordinary
    Differential Equations I*, II.4; a Taylor series sets its steps by its coefficients. The same
    arguments give the same bits on every machine (``docs/background/elsewhere.md``), whatever is
    stored.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> sol = pc.simulate(scene, (0, 5), [np.pi / 4, np.pi / 3])
    >>> sol(2.5).round(6)  # q_1, q_2 (rad), qd_1, qd_2 (rad/s)
    array([ 0.933714,  0.704933, -0.019304,  1.484836])
    >>> sol = pc.simulate(scene, (0, 5), [np.pi / 4, np.pi / 3], error=1e-9)
    >>> sol.accuracy.achieved <= 1e-9
    True
    """
    # A short run takes two microseconds, and this function may hardly take more: it calls nothing
    # that default options do not need.
    asked: Any = options
    if not isinstance(scene, Scene):
        require_scene(scene)
    on_failure, error = asked.pop("on_failure", "warn"), asked.pop("error", None)
    if on_failure != "warn":
        require_on_failure(on_failure)
    try:
        t_start, t_end = t_span
    except (TypeError, ValueError):
        raise no_time_span(t_span) from None
    if "events" in asked:
        asked["events"] = [event._as_pair() for event in events_asked_for(asked["events"])]
    names: tuple[str, ...] = ()
    if "sensitivities" in asked and (wanted := asked.pop("sensitivities")) is not None:
        names = listed_names("sensitivities", wanted, "q0[1]")
    if error is not None:
        require_options(asked, simulate)
        if names:  # a wrong name is told before anything runs
            _core.Sensitivities(scene._compiled, list(names))
        start = Start(scene, q0, qd0, t_start, t_end)
        solution = checked(_solved_to_error(start, error, asked), on_failure)
        if names:
            _find_sensitivities(solution, names)
        return solution
    progress = asked.pop("progress", None)
    report: Any = ProgressBar() if progress is None else callback(progress)
    watch = _core.Sensitivities(scene._compiled, list(names)) if names else None
    try:
        run = _core.simulate(scene._compiled, q0, qd0, t_start, t_end, asked, report, warn, watch)
    except TypeError:
        require_options(asked, simulate)
        raise
    solution = Solution(scene, run)
    if watch is not None:
        solution.sensitivities, solution.sensitivity_names = watch.values, names
        if watch.refusal:
            warn(watch.refusal)
    if run.success:
        if progress is not None or report.bar is not None:
            close(report)
        return solution
    return checked(completed(solution, report), on_failure)


def _find_sensitivities(solution: Solution, names: tuple[str, ...]) -> None:
    """Find the derivatives along a run that is there."""
    from pendcore._run.sensitivities import derivatives_of

    try:  # what was promised of the run's time is kept already
        watch, _ = derivatives_of(solution, names)
    except BaseException as stop:
        hand_over(stop, solution=solution)
        raise
    solution.sensitivities, solution.sensitivity_names = watch.values, names
    if watch.refusal:
        warn(watch.refusal)


def _solved_to_error(start: Start, error: float, options: dict[str, Any]) -> Solution:
    if not 0 < number("error", error, "") < 1:
        raise ValueError(f"error = {error!r}: must be > 0 and < 1, a share of the total length")
    for name, value in options.items():
        chosen = name in OPTIONS and OPTIONS[name].chosen_for_error
        if chosen and not np.array_equal(value, RUN_DEFAULTS[name]):
            raise ValueError(
                f"{name} = {value!r}: is chosen for the error: leave out {name} or error"
            )
    asked = {
        name: options.get(name, option.default)
        for name, option in OPTIONS.items()
        if not (option.chosen_for_error or option in (ON_FAILURE, ERROR, SENSITIVITIES))
    }
    from pendcore._accuracy.target_error import run_to_error

    return run_to_error(start, float(error), asked)
