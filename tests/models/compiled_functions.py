"""The type of compiled functions that are effects, as ctypes has it."""

from __future__ import annotations

import ctypes

DOUBLES = ctypes.POINTER(ctypes.c_double)
FORCES = ctypes.CFUNCTYPE(
    None, ctypes.c_double, ctypes.c_int, DOUBLES, DOUBLES, DOUBLES, ctypes.c_void_p
)
