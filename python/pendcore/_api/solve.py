"""From a scene and a start to a solution: what `simulate` and a case do."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._accuracy.target_error import run_to_error
from pendcore._messages.arguments import number, two_times
from pendcore._messages.progress import ProgressBar, callback, close
from pendcore._messages.warning import warn
from pendcore._run.call import Start, completed
from pendcore._run.events import events_asked_for
from pendcore._run.options import ERROR, ON_FAILURE, OPTIONS, RUN_DEFAULTS, require_options
from pendcore._run.run_error import checked, require_on_failure
from pendcore._run.solution import Solution
from pendcore._scene.scene import Scene, require_scene


def solve(
    scene: Scene,
    t_span: Iterable[float],
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike,
    options: dict[str, Any],
) -> Solution:
    """Run; `options` are used up.

    A short run takes two microseconds, and this function may hardly take more: it calls nothing
    that default options do not need.
    """
    if not isinstance(scene, Scene):
        require_scene(scene)
    on_failure, error = options.pop("on_failure", "warn"), options.pop("error", None)
    if on_failure != "warn":
        require_on_failure(on_failure)
    t_start, t_end = two_times(t_span)
    if "events" in options:
        options["events"] = [event._as_pair() for event in events_asked_for(options["events"])]
    if error is not None:
        require_options(options)
        start = Start(scene, q0, qd0, t_start, t_end)
        return checked(_solved_to_error(start, error, options), on_failure)
    progress = options.pop("progress", None)
    report = ProgressBar() if progress is None else callback(progress)
    try:
        run = _core.simulate(scene._compiled, q0, qd0, t_start, t_end, options, report, warn)
    except TypeError:
        require_options(options)
        raise
    result = Solution(scene, run)
    if run.success:
        close(report)
        return result
    return checked(completed(result, report), on_failure)


def _solved_to_error(start: Start, error: float, options: dict[str, Any]) -> Solution:
    error = _error_asked_for(error, options)
    asked = {
        name: options.get(name, option.default)
        for name, option in OPTIONS.items()
        if not (option.chosen_for_error or option in (ON_FAILURE, ERROR))
    }
    return run_to_error(start, error, asked)


def _error_asked_for(error: float, options: dict[str, Any]) -> float:
    if not 0 < number("error", error, "") < 1:
        raise ValueError(f"error = {error!r}: must be > 0 and < 1, a share of the total length")
    for name, value in options.items():
        chosen = name in OPTIONS and OPTIONS[name].chosen_for_error
        if chosen and not np.array_equal(value, RUN_DEFAULTS[name]):
            raise ValueError(
                f"{name} = {value!r}: is chosen for the error: leave out {name} or error"
            )
    return float(error)
