"""Whatever tells or measures accuracy refuses bad arguments: it names field, value, range, unit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pendcore as pc
import pytest

BOOK = pc.Scene.textbook()
nan, inf = np.nan, np.inf
Row = tuple[dict[str, Any], str]


def asked(call: Callable[..., Any], t_end: float = 10.0, **usual: Any) -> Callable[..., Any]:
    start = {"q0": [1.0, 1.0], "t_span": (0, t_end)} | usual
    return lambda **given: call(BOOK, **(start | given))


def of_run(name: str, *, is_known: bool = False) -> Callable[..., Any]:
    """Return what asks a short run, whose error is known already or not."""

    def ask(**given: Any) -> Any:
        run = pc.simulate(BOOK, q0=[1.0, 1.0], t_span=(0, 0.1))
        if is_known:
            run.estimate_error()
        return getattr(run, name)(**given)

    return ask


def measured(name: str) -> Callable[..., Any]:
    cost = pc.accuracy_cost(BOOK, (0, 1), [0.7, 1.0], methods="dop853", rtol=1e-6, repeats=1)
    return getattr(cost, name)  # type: ignore[no-any-return]


NOT_SPANS: list[Row] = [
    ({"t_span": (0, 1, 2)}, r"t_span = \(0, 1, 2\): must be \(t_start, t_end\), in s"),
    ({"t_span": (0,)}, r"t_span = \(0,\): must be \(t_start, t_end\)"),
    ({"t_span": 5}, r"t_span = 5: must be \(t_start, t_end\)"),
    ({"t_span": "ab"}, "t_span = 'ab': must be "),
    ({"t_span": np.zeros((1, 2))}, "t_span = array.*must be"),
    ({"t_span": (0, nan)}, r"t_span\[1\] = nan: must be finite \(s\)"),
    ({"t_span": (-inf, 0)}, r"t_span\[0\] = -inf: must be finite \(s\)"),
    ({"t_span": (-1.7e308, 1.7e308)}, "t_span = .*: is inf s long: must be below"),
]
NOT_METHODS: list[Row] = [
    ({"methods": ["euler"]}, "methods: 'euler' is none: known are dopri5"),
    ({"methods": "auto"}, "methods: 'auto' is a rule that chooses one: known are dopri5"),
    ({"methods": []}, "methods: is empty: must name a method, or be left out"),
    ({"methods": 8}, "methods = 8: must be names of methods, or one"),
]
NOT_TIME_LIMITS: list[Row] = [
    ({"time_limit": 0}, r"time_limit = 0.0: must be > 0 \(s\)"),
    ({"time_limit": -1}, r"time_limit = -1.0: must be > 0 \(s\)"),
    ({"time_limit": nan}, r"time_limit = nan: must be > 0 \(s\)"),
    ({"time_limit": "long"}, r"time_limit = 'long': must be a real number \(s\)"),
    ({"time_limit": True}, "time_limit = True: must be a real number"),
    ({"time_limit": [1.0]}, r"time_limit = \[1.0\]: must be a real number \(s\)"),
]
ERRORS_OF_COST: list[Row] = [
    ({"error": x}, r"must be > 0 \(of the total length\)") for x in (0, -1, nan)
]

BAD: dict[str, tuple[Callable[..., Any], list[Row]]] = {
    "simulate": (
        asked(pc.simulate, 5.0, error=1e-6),
        [
            ({"error": 0}, "error = 0: must be > 0 and < 1"),
            ({"error": 1.5}, "error = 1.5: must be"),
            ({"error": nan}, "error = nan: must be"),
            ({"error": "small"}, "error = 'small': must be a real number"),
            ({"rtol": 1e-3}, "rtol = 0.001: is chosen for the error"),
            ({"atol": [1e-3] * 4}, "atol = .*: is chosen for the error"),
            ({"step": 0.01}, "step = 0.01: is chosen"),
            ({"method": "radau5"}, "method = 'radau5': is chosen"),
            ({"t_span": (0, inf)}, r"t_span\[1\] = inf: must be finite \(s\)"),
            ({"t_span": ("a", 1)}, "t_span.*: must "),
            *NOT_TIME_LIMITS,
        ],
    ),
    "estimate_error": (of_run("estimate_error"), NOT_TIME_LIMITS),
    "a known estimate_error": (of_run("estimate_error", is_known=True), NOT_TIME_LIMITS),
    "valid_until": (
        of_run("valid_until"),
        [
            ({"limit": 0.0}, "limit = 0.0: must be > 0"),
            ({"limit": nan}, "limit = nan: must be > 0"),
            ({"limit": "0.1"}, r"limit = '0.1': must be a real number \(rad\)"),
            ({"of": "tip"}, r"of = 'tip': must be \"angle\" \(rad\) or \"position\""),
        ],
    ),
    "plot": (
        of_run("plot"),
        [
            ({"horizon": -1}, r"horizon = -1.0: must be > 0 \(rad\)"),
            ({"horizon": nan}, "horizon = nan: must be > 0"),
            ({"horizon": True}, r"horizon = True: must be a real number \(rad\)"),
        ],
    ),
    "lyapunov": (
        asked(pc.lyapunov),
        [
            ({"count": 0}, "count = 0: must be 1 to 4, twice the degrees of freedom"),
            ({"count": 9}, "count = 9: must be 1 to 4"),
            ({"count": 1.5}, "count = 1.5: must be a whole number"),
            ({"rtol": -1.0}, "rtol = -1.0: must be finite and > 0"),
            ({"transient": 11.0}, r"transient = 11.0: must be >= 0 and < 10.0 \(s\)"),
            ({"transient": 10.0}, r"transient = 10.0: must be >= 0 and < 10.0 \(s\)"),
            ({"transient": -1.0}, "transient = -1.0: must be >= 0"),
            ({"transient": 1e-20, "t_span": (1e9, 1e9)}, "t_span = .* two different times"),
            ({"t_span": (1, 1)}, r"t_span = \(1, 1\): must be two different times \(s\)"),
            ({"t_eval": [3.0, 2.0]}, r"t_eval\[1\] = 2.0: must be beyond t_eval\[0\] = 3.0"),
            ({"t_eval": [3, 12.0]}, r"t_eval\[1\] = 12.0: must be within the run, 0.0 to 10.0 s"),
            ({"t_eval": [-1.0, 12]}, r"t_eval\[0\] = -1.0: must be within the run, 0.0 to 10.0 s"),
            ({"t_eval": [1.0], "t_span": (0, -5)}, r"t_eval\[0\] = 1.0: must be .* 0.0 to -5.0 s"),
            ({"t_eval": [0.0]}, r"t_eval = 0.0: must be followed by later times \(s\): growth"),
            ({"time_limit": nan}, r"time_limit = nan: must be > 0, inf for no limit \(s\)"),
            *NOT_SPANS,
        ],
    ),
    "horizon_work": (
        asked(pc.horizon_work, 1.0, rtols=[1e-3]),
        [
            ({"limit": 0.0}, "limit = 0.0: must be > 0"),
            ({"limit": nan}, r"limit = nan: must be > 0 \(rad\)"),
            ({"methods": "rk4"}, "'rk4' takes fixed steps and has no .* must be of dopri5,"),
            ({"rtols": [-1.0]}, r"rtols = \[-1.0\]: .* each be > 0 and < 1"),
            ({"rtols": []}, r"rtols = \[\]: must hold a tolerance"),
            *NOT_SPANS,
            *NOT_METHODS,
            *NOT_TIME_LIMITS,
        ],
    ),
    "accuracy_cost": (
        asked(pc.accuracy_cost, 5.0),
        [
            ({"rtol": [1e-3, -1]}, "rtol = "),
            ({"rtol": []}, "rtol = "),
            ({"rtol": [2]}, r"rtol = \[2\]: must be > 0 and < 1"),
            ({"rtol": 1.0}, "rtol = 1.0: must be > 0 and < 1"),
            ({"atol": "small"}, "atol = 'small': must be a real number"),
            ({"step": 0}, "step = 0: must be numbers > 0"),
            ({"points": 1}, "points = 1: must be >= 2"),
            ({"points": 2.5}, "points = 2.5: must be a whole number"),
            ({"repeats": 0}, "repeats = 0: must be >= 1"),
            ({"t_span": (0, 0)}, r"t_span = \(0, 0\): must be two different times"),
            ({"method": 1}, "accuracy_cost has no parameter 'method': did you mean 'methods'"),
            ({"q0": [1, 2, 3]}, "q0: shape"),
            *NOT_SPANS,
            *NOT_METHODS,
            *NOT_TIME_LIMITS,
        ],
    ),
    "best": (lambda **given: measured("best")(**given), ERRORS_OF_COST),
    "sentence": (lambda **given: measured("sentence")(**given), ERRORS_OF_COST),
}


@pytest.mark.parametrize("call", BAD)
def test_a_bad_argument_is_named(call: str) -> None:
    ask, bad = BAD[call]
    for given, message in bad:
        with pytest.raises((ValueError, TypeError), match=message):
            ask(**given)
