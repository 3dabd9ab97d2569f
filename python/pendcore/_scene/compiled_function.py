"""A compiled function of the user's, and the data that it is handed: what stands for an address."""

from __future__ import annotations

import ctypes
from _ctypes import CFuncPtr
from typing import Any

import numpy as np

from pendcore._messages.arguments import refuse_masked, whole_number

_TAKEN = "double", "int", "double*", "double*", "double*", "void*"
_RIGHT = "CFUNCTYPE(None, c_double, c_int, *[POINTER(c_double)] * 3, c_void_p)"
_ADDRESSES = "PzZOlLqQ"
"""The letters by which ctypes knows pointers, and whole numbers that may be as wide as one."""


def address(name: str, value: Any, of_function: bool) -> int:
    """Return the memory address of a function, or of the data that it is handed."""
    if of_function:
        value = _address_of_function(name, value)
    elif isinstance(value, np.ndarray):
        value = _address_of_array(name, value)
    remedy = "a ctypes function or a numba cfunc" if of_function else "or a NumPy array"
    try:
        found = whole_number(name, value, most=2**64 - 1)
    except TypeError:
        raise TypeError(f"{name} = {value!r}: must be an address, {remedy}") from None
    if found < 0:
        raise ValueError(f"{name} = {value!r}: must be an address, {remedy}")
    return found


def _address_of_array(name: str, array: np.ndarray[Any, Any]) -> int:
    refuse_masked(name, array)
    if array.dtype != np.float64 or not array.flags.c_contiguous:
        gaps = "" if array.flags.c_contiguous else ", not contiguous"
        raise TypeError(
            f"{name}: is an array of {array.dtype}{gaps}: must be a C-contiguous one of "
            "float64, as np.ascontiguousarray(data, dtype=np.float64) makes it: its memory is "
            "handed on as it is"
        )
    return array.ctypes.data


def _address_of_function(name: str, value: Any) -> Any:
    try:
        function = getattr(value, "ctypes", value)  # numba's cfunc has one of ctypes
    except TypeError:  # with arguments that ctypes has no type for
        function = None
    if not isinstance(function, CFuncPtr):
        return getattr(value, "address", value)
    takes, returns = function.argtypes, function.restype
    if takes is not None:  # else it is a library's, of which ctypes was told nothing
        # As what such a function returns, ctypes has c_int until it is told.
        is_told = returns is not ctypes.c_int or hasattr(type(function), "_argtypes_")
        kinds = [_kind_of(one) for one in takes]
        fits = len(kinds) == len(_TAKEN) and all(map(_fits, kinds, _TAKEN))
        if not fits or (returns is not None and is_told):
            listed = ", ".join(getattr(one, "__name__", str(one)) for one in takes)
            raise TypeError(
                f"{name}: takes ({listed}) and returns {getattr(returns, '__name__', returns)}: "
                f"must be {_RIGHT}, a function of t, n, q, qd, Q and data"
            )
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _kind_of(taken: Any) -> str:
    """Return what ctypes is told of an argument, in C's words; ``"void*"`` for any address."""
    if taken in (ctypes.c_double, ctypes.c_int):
        return "double" if taken is ctypes.c_double else "int"
    if not hasattr(taken, "from_param"):  # it is no type of ctypes
        return "other"
    if issubclass(taken, ctypes._Pointer):
        pointed = taken._type_
        while issubclass(pointed, ctypes.Array):
            pointed = pointed._type_
        return f"{_kind_of(pointed)}*"
    if (dtype := getattr(taken, "_dtype_", None)) is not None:  # of NumPy's ndpointer
        return "double*" if dtype == np.float64 else "other*"
    letter = getattr(taken, "_type_", "?")  # that of an array is a class
    is_address = isinstance(letter, str) and letter in _ADDRESSES
    is_wide = is_address and ctypes.sizeof(taken) == ctypes.sizeof(ctypes.c_void_p)
    return "void*" if is_wide else "other"


def _fits(kind: str, wanted: str) -> bool:
    """Return whether an argument is what the core hands over: `void*` goes with any pointer."""
    both_point = kind.endswith("*") and wanted.endswith("*")
    return kind == wanted or (both_point and "void*" in (kind, wanted))
