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
        ``"auto"`` chooses by scene and tolerances; ``sol.method`` says which method it chose. A run
        in fixed steps takes ``"dopri5"``. Two links or more whose effects all have Taylor series
        take ``"taylor-radau5"``. Other scenes take ``"dop853-radau5"``, or ``"dopri5-radau5"``
        where ``max(rtol, atol)`` is 1e-6 or more in all components. Each of these pairs gives the
        bits of its first method until stability limits the steps and ``"radau5"`` can take steps
        ten times as long; the run then continues with ``"radau5"``.
        {methods}
    rtol, atol : float or (2n,)
        The error of a step is kept below ``atol + rtol abs(y)``, in root mean square over
        ``y = (q, qd)``. A Taylor series has no error estimate: its last coefficients choose the
        step.
    t_eval : array_like, (k,), optional
        Times of the result, s, one or more, within the run and in its order. They do not change
        the steps. Times that the run does not reach are missing from the result.
    store : {"dense", "steps", "times", "end"}, optional
        Which states the run keeps. ``"dense"`` keeps every step with its interpolant, ``"steps"``
        every step, ``"times"`` only those of ``t_eval``, and ``"end"`` only the last. The last two
        take constant memory. Default: ``"times"`` with a ``t_eval``, otherwise
        ``"dense"``.
    first_step : float, optional
        s, > 0. Default: Hairer's rule chooses it from the start, or the first Taylor series does.
    max_step : float
        s, > 0.
    step : float, optional
        A fixed step, s, > 0, in place of the tolerances. It excludes ``first_step`` and a smaller
        ``max_step``. An implicit method still solves its equations to the tolerances.
    max_steps : int
        The run ends with status ``max_steps`` after this many attempted steps.
    time_limit : float, optional
        s of wall-clock time, after which the run ends with status ``time_limit``.
    events : iterable of pendcore.events.Event
        Events to look for; ``sol.events`` has a list for each. Events change no step. A
        ``terminal`` event ends the run, with status ``event``.
    ledger : bool
        Whether ``sol.energy().ledger`` has the work and loss of every effect. They are integrated
        beside the state and change no bit of it.
    compensated : bool
        Whether each step carries the rounding error of the state over to the next step
        (compensated summation), for long runs at small steps. ``docs/long_runs.md`` says when that
        pays.
    error : float, optional
        The largest allowed error of the positions, as a share of the total length. It takes the
        place of ``method``, ``rtol``, ``atol`` and ``step``: pendcore chooses these and verifies
        the run by independent runs. The error is the largest distance of a joint or the tip from
        its true place, over the whole curve of a run with dense output, otherwise over the times
        that the run keeps. ``sol.accuracy`` says what was reached and what it cost;
        ``docs/accuracy_cost.md`` says what is promised.
    check : bool, optional
        What to do if the run does not reach its end, or if the time limit is up before the
        ``error`` is verified. None gives a warning, True raises a `RunError`, False says nothing:
        look at ``sol.success`` then.
    progress : None, bool or callable
        None shows a bar after a second, on a terminal. A callable receives the fraction done, from
        0 to 1.

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
        With ``check=True``, if the run does not reach its end, for whatever reason. The attribute
        ``solution`` is the run so far.
    KeyboardInterrupt, or any exception of ``progress`` or of an effect's or event's function
        The attribute ``solution`` is the run so far; with an ``error`` it is the tightest run so
        far, and its ``accuracy`` says that it is not verified.

    Warns
    -----
    PendcoreWarning
        If the start or the interval looks wrong, such as angles in degrees, or if the run does not
        reach its end and ``check`` is not given.

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
