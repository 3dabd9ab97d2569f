"""Tables of torques lose no digits; where they jump, or a function has a break, no step errs."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import FORCES
from numpy.typing import NDArray
from pendcore import effects as fx
from unit_rods import rod

Array = NDArray[np.float64]
METHODS = ["dopri5", "dop853", "taylor", "radau5", "auto", "rk4"]
JUMPS = [0.0, 0.4, 0.75, 2.0, 3.0]
HELD = [1.0, -2.0, 0.5, -0.25]
"""The torque between two of the jumps."""


def torque(t: float) -> float:
    return HELD[min(np.searchsorted(JUMPS, t, side="right") - 1, 3)]


def torque_before(t: float) -> float:
    """The same, but with the value before the jump at the jump itself."""
    return HELD[max(np.searchsorted(JUMPS, t, side="left") - 1, 0)]


@FORCES
def compiled_torque(t, n, q, qd, forces, data):  # type: ignore[no-untyped-def]
    forces[0] += torque(t)


BREAKS = JUMPS[1:-1]
HOLD = fx.Table(JUMPS, [*HELD, 7.0], hold=True)
STEPS = fx.Table([0.0, *np.repeat(BREAKS, 2), 3.0], np.repeat(HELD, 2))
LAWS: dict[str, fx.Effect] = {
    "held": fx.Motor(1, table=HOLD),
    "steps": fx.Motor(1, table=STEPS),
    "held, with a limit": fx.Motor(1, table=HOLD.replace(torque=[9.0, -9, 0.5, -0.25, 7]), limit=2),
    "steps, with a limit": fx.Motor(1, table=STEPS, limit=5.0),
    "function": fx.User(lambda t, q, qd: [torque(t)], breaks=BREAKS),
    "function, other side": fx.User(lambda t, q, qd: [torque_before(t)], breaks=BREAKS),
    "compiled": fx.CompiledUser(compiled_torque, breaks=BREAKS),
}
CASES = [
    (name, method)
    for name, effect in LAWS.items()
    for method in METHODS
    if method != "taylor" or isinstance(effect, fx.Motor)  # a function has no series
]


def held_of(name: str) -> list[float]:
    return [2.0, *HELD[1:]] if name == "held, with a limit" else HELD


def exact(t: float, held: Sequence[float] = HELD) -> tuple[float, float]:
    """Return angle and rate of a rod of inertia 1 that starts at rest at 0."""
    q = w = 0.0
    for (begin, end), a in zip(pairwise(JUMPS), held, strict=True):
        s = min(t, end) - begin
        if s > 0:
            q, w = q + w * s + a * s**2 / 2, w + a * s
    return q, w


def options(method: str) -> dict[str, Any]:
    return {"method": method, "rtol": 1e-3, "atol": 1e-3, "step": 0.1 if method == "rk4" else None}


@pytest.mark.parametrize(("name", "method"), CASES)
def test_a_torque_that_jumps_moves_a_rod_along_parabolas(name: str, method: str) -> None:
    """However loose the tolerance: no step goes across a jump, so that none has an error."""
    scene, held = rod(LAWS[name]), held_of(name)
    sol = pc.simulate(scene, q0=0.0, t_span=(0, 3), **options(method))
    times = np.linspace(0, 3, 61)
    expected = np.array([exact(t, held) for t in times]).T
    np.testing.assert_allclose(sol(times), expected, rtol=1e-13, atol=1e-13)
    assert set(JUMPS) <= set(sol.t)
    assert sol.stats.rejected == 0
    assert sol.stats.limited_by_break >= len(JUMPS) - 1
    back = pc.simulate(scene, (3, 0), *exact(3.0, held), **options(method))
    np.testing.assert_allclose(back(times), expected, rtol=1e-12, atol=1e-12)
    assert set(JUMPS) <= set(back.t)


@pytest.mark.parametrize("name", LAWS)
def test_at_a_jump_the_acceleration_is_that_after_it(name: str) -> None:
    scene, held = rod(LAWS[name]), held_of(name)
    for t, after in zip(JUMPS[:-1], held, strict=True):
        assert scene.accelerations(t, [0.3], [0.1]).item() == pytest.approx(after, rel=1e-15)
    sol = pc.simulate(scene, q0=0.0, t_span=(0, 2.5))
    at = [int(np.flatnonzero(sol.t == t)[0]) for t in JUMPS[:-1]]
    across = np.array([-np.sin(sol.q[at, 0]), np.cos(sol.q[at, 0])])
    force = np.einsum("ik,ki->k", across, sol.reactions()[at, 0])
    np.testing.assert_allclose(force, 1.5 * np.array(held), rtol=1e-12)  # m c qdd


@pytest.mark.few_cases
@pytest.mark.parametrize(("name", "method"), CASES)
@pytest.mark.parametrize("sense", [1, -1])
def test_a_run_resumed_between_jumps_and_at_one_has_the_bits_of_one_run(
    name: str, method: str, sense: int
) -> None:
    is_function = isinstance(LAWS[name], fx.User | fx.CompiledUser)  # of one angle, not to pickle
    spring = fx.TorsionalSpring(1, stiffness=3.0)
    scene = rod(LAWS[name], spring, links=1 if is_function else 2, gravity=9.81)
    begin, end = (0, 2.9) if sense > 0 else (2.9, 0)
    how = options(method) | {"rtol": 1e-9, "atol": 1e-9, "ledger": True}
    whole = pc.simulate(scene, q0=0.3, t_span=(begin, end), **how)
    for cut in (0.55, 0.75, 1.1):
        part = pc.simulate(scene, q0=0.3, t_span=(begin, cut), **how)
        longer = (part if is_function else pickle.loads(pickle.dumps(part))).resume(end)
        assert np.array_equal(longer.t, whole.t)
        assert np.array_equal(longer.y, whole.y)


TWO = fx.User(lambda t, q, qd: [torque(t), 0.0], breaks=BREAKS)


@pytest.mark.parametrize("effect", [LAWS["held"], LAWS["steps"], TWO], ids=["held", "steps", "own"])
def test_two_rods_move_as_in_runs_from_jump_to_jump(effect: fx.Effect) -> None:
    """Under a constant torque each, which no table has part in."""
    tight = {"method": "dop853", "rtol": 1e-12, "atol": 1e-12}
    sol = pc.simulate(rod(effect, links=2, gravity=9.81), q0=[0.4, 1.0], t_span=(0, 3), **tight)
    q, qd = np.array([0.4, 1.0]), np.zeros(2)
    for (begin, end), held in zip(pairwise(JUMPS), HELD, strict=True):
        scene = rod(fx.Motor(1, constant=held), links=2, gravity=9.81)
        y = pc.simulate(scene, q0=q, qd0=qd, t_span=(begin, end), **tight).y[:, -1]
        q, qd = y[:2], y[2:]
        np.testing.assert_allclose(sol(end), y, rtol=1e-9, atol=1e-9)


def torque_of(table: fx.Table, t: float) -> Fraction:
    knots = zip(map(Fraction, table.t), map(Fraction, table.torque), strict=True)
    for (t0, before), (t1, after) in pairwise(knots):
        if t0 <= t < t1:
            share = 0 if table.hold else (Fraction(t) - t0) / (t1 - t0)
            return before + (after - before) * share
    raise AssertionError(t)


@pytest.mark.parametrize("begin", [0.0, -0.05, -0.3, -1.0, -10.0, -1000.0, -1e6, 1000.0])
def test_a_table_is_right_to_its_last_digits_wherever_in_time_it_lies(begin: float) -> None:
    one = fx.Table(t=[begin, begin + 0.125, begin + 0.4], torque=[0.0, 1.0, -0.5])
    other = fx.Table(t=[begin, begin + 0.25, begin + 0.5], torque=[0.25, -1.0, 1.0])
    jumps = [begin, begin + 0.2, begin + 0.2, begin + 0.5]
    stepping = fx.Table(t=jumps, torque=[1.0, 0.5, -1.0, -0.25])
    for tables in ([one], [one, other], [stepping], [other.replace(hold=True)]):
        motors = [fx.Motor(1, constant=0.125), *(fx.Motor(1, table=table) for table in tables)]
        scene = rod(*motors)
        for t in [*np.linspace(begin, begin + 0.4, 97)[1:-1].tolist(), *jumps[:-1]]:
            found = Fraction(scene.accelerations(t, [0.0], [0.0]).item())
            off = found - Fraction(0.125) - sum(torque_of(table, t) for table in tables)
            assert abs(off) <= 4 * np.finfo(float).eps


def test_a_function_is_not_called_at_its_breaks_nor_beyond_them_in_a_step() -> None:
    called: list[float] = []

    def law(t: float, q: Array, qd: Array) -> list[float]:
        called.append(t)
        return [1.0]

    for ends in ((0, 1), (1, 0)):
        called.clear()
        sol = pc.simulate(rod(fx.User(law, breaks=[0.5])), q0=0.0, t_span=ends, rtol=1e-3)
        assert 0.5 in sol.t
        assert 0.5 not in called
        assert sum(a != b for a, b in pairwise(t < 0.5 for t in called)) == 1


@FORCES
def compiled_jump(t, n, q, qd, forces, data):  # type: ignore[no-untyped-def]
    forces[0] += 1e9 if t > 0.5 else 0.0


JUMP = fx.User(lambda t, q, qd: [1e9 * (t > 0.5)])


@pytest.mark.parametrize("law", [JUMP, fx.CompiledUser(compiled_jump)], ids=["py", "c"])
def test_a_step_that_a_jump_makes_too_small_is_told_with_its_remedy(law: Any) -> None:
    how: dict[str, Any] = {"t_span": (0, 1), "rtol": 1e-12, "atol": 1e-12, "on_failure": "ignore"}
    smooth = fx.ViscousJoint(joint=1, damping=0.0)
    sol = pc.simulate(rod(smooth, law), q0=0.0, **how)
    assert sol.status == "step_too_small"
    assert sol.t[-1] == pytest.approx(0.5)
    remedy = "or a law jumps here: effect 2 (user): name the times of its jumps, breaks="
    assert remedy in sol.message
    pulled = fx.Motor(joint=1, pd=fx.PD(kp=-1e9, kd=-1e9, reference=0.0))
    assert "law jumps" not in pc.simulate(rod(pulled), q0=1.0, **how).message
    mended = pc.simulate(rod(law.replace(breaks=[0.5])), q0=0.0, **how)
    assert mended.success
    assert mended.y[:, -1] == pytest.approx([1e9 / 8, 1e9 / 2], rel=1e-12)
