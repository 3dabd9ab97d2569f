"""A compiled function reads what it is handed, and a message tells what ctypes drops."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import DOUBLES, FORCES
from pendcore import effects as fx

ROD = pc.Link(mass=1, length=1)
START = {"q0": [0.5, 1.0], "qd0": [1.0, -1.0], "t_span": (0, 2)}


def scene(*effects):
    return pc.Scene(links=[ROD, ROD], effects=effects)


@FORCES
def damp_by_data(t, n, q, qd, forces, data):
    coefficient = ctypes.cast(data, DOUBLES)[0]
    for i in range(n):
        forces[i] -= coefficient * qd[i]


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (np.array([1, 2]), "is an array of int64"),
        (np.array([0.1], dtype=np.float32), "is an array of float32"),
        (np.array([0.1], dtype=">f8"), "is an array of >f8"),
        (np.arange(4.0)[::2], "is an array of float64, not contiguous"),
        (np.eye(2)[:, 1], "is an array of float64, not contiguous"),
        (np.asfortranarray(np.ones((2, 3))), "is an array of float64, not contiguous"),
    ],
    ids=["whole numbers", "singles", "other bytes", "every other", "a column", "by columns"],
)
def test_data_that_a_function_would_misread_is_refused(data, told):
    with pytest.raises(TypeError) as caught:
        fx.CompiledUser(damp_by_data, data=data)
    message = str(caught.value)
    assert message.startswith(f"CompiledUser: data: {told}: must be a C-contiguous one of float64")
    mended = np.ascontiguousarray(data, dtype=np.float64)  # as the message says
    effect = fx.CompiledUser(damp_by_data, data=mended)
    assert effect.data == mended.ctypes.data


def test_data_with_masked_values_is_refused():
    data = np.ma.array([0.1, 0.2], mask=[False, True])
    with pytest.raises(ValueError, match=r"^CompiledUser: data: has masked values"):
        fx.CompiledUser(damp_by_data, data=data)
    whole = np.ma.array([0.1, 0.2])
    assert fx.CompiledUser(damp_by_data, data=whole).data == whole.ctypes.data


D, P = ctypes.c_double, ctypes.POINTER
POINTERS = [DOUBLES] * 3
SINGLES = np.ctypeslib.ndpointer(np.float32)
WRONG = {
    "of time alone": [None, D],
    "without data": [None, D, ctypes.c_int, *POINTERS],
    "with too much": [None, D, ctypes.c_int, *POINTERS, ctypes.c_void_p, ctypes.c_int],
    "a time in singles": [None, ctypes.c_float, ctypes.c_int, *POINTERS, ctypes.c_void_p],
    "a long count": [None, D, ctypes.c_int64, *POINTERS, ctypes.c_void_p],
    "angles in singles": [None, D, ctypes.c_int, *[P(ctypes.c_float)] * 3, ctypes.c_void_p],
    "one angle": [None, D, ctypes.c_int, D, D, DOUBLES, ctypes.c_void_p],
    "pointers to pointers": [None, D, ctypes.c_int, *[P(DOUBLES)] * 3, ctypes.c_void_p],
    "arrays of singles": [None, D, ctypes.c_int, *[SINGLES] * 3, DOUBLES],
    "data by value": [None, D, ctypes.c_int, *POINTERS, D],
    "a result": [D, D, ctypes.c_int, *POINTERS, ctypes.c_void_p],
    "a status": [ctypes.c_int, D, ctypes.c_int, *POINTERS, ctypes.c_void_p],
}


class Magnet(ctypes.Structure):
    _fields_ = (("strength", D),)


RIGHT = {
    "as its page says": [None, D, ctypes.c_int, *POINTERS, ctypes.c_void_p],
    "data of a struct": [None, D, ctypes.c_int32, *POINTERS, P(Magnet)],
    "data of doubles": [None, D, ctypes.c_int, *POINTERS, DOUBLES],
    "data by its address": [None, D, ctypes.c_int, *POINTERS, ctypes.c_size_t],
    "an object of Python": [None, D, ctypes.c_int, *POINTERS, ctypes.py_object],
    "any pointers": [None, D, ctypes.c_int, *[ctypes.c_void_p] * 4],
    "pointers to pairs": [None, D, ctypes.c_int, *[P(D * 2)] * 3, ctypes.c_void_p],
    "NumPy's pointers": [None, D, ctypes.c_int, *[np.ctypeslib.ndpointer(np.float64)] * 3, DOUBLES],
}


def library_function(restype=ctypes.c_int, *argtypes):
    """Return a function of a library, and what ctypes was told of it; nobody calls it."""
    function = ctypes.CDLL(None)["qsort"]
    if argtypes:
        function.argtypes = argtypes
    function.restype = restype
    return function


@pytest.mark.every_value("signature")
@pytest.mark.parametrize("signature", WRONG)
def test_a_function_of_another_signature_is_refused_with_the_right_one(signature):
    returns, *takes = WRONG[signature]
    functions = []
    if "arrays" not in signature:  # of these, ctypes makes no callbacks
        functions.append(ctypes.CFUNCTYPE(returns, *takes)(lambda *_: None))
    if signature != "a status":  # as ctypes says of any function of a library
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


@pytest.mark.every_value("signature")
@pytest.mark.parametrize("signature", RIGHT)
def test_a_function_that_reads_what_it_is_handed_is_taken(signature):
    returns, *takes = RIGHT[signature]
    if "NumPy" not in signature:
        assert fx.CompiledUser(ctypes.CFUNCTYPE(returns, *takes)(lambda *_: None)).address
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
        self.ctypes = ctypes.CFUNCTYPE(returns, *takes)(lambda *_: None)
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


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_exception_in_a_ctypes_callback_is_lost_as_its_page_says():
    @FORCES
    def broken(t, n, q, qd, forces, data):
        raise RuntimeError

    run = pc.simulate(scene(fx.CompiledUser(broken)), **START, method="dop853")
    assert run.success
    assert np.array_equal(run.y, pc.simulate(scene(), **START, method="dop853").y)
    page = (Path(__file__).parents[2] / "docs/effects/compiled_user.md").read_text()
    assert (
        "An exception in a ctypes callback that is written in Python never reaches pendcore" in page
    )
