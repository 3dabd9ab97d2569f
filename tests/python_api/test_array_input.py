"""Arrays of any make are read for what they hold, left as they are, and not kept."""

from __future__ import annotations

import array

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

SCENE = pc.Scene.textbook()


def read_only(x):
    x = x.copy()
    x.flags.writeable = False
    return x


class ArrayLike:
    """An object that is no array, but can be read as one."""

    def __init__(self, x):
        self._x = x

    def __array__(self, dtype=None, copy=None):
        return self._x.copy()


FORMS = {
    "read-only": read_only,
    "strided": lambda x: np.repeat(x, 3)[::3],
    "reversed": lambda x: x[::-1].copy()[::-1],
    "column of a table": lambda x: np.tile(x[:, None], (1, 3))[:, 1],
    "repeated by a stride of zero": lambda x: np.broadcast_to(x[:1], x.shape),
    "big-endian": lambda x: x.astype(">f8"),
    "unaligned": lambda x: np.frombuffer(b"\0" + x.tobytes(), np.uint8)[1:].view(np.float64),
    "long double": lambda x: x.astype(np.longdouble),
    "single": lambda x: x.astype(np.float32),
    "half": lambda x: x.astype(np.float16),
    "memoryview": lambda x: memoryview(x.copy()),
    "array.array": lambda x: array.array("d", x),
    "array-like": ArrayLike,
    "list of NumPy's numbers": list,
    "tuple": lambda x: tuple(x.tolist()),
}
"""Numbers of few bits, so that they are the same in every form."""


def run_with(name):
    def ask(values):
        capped = {"t_span": (0, 4), "max_steps": 50, "on_failure": "ignore"}
        sol = pc.simulate(
            SCENE, **({"q0": [0.25, 1.0], "qd0": [0.5, -1.0]} | capped | {name: values})
        )
        return np.vstack([sol.t, sol.y])

    return ask


