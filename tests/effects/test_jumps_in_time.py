"""Laws that jump at known times: tables that hold their values or step, functions with breaks."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import FORCES
from numpy.typing import NDArray
from pendcore import effects as fx
from reference.effects import law
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import uniform_rod
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


def stepping() -> fx.Table:
    inner = [t for t in JUMPS[1:-1] for _ in range(2)]
    return fx.Table([0.0, *inner, 3.0], np.repeat(HELD, 2))


HOLD = fx.Table(JUMPS, [*HELD, 7.0], hold=True)
BREAKS = JUMPS[1:-1]
LAWS: dict[str, fx.Effect] = {
    "held": fx.Motor(1, table=HOLD),
    "steps": fx.Motor(1, table=stepping()),
    "held, with a limit": fx.Motor(1, table=HOLD.replace(torque=[9.0, -9, 0.5, -0.25, 7]), limit=2),
    "steps, with a limit": fx.Motor(1, table=stepping(), limit=5.0),
    "function": fx.User(lambda t, q, qd: [torque(t)], breaks=BREAKS),
    "function, other side": fx.User(lambda t, q, qd: [torque_before(t)], breaks=BREAKS),
    "compiled": fx.CompiledUser(compiled_torque, breaks=BREAKS),
}


def exact(t: float, held: Sequence[float] = HELD) -> tuple[float, float]:
    """Return angle and rate of a rod of inertia 1 that starts at rest at 0."""
    q = w = 0.0
    for (begin, end), a in zip(pairwise(JUMPS), held, strict=True):
        s = min(t, end) - begin
        if s > 0:
            q, w = q + w * s + a * s**2 / 2, w + a * s
    return q, w


def held_of(name: str) -> list[float]:
    return [2.0, *HELD[1:]] if name == "held, with a limit" else HELD


def options(method: str) -> dict[str, Any]:
    return {"method": method, "rtol": 1e-3, "atol": 1e-3, "step": 0.1 if method == "rk4" else None}


def methods_of(name: str) -> list[str]:
    """All methods; a function has no series."""
    return [m for m in METHODS if m != "taylor" or isinstance(LAWS[name], fx.Motor)]


CASES = [(name, method) for name in LAWS for method in methods_of(name)]


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


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("method", ["dopri5", "radau5"])
def test_members_of_an_ensemble_have_the_bits_of_their_runs_alone(name: str, method: str) -> None:
    scene = rod(LAWS[name], gravity=9.81)
    starts = np.linspace(-1, 2, 9)[:, None]
    many = pc.ensemble(scene, q0=starts, t_span=(0, 3), method=method)
    for i, q0 in enumerate(starts):
        alone = pc.simulate(scene, q0=q0, t_span=(0, 3), method=method)
        assert np.array_equal(many.q[i], alone.q[-1])
        assert np.array_equal(many.qd[i], alone.qd[-1])


@pytest.mark.parametrize("name", ["held", "steps", "function"])
def test_two_rods_move_as_in_runs_from_jump_to_jump(name: str) -> None:
    """Under a constant torque each, which no table has part in."""
    effect = LAWS[name]
    if name == "function":
        effect = fx.User(lambda t, q, qd: [torque(t), 0.0], breaks=BREAKS)
    tight = {"method": "dop853", "rtol": 1e-12, "atol": 1e-12}
    sol = pc.simulate(rod(effect, links=2, gravity=9.81), q0=[0.4, 1.0], t_span=(0, 3), **tight)
    q, qd = np.array([0.4, 1.0]), np.zeros(2)
    for (begin, end), held in zip(pairwise(JUMPS), HELD, strict=True):
        scene = rod(fx.Motor(1, constant=held), links=2, gravity=9.81)
        y = pc.simulate(scene, q0=q, qd0=qd, t_span=(begin, end), **tight).y[:, -1]
        q, qd = y[:2], y[2:]
        np.testing.assert_allclose(sol(end), y, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("table", [HOLD, stepping()], ids=["held", "steps"])
def test_the_torque_is_that_of_the_reference(table: fx.Table) -> None:
    reference = law(("motor", {"joint": 1, "table": table.particulars()}))
    scene = rod(fx.Motor(1, table=table))
    for t in [*np.linspace(0, 2.99, 100), *JUMPS[:-1]]:
        loads = Loads(1)
        reference.act(Instant(bodies=[uniform_rod(3, 1)], gravity=0, q=[0], qd=[0], t=t), loads)
        expected = loads.couples[0].value
        assert scene.accelerations(t, [0.0], [0.0]).item() == pytest.approx(expected, rel=1e-14)


def test_tables_that_hold_or_step_come_back_from_files(tmp_path: Path) -> None:
    scene = rod(fx.Motor(1, table=HOLD), fx.Motor(1, table=stepping()))
    case = pc.Case(scene=scene, q0=0.1, t_span=(0, 1))
    text = case.to_toml()
    assert "torque = [1.0, -2.0, 0.5, -0.25, 7.0], hold = true}" in text
    assert pc.read_case(text).scene == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    sol = case.simulate()
    sol.save(tmp_path / "run.npz")
    again = pc.load(tmp_path / "run.npz")
    assert again.scene == scene
    assert np.array_equal(again.resume(2.5).y, sol.resume(2.5).y)
    assert repr(scene.effects[0]).endswith("hold=True))")


REFUSED: dict[str, tuple[Callable[[], object], type[Exception], str]] = {
    "hold": (
        lambda: fx.Table([0, 1], [0, 1], hold=1),  # type: ignore[arg-type]
        TypeError, r"^Table: hold = 1: must be True or False$",
    ),
    "twice, held": (
        lambda: fx.Table([0, 1, 1, 2], [0, 1, 2, 3], hold=True),
        ValueError, r"^Table: t\[2\] = 1.0: must be above the time before, 1.0 \(s\): with hold = ",
    ),
    "thrice": (
        lambda: fx.Table([0, 1, 1, 1, 2], [0, 1, 2, 3, 4]),
        ValueError, r"t\[3\] = 1.0: must be above .*: a time may stand twice, for a step",
    ),
    "first": (lambda: fx.Table([0, 0, 1], [0, 1, 2]), ValueError, r"t\[1\] = 0.0: must .* between"),
    "last": (lambda: fx.Table([0, 1, 1], [0, 1, 2]), ValueError, r"t\[2\] = 1.0: must .* between"),
    "falls": (
        lambda: fx.Table([0, 2, 1], [0, 1, 2]),
        ValueError, r"t\[2\] = 1.0: must be above the time before, 2.0 \(s\)$",
    ),
    "breaks": (
        lambda: fx.User(torque, breaks=[1, 1]),
        ValueError, r"^User: breaks\[1\] = 1.0: must be above the time before, 1.0 \(s\)$",
    ),
    "infinite": (
        lambda: fx.User(torque, breaks=[np.inf]),
        ValueError, r"^User: breaks\[0\] = inf: must be finite \(s\)$",
    ),
    "compiled": (
        lambda: fx.CompiledUser(compiled_torque, breaks=[1, 0]),
        ValueError, r"^CompiledUser: breaks\[1\] = 0.0: must be above the time before, 1.0 \(s\)$",
    ),
    "spline": (lambda: fx.Spline([0, 1, 1], [0, 0, 0], [0, 0, 0]), ValueError, r"t\[2\] = 1.0: "),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_jump_so_is_refused(name: str) -> None:
    make, error, message = REFUSED[name]
    with pytest.raises(error, match=message):
        make()


def test_a_function_is_not_called_at_its_breaks_nor_beyond_them_in_a_step() -> None:
    called: list[float] = []

    def law(t: float, q: Array, qd: Array) -> list[float]:
        called.append(t)
        return [1.0]

    scene = rod(fx.User(law, breaks=[0.5]))
    for ends in ((0, 1), (1, 0)):
        called.clear()
        sol = pc.simulate(scene, q0=0.0, t_span=ends, rtol=1e-3)
        assert 0.5 in sol.t
        assert 0.5 not in called
        sides = [t < 0.5 for t in called]
        assert sum(a != b for a, b in pairwise(sides)) == 1


@pytest.mark.parametrize("effect", [fx.User, fx.CompiledUser])
def test_a_step_that_a_jump_makes_too_small_is_told_with_its_remedy(effect: Any) -> None:
    @FORCES
    def compiled(t, n, q, qd, forces, data):  # type: ignore[no-untyped-def]
        forces[0] += 1e9 if t > 0.5 else 0.0

    function = compiled if effect is fx.CompiledUser else lambda t, q, qd: [1e9 * (t > 0.5)]
    law = effect(function)
    how: dict[str, Any] = {"t_span": (0, 1), "rtol": 1e-12, "atol": 1e-12, "on_failure": "ignore"}
    sol = pc.simulate(rod(law), q0=0.0, **how)
    assert sol.status == "step_too_small"
    assert sol.t[-1] == pytest.approx(0.5)
    assert (
        "or a law jumps here: effect 1 (compiled_user): name the times of its jumps, breaks="
        in (sol.message)
    )
    mended = pc.simulate(rod(law.replace(breaks=[0.5])), q0=0.0, **how)
    assert mended.success
    assert mended.y[:, -1] == pytest.approx([1e9 / 8, 1e9 / 2], rel=1e-12)


def test_a_step_that_is_too_small_without_such_laws_does_not_name_any() -> None:
    blows_up = rod(fx.ViscousJoint(1, damping=0.0), fx.Motor(1, pd=fx.PD(-1e9, -1e9, 1.0)))
    sol = pc.simulate(
        blows_up, q0=1.5, qd0=3.0, t_span=(0, 100), on_failure="ignore", max_steps=100_000
    )
    assert not sol.success
    assert "law jumps" not in sol.message
