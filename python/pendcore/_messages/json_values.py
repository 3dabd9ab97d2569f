"""Values as JSON can hold them."""

from __future__ import annotations

from functools import partial
from math import isfinite
from typing import Any

import numpy as np


def as_json(value: Any, *, in_words: bool = False) -> Any:
    """Return a value without what JSON lacks: tuples, NumPy's numbers, infinities and NaN.

    Named tuples become dictionaries. With ``in_words`` infinities are "inf" and "-inf", not None.
    """
    plain = partial(as_json, in_words=in_words)
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, dict):
        return {key: plain(x) for key, x in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(x) for x in value]
    if not isinstance(value, float) or isfinite(value):
        return value
    return str(value) if in_words and value == value else None
