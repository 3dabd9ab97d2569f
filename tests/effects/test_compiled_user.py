"""A compiled function reads what it is handed; what it would misread is refused."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from compiled_functions import DOUBLES, FORCES
from pendcore import effects as fx

NOTHING = FORCES(lambda *_: None)
SPLIT = "is an array of float64, not contiguous"
DATA = {
    "whole numbers": (np.array([1, 2]), "is an array of int64"),
    "singles": (np.array([0.1], dtype=np.float32), "is an array of float32"),
    "other bytes": (np.array([0.1], dtype=">f8"), "is an array of >f8"),
    "every other": (np.arange(4.0)[::2], SPLIT),
    "a column": (np.eye(2)[:, 1], SPLIT),
    "by columns": (np.asfortranarray(np.ones((2, 3))), SPLIT),
}


@pytest.mark.parametrize("name", DATA)
def test_data_that_a_function_would_misread_is_refused(name):
    data, told = DATA[name]
    must = f"^CompiledUser: data: {told}: must be a C-contiguous one of float64"
    with pytest.raises(TypeError, match=must):
        fx.CompiledUser(NOTHING, data=data)
    mended = np.ascontiguousarray(data, dtype=np.float64)  # as the message says
    assert fx.CompiledUser(NOTHING, data=mended).data == mended.ctypes.data


def test_data_with_masked_values_is_refused():
    with pytest.raises(ValueError, match=r"^CompiledUser: data: has masked values"):
        fx.CompiledUser(NOTHING, data=np.ma.array([0.1, 0.2], mask=[False, True]))
    whole = np.ma.array([0.1, 0.2])
    assert fx.CompiledUser(NOTHING, data=whole).data == whole.ctypes.data


class Magnet(ctypes.Structure):
    _fields_ = (("strength", ctypes.c_double),)


def signature(*forces, time=ctypes.c_double, count=ctypes.c_int, data=(ctypes.c_void_p,), of=None):
    """What it returns, and what it takes: time, count, three pointers, data."""
    return [of, time, count, *(forces or [DOUBLES] * 3), *data]


D, P = ctypes.c_double, ctypes.POINTER
OF_SINGLES, OF_DOUBLES = (np.ctypeslib.ndpointer(kind) for kind in (np.float32, np.float64))
WRONG = {
    "of time alone": [None, D],
    "without data": signature(data=()),
    "with too much": signature(data=(ctypes.c_void_p, ctypes.c_int)),
    "a time in singles": signature(time=ctypes.c_float),
    "a long count": signature(count=ctypes.c_int64),
    "angles in singles": signature(*[P(ctypes.c_float)] * 3),
    "one angle": signature(D, D, DOUBLES),
    "pointers to pointers": signature(*[P(DOUBLES)] * 3),
    "arrays of singles": signature(*[OF_SINGLES] * 3, data=(DOUBLES,)),
    "data by value": signature(data=(D,)),
    "a result": signature(of=D),
    "a status": signature(of=ctypes.c_int),
}
RIGHT = {
    "as its page says": signature(),
    "data of a struct": signature(count=ctypes.c_int32, data=(P(Magnet),)),
    "data of doubles": signature(data=(DOUBLES,)),
    "data by its address": signature(data=(ctypes.c_size_t,)),
    "an object of Python": signature(data=(ctypes.py_object,)),
    "any pointers": signature(*[ctypes.c_void_p] * 3),
    "pointers to pairs": signature(*[P(D * 2)] * 3),
    "NumPy's pointers": signature(*[OF_DOUBLES] * 3, data=(DOUBLES,)),
}


def callback(returns, *takes):
    return ctypes.CFUNCTYPE(returns, *takes)(lambda *_: None)


def library_function(restype=ctypes.c_int, *argtypes):
    """Return a function of a library, and what ctypes was told of it; nobody calls it."""
    function = ctypes.CDLL(None)["qsort"]
    if argtypes:
        function.argtypes = argtypes
    function.restype = restype
    return function


@pytest.mark.parametrize("name", WRONG)
def test_a_function_of_another_signature_is_refused_with_the_right_one(name):
    returns, *takes = WRONG[name]
    functions = []
    if "arrays" not in name:  # of these, ctypes makes no callbacks
        functions.append(callback(returns, *takes))
    if name != "a status":  # as ctypes says of any function of a library
        functions.append(library_function(returns, *takes))
    for function in functions:
        with pytest.raises(TypeError) as caught:
            fx.CompiledUser(function)
        told, right = str(caught.value).split(": must be ")
        names = ", ".join(one.__name__ for one in takes)
        returned = getattr(returns, "__name__", None)
        assert told == f"CompiledUser: address: takes ({names}) and returns {returned}"
        mended = eval(right.partition(", a function of")[0], vars(ctypes))
        assert fx.CompiledUser(mended(lambda *_: None)).address


@pytest.mark.parametrize("name", RIGHT)
def test_a_function_that_reads_what_it_is_handed_is_taken(name):
    returns, *takes = RIGHT[name]
    if "NumPy" not in name:
        assert fx.CompiledUser(callback(returns, *takes)).address
    assert fx.CompiledUser(library_function(returns, *takes)).address
    assert fx.CompiledUser(library_function(ctypes.c_int, *takes)).address


def test_of_a_library_that_says_nothing_a_function_is_taken_as_it_is():
    function = library_function()
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert fx.CompiledUser(function).address == address
    assert fx.CompiledUser(address).address == address


class Cfunc:
    """What numba makes has its address, and a function of ctypes with the signature."""

    def __init__(self, returns, *takes):
        self.ctypes = callback(returns, *takes)
        self.address = ctypes.cast(self.ctypes, ctypes.c_void_p).value


class CfuncOfRecords:
    """Pointers to records have no type of ctypes in numba."""

    address = 4096

    @property
    def ctypes(self):
        raise TypeError


def test_numbas_functions_are_looked_at_as_well():
    assert fx.CompiledUser(CfuncOfRecords()).address == 4096
    numbas = Cfunc(*RIGHT["as its page says"])
    assert fx.CompiledUser(numbas).address == numbas.address
    with pytest.raises(TypeError, match=r"^CompiledUser: address: takes \(c_double\) and returns"):
        fx.CompiledUser(Cfunc(*WRONG["of time alone"]))
