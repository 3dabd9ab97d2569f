"""From a scene and a start to a solution."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

import numpy.typing as npt

from pendcore import _core
from pendcore.arguments import known_keywords
from pendcore.events import Event, events_asked_for
from pendcore.progress import Progress, callback
from pendcore.scene import Scene
from pendcore.solution import Solution, solution_of
from pendcore.warning import warn


@known_keywords
def simulate(
    scene: Scene,
    q0: npt.ArrayLike | None = None,
    qd0: npt.ArrayLike = 0.0,
    t_span: Iterable[float] | None = None,
    *,
    method: str = "dopri5",
    rtol: npt.ArrayLike = 1e-9,
    atol: npt.ArrayLike = 1e-12,
    t_eval: npt.ArrayLike | None = None,
    store: str | None = None,
    first_step: float | None = None,
    max_step: float = inf,
    step: float | None = None,
    max_steps: int = 10_000_000,
    time_limit: float | None = None,
    events: Iterable[Event] = (),
    ledger: bool = False,
    compensated: bool = False,
    progress: Progress = None,
) -> Solution:
    """Solve the equations of motion of a scene from a start.

    Parameters
    ----------
    scene : Scene
        What moves.
    q0 : array_like, (n,)
        Absolute angles at the start, rad. A scalar holds for every link.
    qd0 : array_like, (n,), default 0
        Angular rates at the start, rad/s. A scalar holds for every link.
    t_span : (float, float)
        Start and end, s. The end may lie before the start: the run then goes
        backward (refused with dry friction or inelastic stops, whose past is not unique).
    method : str
        ``"dopri5"`` (also ``"RK45"``, ``"ode45"``): Dormand-Prince 5(4) with dense output.
        ``"radau5"`` (also ``"Radau"``): Radau IIA of order 5, implicit, for stiff scenes: strong
        damping, hard springs, stiff controllers. ``"auto"``: ``"dopri5"``, and ``"radau5"`` from
        where the steps are found to be limited by stability.
    rtol, atol : float or (2n,)
        The error of a step is kept below ``atol + rtol abs(y)``, in root mean square over
        ``y = (q, qd)``.
    t_eval : array_like, (k,), optional
        Times of the result, s, one or more, within the run and in its order. They do not change
        the steps. Those that a run does not reach are not in the result.
    store : {"dense", "steps", "times", "end"}, optional
        What is kept: every step with its interpolant, every step, ``t_eval`` alone, the end alone;
        the last two in constant memory. Default: ``"times"`` with a ``t_eval``, else ``"dense"``.
    first_step : float, optional
        s, > 0. Default: chosen from the start (Hairer's rule).
    max_step : float
        s, > 0.
    step : float, optional
        A fixed step, s, > 0, in place of the tolerances; not together with ``first_step`` or a
        smaller ``max_step``. An implicit method solves its equations to the tolerances.
    max_steps : int
        The run ends with status ``max_steps`` after as many attempts.
    time_limit : float, optional
        s of the clock; the run then ends with status ``time_limit``.
    events : iterable of pendcore.events.Event
        What to look for: ``sol.events`` has a list for each. They change no step; those that are
        ``terminal`` end the run, with status ``event``.
    ledger : bool
        Whether ``sol.energy().ledger`` tells work and loss of every effect. They are integrated
        beside the state, and change no bit of it.
    compensated : bool
        For long runs at small steps: what the rounding of the state leaves over at each step is
        carried on to the next, not lost (compensated summation). ``docs/long_runs.md`` says when it
        pays.
    progress : None, bool or callable
        None: a bar after a second, on a terminal. A callable gets the fraction done, in 0...1.

    Returns
    -------
    Solution
        What happened, also if the run could not be finished: see its ``status`` and ``message``.
        Where friction and stops bring all to rest for good, its status is ``at_rest``, a success:
        the message says since when, and the last step goes from there to ``t_end``.

    Raises
    ------
    ValueError, TypeError
        If an argument is not what is asked for; the message names it.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's or event's function
        With the run so far as the attribute ``solution``.

    Warns
    -----
    PendcoreWarning
        If the start or the interval look wrong, such as angles in degrees.

    Notes
    -----
    The step control is that of Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations
    I*, II.4. The same arguments give the same bits on every x86-64 machine, whatever is stored.
    """
    if not isinstance(scene, Scene):
        raise _no_scene(scene)
    if q0 is None:
        raise TypeError("q0 is missing: give the angles at the start, one per link, in rad")
    if t_span is None:
        raise TypeError("t_span is missing: give (t_start, t_end), in s")
    try:
        t_start, t_end = t_span
    except (TypeError, ValueError):
        raise TypeError(f"t_span = {t_span!r}: must be (t_start, t_end), in s") from None
    wanted = [event._as_pair() for event in events_asked_for(events)]
    report = callback(progress)
    run = _core.simulate(
        scene._compiled, q0, qd0, t_start, t_end, method, rtol, atol, t_eval, store,
        first_step, max_step, step, max_steps, time_limit, wanted, ledger, compensated, report,
        warn,
    )  # fmt: skip
    return solution_of(scene, run, report)


def _no_scene(value: object) -> TypeError:
    if isinstance(getattr(value, "scene", None), Scene):
        kind = type(value).__name__
        remedy = "; case.simulate() runs a case" if hasattr(value, "simulate") else ""
        return TypeError(f"scene: is a {kind}: must be a pendcore.Scene{remedy}")
    return TypeError(f"scene = {value!r}: must be a pendcore.Scene")
