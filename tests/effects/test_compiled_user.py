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
