"""The methods of integration, as the core describes them.

import pendcore.methods

pendcore.methods.known_methods()["dop853"]["error_order"]   # 7
pendcore.methods.most_accurate()                            # which serve as references
"""

from __future__ import annotations

from pendcore._run.methods import (
    evaluations,
    has_error_estimate,
    implicit_method,
    known_methods,
    line_style,
    methods_named,
    methods_of,
    most_accurate,
    pair_of,
    tightest_rtol,
)

__all__ = [
    "evaluations",
    "has_error_estimate",
    "implicit_method",
    "known_methods",
    "line_style",
    "methods_named",
    "methods_of",
    "most_accurate",
    "pair_of",
    "tightest_rtol",
]
