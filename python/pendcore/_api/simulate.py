"""The call that everything is about: from a scene and a start to a solution."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Unpack

import numpy.typing as npt

from pendcore._api.solve import solve
from pendcore._run.keywords import RunKeywords
from pendcore._run.methods import described_methods
from pendcore._run.options import with_options
from pendcore._run.solution import Solution
from pendcore._scene.scene import Scene


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
        If the start or the interval looks wrong, such as angles in degrees, or if the run does not
        reach its end, unless ``on_failure`` says otherwise.

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
    return solve(scene, t_span, q0, qd0, options)  # type: ignore[arg-type]


simulate.__doc__ = described_methods(simulate.__doc__)
