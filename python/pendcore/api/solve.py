"""From a scene and a start to a result, whatever its class: what `simulate` and a case do."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.accuracy.target_error import run_to_error
from pendcore.messages.arguments import number, two_times
from pendcore.messages.progress import Progress, callback
from pendcore.messages.warning import warn
from pendcore.run.call import Start, completed
from pendcore.run.events import Event, events_asked_for
from pendcore.run.options import RUN_DEFAULTS
from pendcore.run.result import Result, RunResult
from pendcore.run.run_error import checked, require_check
from pendcore.scene.scene import SceneData, require_start


def solve(
    kind: type[Result],
    scene: SceneData,
    q0: npt.ArrayLike | None,
    qd0: npt.ArrayLike,
    t_span: Iterable[float] | None,
    *,
    method: str,
    rtol: npt.ArrayLike,
    atol: npt.ArrayLike,
    t_eval: npt.ArrayLike | None,
    store: str | None,
    first_step: float | None,
    max_step: float,
    step: float | None,
    max_steps: int,
    time_limit: float | None,
    events: Iterable[Event],
    ledger: bool,
    compensated: bool,
    error: float | None,
    check: bool | None,
    progress: Progress,
) -> Result:
    """Return a result of a class; `pendcore.simulate` says what the keywords are."""
    q0 = require_start(scene, q0)
    require_check(check)
    t_start, t_end = two_times(t_span)
    wanted = [event._as_pair() for event in events_asked_for(events)]
    if error is not None:
        _check_error(error, method=method, rtol=rtol, atol=atol, step=step)
        options = {
            "t_eval": t_eval, "store": store, "first_step": first_step, "max_step": max_step,
            "max_steps": max_steps, "time_limit": time_limit, "wanted": wanted,
            "ledger": ledger, "compensated": compensated, "progress": progress,
        }  # fmt: skip
        start = Start(scene, q0, qd0, t_start, t_end)
        return checked(_solved_to_error(kind, start, float(error), options), check)
    report = callback(progress)
    run = _core.simulate(
        scene._compiled, q0, qd0, t_start, t_end, method, rtol, atol, t_eval, store,
        first_step, max_step, step, max_steps, time_limit, wanted, ledger, compensated, report,
        warn,
    )  # fmt: skip
    return checked(completed(kind(scene, run), report), check)


def _solved_to_error(
    kind: type[Result], start: Start, error: float, options: dict[str, Any]
) -> Result:
    try:
        return kind.of(run_to_error(start, error, options))
    except BaseException as stop:
        if isinstance(so_far := getattr(stop, "solution", None), RunResult):
            stop.solution = kind.of(so_far)  # type: ignore[attr-defined]
        raise


def _check_error(error: float, **chosen: object) -> None:
    if not 0 < number("error", error, "") < 1:
        raise ValueError(f"error = {error!r}: must be > 0 and < 1, a share of the total length")
    for name, value in chosen.items():
        if not np.array_equal(value, RUN_DEFAULTS[name]):  # type: ignore[arg-type]
            raise ValueError(
                f"{name} = {value!r}: is chosen for the error: leave one of the two out"
            )
