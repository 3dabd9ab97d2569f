"""A run of a scene as `simulate` makes it, without warnings: the first run has given them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.handed_over import raise_with
from pendcore._messages.progress import Progress, callback, close
from pendcore._run.solution import Solution
from pendcore._scene.scene import Scene
from pendcore.methods import known_methods
from pendcore.options import RUN_DEFAULTS


def silent(message: str) -> None:
    """Say nothing."""


class Start(NamedTuple):
    """A scene, its angles (rad) and rates (rad/s) at the start, (n,) each, and a span (s)."""

    scene: Scene
    q0: npt.ArrayLike
    qd0: npt.ArrayLike
    t_start: float
    t_end: float


class Choice(NamedTuple):
    """How it is run.

    Attributes
    ----------
    method : str
    rtol, atol : float or (2n,)
        As in `simulate`; atol in rad and rad/s.
    compensated : bool
        Whether what rounding leaves over is carried on.
    """

    method: str
    rtol: npt.ArrayLike
    atol: npt.ArrayLike
    compensated: bool = False


def run(
    start: Start,
    choice: Choice,
    t_eval: npt.ArrayLike | None = None,
    *,
    progress: Progress = False,
    warn: Callable[[str], object] = silent,
    watch: _core.Watch | None = None,
    **options: Any,
) -> Solution:
    """Run; the keywords are those of `simulate`, but that ``events`` are the core's.

    ``watch`` looks on, and finds the error of the run, for example; see
    `pendcore._accuracy.defect_correction`.
    """
    report = callback(progress)
    options |= choice._asdict() | {"t_eval": t_eval}
    scene, q0, qd0, t_start, t_end = start
    run = _core.simulate(scene._compiled, q0, qd0, t_start, t_end, options, report, warn, watch)
    return completed(Solution(scene, run), report)


def run_again(solution: Solution, watch: _core.Watch | None = None, **changed: Any) -> Solution:
    """Simulate a run from its start as it was, but for some of its arguments."""
    asked = solution._run.arguments | changed
    q0, qd0, t_start, t_end = (asked.pop(name) for name in ("q0", "qd0", "t_start", "t_end"))
    choice = Choice(*(asked.pop(name) for name in Choice._fields))
    start = Start(solution.scene, q0, qd0, t_start, t_end)
    return run(start, choice, progress=None, watch=watch, **asked)


def resumed(
    result: Solution,
    t_end: float,
    t_eval: npt.ArrayLike | None = None,
    *,
    max_steps: int = RUN_DEFAULTS["max_steps"],
    time_limit: float | None = None,
    progress: Progress = None,
) -> Solution:
    """Go on with a run; see `pendcore.Solution.resume`."""
    if result.sensitivity_names:
        raise ValueError(
            f"sensitivities = {list(result.sensitivity_names)!r}: are not continued: simulate from "
            "the start to the later end; or from here with all q0[i] and qd0[i] among the names: "
            "by a parameter or a start, the whole run's are the second run's plus its matrix by "
            "q0 and qd0 times those at the end of the first"
        )
    report = callback(progress)
    run = result._run.resume(t_end, t_eval, max_steps, time_limit, report)
    return completed(Solution(result.scene, run, result.name), report)


def completed(result: Solution, report: Callable[[float], object] | None) -> Solution:
    """End the bar of a run; if an exception broke it off, raise that with the run so far."""
    close(report)
    raise_with(result._run.take_error(), solution=result)
    return result


def start_of(solution: Solution) -> Start:
    """Return what a solution ran, as far as it came."""
    asked = solution._run.arguments
    end = solution._run.t_reached
    return Start(solution.scene, asked["q0"], asked["qd0"], asked["t_start"], end)


def supports(method: str, start: Start, step: float | None = None) -> bool:
    """Whether a method supports a scene from its start: found by a run of no length.

    ``step`` is for methods that need a fixed one, s.
    """
    if method not in known_methods():
        return False
    try:
        run(start._replace(t_end=start.t_start), Choice(method, 1e-6, 1e-9), store="end", step=step)
    except ValueError:
        return False
    return True


def tightened(choice: Choice, factor: float, tightest: float) -> Choice:
    """Divide both tolerances by a factor, or by as much as leaves rtol at the tightest."""
    rtol, atol = np.asarray(choice.rtol), np.asarray(choice.atol)
    factor = max(1.0, min(factor, float(rtol.min()) / tightest))
    return choice._replace(rtol=rtol / factor, atol=atol / factor)