DENSE = pc.simulate(SCENE, q0=[0.25, 1.0], qd0=[0.5, -1.0], t_span=(0, 2))
TAKEN = {
    "q0": ([0.25, 1.0], run_with("q0")),
    "qd0": ([0.5, -1.0], run_with("qd0")),
    "rtol": ([2.0**-20] * 4, run_with("rtol")),
    "atol": ([2.0**-12] * 4, run_with("atol")),
    "t_eval": ([0.0, 0.125, 0.25], run_with("t_eval")),
    "sol(t)": ([0.125, 1.5, 1.0], DENSE),
    "accelerations": ([0.25, 1.0], lambda x: SCENE.accelerations(0.5, x, x)),
    "mass_matrix": ([0.25, 1.0], SCENE.mass_matrix),
    "angles_from_vertical": ([0.25, 1.0], pc.angles_from_vertical),
    "table": ([-0.5, 1.0, 2.5], lambda x: np.array([fx.Table(t=[0, 1, 2], torque=x).torque])),
    "wind": ([0.5, -1.0], lambda x: np.array([fx.RodDrag(1, 1.0, 0.5, wind=x).wind])),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("taken", TAKEN)
def test_an_array_of_any_make_is_read_for_what_it_holds(taken, form):
    values, ask = TAKEN[taken]
    if form == "repeated by a stride of zero":
        if taken == "t_eval":
            pytest.skip("times must differ")
        values = values[:1] * len(values)
    given = FORMS[form](np.array(values))
    assert np.array_equal(ask(given), ask(values))
    assert np.array_equal(np.asarray(given, dtype=float), values)  # left as it was


def members(**given):
    return pc.ensemble(SCENE, **({"q0": [0.25, 1.0], "t_span": (0, 1)} | given)).q


def resumed(times):
    begun = pc.simulate(SCENE, q0=0.5, t_span=(0, 0.25), t_eval=[0.25])
    return begun.resume(2, times).t


def under_constant_torques(torques):
    scene = SCENE.replace(effects=[fx.User(lambda *_: torques)])
    return scene.accelerations(0.0, [0, 0], [0, 0])


ALSO_TAKEN = {
    "ensemble q0": ([[0.25, 1.0], [0.5, 1.0]], lambda x: members(q0=x)),
    "ensemble qd0": ([[0.25, 1.0], [0.5, 1.0]], lambda x: members(qd0=x)),
    "vary": ([9.0, 10.0], lambda x: members(vary={"gravity": x})),
    "t_eval of members": ([0.25, 1.0], lambda x: members(keep="times", t_eval=x)),
    "rates of accelerations": ([0.25, 1.0], lambda x: SCENE.accelerations(0.5, [0, 0], x)),
    "times of accelerations": ([0.25, 1.0], lambda x: SCENE.accelerations(x, [0, 0], [0, 0])),
    "angles_to_vertical": ([0.25, 1.0], pc.angles_to_vertical),
    "spline": ([0.0, 1.0, 0.5], lambda x: np.array([fx.Spline([0, 1, 2], x, [0, 0, 0]).x])),
    "case": ([0.25, 1.0], lambda x: np.array(pc.Case(scene=SCENE, q0=x, t_span=(0, 1)).q0)),
    "t_span": ([0.0, 1.0], lambda x: pc.simulate(SCENE, q0=0.5, t_span=x).t),
    "resume": ([0.5, 1.0], resumed),
    "lyapunov": ([0.25, 1.0], lambda x: pc.lyapunov(SCENE, q0=x, t_span=(0, 1)).exponents),
    "tip line": ([0.25, 1.0], lambda x: np.array([pc.events.TipLine(x, normal=(0, 1)).point])),
    "torques of a law": ([0.25, 1.0], under_constant_torques),
}


def masked(values):
    given = np.ma.array(values, dtype=float)
    given[(0,) * given.ndim] = np.ma.masked
    return given


MASKED = {
    "an array": masked,
    "an array of whole numbers": lambda x: np.ma.array(np.ones(np.shape(x), int), mask=True),
    "a list": lambda x: [*masked(x)],
}


@pytest.mark.parametrize("form", MASKED)
@pytest.mark.parametrize("taken", TAKEN | ALSO_TAKEN)
def test_masked_values_are_refused_where_numbers_are_taken(taken, form):
    values, ask = (TAKEN | ALSO_TAKEN)[taken]
    unmasked = np.ma.array(values, dtype=float)
    assert np.array_equal(ask(unmasked), ask(values))
    with pytest.raises(ValueError, match=r"^[^=]+: has masked values: must have a number"):
        ask(MASKED[form](values))


@pytest.mark.parametrize("order", ["C", "F"])
def test_tables_of_states_are_read_in_either_order(order):
    q = np.arange(24.0).reshape(3, 4, 2)
    rows = [[SCENE.accelerations(0.0, x, 2 * x) for x in y] for y in q]
    found = SCENE.accelerations(0.0, np.asarray(q, order=order), np.asarray(2 * q, order=order))
    assert np.array_equal(found, rows)
    turned = SCENE.accelerations(0.0, q.swapaxes(0, 1), 2 * q.swapaxes(0, 1))
    assert np.array_equal(turned, found.swapaxes(0, 1))
    assert SCENE.accelerations(0.0, q[:0], q[:0]).shape == (0, 4, 2)
    assert SCENE.mass_matrix(q[:, :0]).shape == (3, 0, 2, 2)


def test_what_was_handed_over_may_be_changed_afterwards():
    q0, times, rtol = np.array([0.25, 1.0]), np.array([0.5, 1.0]), np.full(4, 1e-6)
    sol = pc.simulate(SCENE, q0=q0, t_span=(0, 1), t_eval=times, rtol=rtol)
    before, case = sol.y.copy(), sol.case()
    for x in (q0, times, rtol):
        x[:] = 7.0
    assert np.array_equal(sol.y, before)
    assert sol.case() == case
    longer = pc.simulate(SCENE, q0=[0.25, 1.0], t_span=(0, 2), t_eval=[0.5, 1.0], rtol=[1e-6] * 4)
    assert np.array_equal(sol.resume(2).y, longer.y)
