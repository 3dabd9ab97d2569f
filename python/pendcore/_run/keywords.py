"""The keywords of a run, for type checkers and editors.

Written by docs/generators/write_options.py from the descriptors of the options.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias, TypedDict

import numpy.typing as npt

from pendcore._messages.progress import Progress
from pendcore._run.events import Event

OnFailure: TypeAlias = Literal["warn", "raise", "ignore"]


class RunKeywords(TypedDict, total=False):
    """What `pendcore.simulate` takes by name."""

    method: str
    rtol: npt.ArrayLike
    atol: npt.ArrayLike
    t_eval: npt.ArrayLike | None
    store: str | None
    first_step: float | None
    max_step: float
    step: float | None
    max_steps: int
    time_limit: float | None
    events: Iterable[Event]
    ledger: bool
    compensated: bool
    error: float | None
    on_failure: OnFailure
    progress: Progress
