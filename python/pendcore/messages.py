"""How pendcore speaks, for extras that are to speak alike: warnings, bars, checks, tables, files.

An argument that is wrong is answered with its name, its value, its range and its unit; a file is
there whole or not at all. The derivation, pages, films, the command line and comparisons of cost
stand on these and on the rest of the public names alone.
"""

from __future__ import annotations

from pendcore._cases.whole_file import whole_file
from pendcore._messages.arguments import (
    Floats,
    at_least,
    did_you_mean,
    finite_array,
    in_a_row,
    listed,
    number,
    numbers,
    positive,
    require_known,
    text,
    time_limit_of,
    time_span,
    vector,
    whole_number,
)
from pendcore._messages.handed_over import forget_inner_runs, hand_over
from pendcore._messages.html import beside, drawing, table
from pendcore._messages.json_values import as_json
from pendcore._messages.progress import Progress, reporting
from pendcore._messages.warning import PendcoreWarning, silence, warn
from pendcore._scene.scene import require_scene

__all__ = [
    "Floats",
    "PendcoreWarning",
    "Progress",
    "as_json",
    "at_least",
    "beside",
    "did_you_mean",
    "drawing",
    "finite_array",
    "forget_inner_runs",
    "hand_over",
    "in_a_row",
    "listed",
    "number",
    "numbers",
    "positive",
    "reporting",
    "require_known",
    "require_scene",
    "silence",
    "table",
    "text",
    "time_limit_of",
    "time_span",
    "vector",
    "warn",
    "whole_file",
    "whole_number",
]
