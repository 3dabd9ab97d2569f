"""From a scene and a start to a result, whatever its class: what `simulate` and a case do."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.accuracy.target_error import run_to_error
from pendcore.messages.arguments import number, two_times
from pendcore.messages.progress import callback
from pendcore.messages.warning import warn
from pendcore.run.call import Start, completed
from pendcore.run.events import events_asked_for
from pendcore.run.options import RUN_DEFAULTS, Options
from pendcore.run.result import Result, RunResult
from pendcore.run.run_error import checked, require_check
from pendcore.scene.scene import SceneData, require_start

CHOSEN = ("method", "rtol", "atol", "step")
"""What an error that is asked for takes the place of."""


def solve(
    kind: type[Result],
    scene: SceneData,
    q0: npt.ArrayLike | None,
    qd0: npt.ArrayLike,
    t_span: Iterable[float] | None,
    options: tuple[Any, ...],
) -> Result:
    """Run, and return the result as one of a class; the options are in the order of `Options`."""
    (
        method, rtol, atol, t_eval, store, first_step, max_step, step, max_steps, time_limit,
        events, ledger, compensated, error, check, progress,
    ) = options  # fmt: skip
    q0 = require_start(scene, q0)
    require_check(check)
    t_start, t_end = two_times(t_span)
    wanted = [event._as_pair() for event in events_asked_for(events)]
    if error is not None:
        start = Start(scene, q0, qd0, t_start, t_end)
        return checked(_solved_to_error(kind, start, Options(*options), wanted), check)
    report = callback(progress)
    run = _core.simulate(
        scene._compiled, q0, qd0, t_start, t_end, method, rtol, atol, t_eval, store, first_step,
        max_step, step, max_steps, time_limit, wanted, ledger, compensated, report, warn,
    )  # fmt: skip
    return checked(completed(kind(scene, run), report), check)


def result_as(kind: type[Result], result: RunResult) -> Result:
    """Return the same result as one of a class."""
    return kind(result.scene, result.run, result.name, result.accuracy, result.known_error)


def _solved_to_error(
    kind: type[Result], start: Start, options: Options, wanted: list[tuple[str, dict[str, Any]]]
) -> Result:
    asked = options._asdict()
    error = _error_asked_for(asked.pop("error"), **{name: asked.pop(name) for name in CHOSEN})
    del asked["events"], asked["check"]
    try:
        return result_as(kind, run_to_error(start, error, asked | {"wanted": wanted}))
    except BaseException as stop:
        if isinstance(so_far := getattr(stop, "solution", None), RunResult):
            stop.solution = result_as(kind, so_far)  # type: ignore[attr-defined]
        raise


def _error_asked_for(error: float, **chosen: object) -> float:
    if not 0 < number("error", error, "") < 1:
        raise ValueError(f"error = {error!r}: must be > 0 and < 1, a share of the total length")
    for name, value in chosen.items():
        if not np.array_equal(value, RUN_DEFAULTS[name]):  # type: ignore[arg-type]
            raise ValueError(
                f"{name} = {value!r}: is chosen for the error: leave one of the two out"
            )
    return float(error)
