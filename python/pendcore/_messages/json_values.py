"""Values as JSON can hold them."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np


def as_json(value: Any) -> Any:
    """Return a value without what JSON lacks: tuples, NumPy's numbers, infinities and NaN.

    Named tuples become dictionaries.
    """
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, dict):
        return {key: as_json(x) for key, x in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return as_json(value.tolist())
    if isinstance(value, list | tuple):
        return [as_json(x) for x in value]
    return None if isinstance(value, float) and not isfinite(value) else value
