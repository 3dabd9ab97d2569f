"""The options of a run: name, type, unit, range, default and a sentence for each.

import pendcore.options

pendcore.options.OPTIONS["rtol"].default
"""

from __future__ import annotations

from pendcore._run.call import atol_beside
from pendcore._run.options import (
    OPTIONS,
    RunOption,
    limits_of_every_method,
    require_options,
    with_options,
)

__all__ = [
    "OPTIONS",
    "RunOption",
    "atol_beside",
    "limits_of_every_method",
    "require_options",
    "with_options",
]
