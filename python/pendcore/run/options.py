"""How to run: the keywords of `pendcore.simulate`, with their defaults."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from typing import NamedTuple

import numpy.typing as npt

from pendcore.messages.progress import Progress
from pendcore.run.events import Event


class Options(NamedTuple):
    """In the order of the signature, which a test compares; `pendcore.simulate` explains them."""

    method: str = "auto"
    rtol: npt.ArrayLike = 1e-9
    atol: npt.ArrayLike = 1e-12
    t_eval: npt.ArrayLike | None = None
    store: str | None = None
    first_step: float | None = None
    max_step: float = inf
    step: float | None = None
    max_steps: int = 10_000_000
    time_limit: float | None = None
    events: Iterable[Event] = ()
    ledger: bool = False
    compensated: bool = False
    error: float | None = None
    check: bool | None = None
    progress: Progress = None


RUN_DEFAULTS = Options._field_defaults
