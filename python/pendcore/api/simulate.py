"""The call that everything is about: from a scene and a start to a solution."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

import numpy.typing as npt

from pendcore.api.scene import Scene
from pendcore.api.solution import Solution
from pendcore.api.solve import solve
from pendcore.messages.arguments import known_keywords
from pendcore.messages.progress import Progress
from pendcore.run.events import Event
from pendcore.run.methods import described_methods


@known_keywords
def simulate(
    scene: Scene,
    q0: npt.ArrayLike | None = None,
    qd0: npt.ArrayLike = 0.0,
    t_span: Iterable[float] | None = None,
    *,
    method: str = "auto",
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
    error: float | None = None,
    check: bool | None = None,
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
        ``"auto"``: chosen by scene and tolerances; ``sol.method`` tells what it came to be.
        In fixed steps ``"dopri5"``. Else ``"taylor-radau5"`` for two links or more whose effects
        have Taylor series; else ``"dop853-radau5"``, or where ``max(rtol, atol)`` is 1e-6 or more
        in all components ``"dopri5-radau5"``. Each of these pairs is its first method, to the last
        bit, and ``"radau5"`` from where stability is found to limit the steps and that one takes
        ten times longer ones.
        {methods}
    rtol, atol : float or (2n,)
        The error of a step is kept below ``atol + rtol abs(y)``, in root mean square over
        ``y = (q, qd)``. A Taylor series estimates none: its last coefficients choose the step.
    t_eval : array_like, (k,), optional
        Times of the result, s, one or more, within the run and in its order. They do not change
        the steps. Those that a run does not reach are not in the result.
    store : {"dense", "steps", "times", "end"}, optional
        What is kept: every step with its interpolant, every step, ``t_eval`` alone, the end alone;
        the last two in constant memory. Default: ``"times"`` with a ``t_eval``, else ``"dense"``.
    first_step : float, optional
        s, > 0. Default: chosen from the start by Hairer's rule, or by the first Taylor series.
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
    error : float, optional
        The largest error of the positions to keep, as a share of the total length, in place of
        ``method``, ``rtol``, ``atol`` and ``step``: they are chosen, and the run is verified by
        independent ones. The error is the distance of a joint or the tip from where it ought to be,
        the largest over the whole curve of a run with dense output, else over the times that it
        keeps. ``sol.accuracy`` tells what was reached and what it took;
        ``docs/accuracy_cost.md`` says what is promised.
    check : bool, optional
        What to do where the run does not get to its end, or the time limit is up before it is
        verified to have the ``error`` asked for. None: give a warning. True: raise a
        `RunError`. False: say nothing; look at ``sol.success`` then.
    progress : None, bool or callable
        None: a bar after a second, on a terminal. A callable gets the fraction done, in 0...1.

    Returns
    -------
    Solution
        What happened, also if the run could not be finished: see its ``status`` and ``message``
        (and ``check``). It is then shorter than was asked for.
        Where friction and stops bring all to rest for good, its status is ``at_rest``, a success:
        the message says since when, and the last step goes from there to ``t_end``.

    Raises
    ------
    ValueError, TypeError
        If an argument is not what is asked for; the message names it.
    AccuracyError
        If ``error`` is less than double precision can keep on this scene, or could not be verified.
        Its attribute ``solution`` has the most accurate run, ``least`` the least error that can be
        kept.
    RunError
        With ``check=True``, if the run does not get to its end, for whatever reason. Its attribute
        ``solution`` has the run so far.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's or event's function
        With the run so far as the attribute ``solution``; with an ``error`` the tightest run so
        far, and its ``accuracy`` says that it is not verified.

    Warns
    -----
    PendcoreWarning
        If the start or the interval look wrong, such as angles in degrees; and if the run does not
        get to its end, unless ``check`` is given.

    Notes
    -----
    The step control of Runge-Kutta methods is that of Hairer, Norsett and Wanner, *Solving Ordinary
    Differential Equations I*, II.4; a Taylor series sets its steps by its coefficients. The same
    arguments give the same bits on every x86-64 machine, whatever is stored.
    """
    options = (
        method, rtol, atol, t_eval, store, first_step, max_step, step, max_steps, time_limit,
        events, ledger, compensated, error, check, progress,
    )  # fmt: skip
    return solve(Solution, scene, q0, qd0, t_span, options)


simulate.__doc__ = described_methods(simulate.__doc__)
