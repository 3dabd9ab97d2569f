"""Effects of the user's own: functions of Python and compiled ones, and what becomes of them."""

from __future__ import annotations

import copy
import ctypes
import gc
import pickle
import re
import subprocess
import weakref
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import DOUBLES, FORCES
from pendcore import effects as fx

ROD = pc.Link(mass=1, length=1)
START = {"q0": [0.5, 1.0], "qd0": [1.0, -1.0], "t_span": (0, 2)}
AT = (0.25, [1.0, 2.0], [3.0, 4.0])


def scene(*effects):
    return pc.Scene(links=[ROD, ROD], effects=effects)


def run(effect, **options):
    return pc.simulate(scene(effect), **(START | options))


def damp(t, q, qd):
    return -0.1 * qd


@FORCES
def compiled_damp(t, n, q, qd, forces, data):
    coefficient = ctypes.cast(data, DOUBLES)[0] if data else 0.1
    for i in range(n):
        forces[i] -= coefficient * qd[i]


def assert_damps(*effects):
    damped = run(fx.User(damp), ledger=True)
    for effect in effects:
        other = run(effect, ledger=True)
        assert np.array_equal(other.y, damped.y)
        assert np.array_equal(other.energy().ledger.user, damped.energy().ledger.user)


def test_a_function_moves_a_scene_the_same_from_python_and_compiled():
    assert_damps(
        fx.CompiledUser(compiled_damp),
        fx.CompiledUser(ctypes.cast(compiled_damp, ctypes.c_void_p).value),
        fx.CompiledUser(compiled_damp, data=np.array([0.1])),
    )
    assert not np.array_equal(run(fx.User(damp)).y[:, -1], pc.simulate(scene(), **START).y[:, -1])


def test_numbas_functions_are_taken_as_they_are():
    numba = pytest.importorskip("numba")
    types = numba.types
    doubles = types.CPointer(types.double)
    signature = types.void(types.double, types.int32, doubles, doubles, doubles, types.voidptr)

    @numba.cfunc(signature)
    def damped(t, n, q, qd, forces, data):
        for i in range(n):
            forces[i] -= 0.1 * qd[i]

    assert_damps(fx.CompiledUser(damped))


@pytest.mark.outside_build
def test_a_library_of_the_users_own_is_taken_as_its_page_says(tmp_path):
    page = (Path(__file__).parents[2] / "docs/effects/compiled_user.md").read_text()
    (code,) = re.findall(r"```cpp\n(.*?)```", page, re.DOTALL)
    (command,) = re.findall(r"^    (g\+\+ .*)$", page, re.MULTILINE)
    (tmp_path / "laws.cpp").write_text(code)
    subprocess.run(command.split(), cwd=tmp_path, check=True)
    effect = fx.CompiledUser(ctypes.CDLL(str(tmp_path / "laws.so")).damp)
    assert_damps(effect)
    _, of_python, _ = scene(fx.User(damp)).explain().costs
    _, of_library, _ = scene(effect).explain().costs
    assert of_library.nanoseconds < of_python.nanoseconds / 10


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_exception_in_a_ctypes_callback_is_lost_as_its_page_says():
    @FORCES
    def broken(t, n, q, qd, forces, data):
        raise RuntimeError

    undisturbed = run(fx.CompiledUser(broken), method="dop853")
    assert undisturbed.success
    assert np.array_equal(undisturbed.y, pc.simulate(scene(), **START, method="dop853").y)


def test_a_function_gets_time_angles_and_rates_as_fresh_arrays():
    seen = []

    def look(t, q, qd):
        seen.append((t, q.tolist(), qd.tolist()))
        q[:] = qd[:] = 99.0  # arrays of its own
        return np.zeros(2)

    assert np.array_equal(scene(fx.User(look)).accelerations(*AT), scene().accelerations(*AT))
    assert seen[-1] == AT


@pytest.mark.parametrize("forces", [[1, 2], (1.0, 2.0), np.array([1, 2]), np.float32([1, 2])])
def test_forces_may_be_any_numbers(forces):
    expected = scene(fx.User(lambda *_: np.array([1.0, 2.0]))).accelerations(*AT)
    assert np.array_equal(scene(fx.User(lambda *_: forces)).accelerations(*AT), expected)


@pytest.mark.parametrize(
    ("forces", "kind", "message"),
    [
        (None, TypeError, r"\(t, q, qd\) = None: must be real numbers"),
        ("ab", TypeError, r"\(t, q, qd\) = 'ab': must be real numbers"),
        (5.0, ValueError, r"\(t, q, qd\).*must be \(2,\), the generalised forces"),
        ([1, 2, 3], ValueError, r".*: shape \(3,\): must be \(2,\), the generalised"),
        (np.eye(2), ValueError, r".*: shape \(2, 2\): must be \(2,\)"),
    ],
)
def test_what_is_no_force_is_refused_by_the_functions_name(forces, kind, message):
    def answer(t, q, qd):
        return forces

    own = scene(fx.User(answer))
    for call in (lambda: own.accelerations(*AT), lambda: pc.simulate(own, **START)):
        with pytest.raises(kind, match=r"User: .*answer" + message):
            call()


class OutOfAirError(Exception):
    pass


def breaks_off(t, q, qd):
    if t > 1.0:
        raise OutOfAirError(t)
    return damp(t, q, qd)


@pytest.mark.parametrize("store", ["dense", "end"])
def test_an_exception_passes_through_with_the_run_so_far(store):
    with pytest.raises(OutOfAirError) as stop:
        run(fx.User(breaks_off), store=store)
    broken = stop.value.solution
    assert broken.status == "callback_error"
    assert broken.message.startswith("a function of the user's raised an exception")
    assert not broken.success
    assert 0.5 < broken.t[-1] <= 1.0
    if store == "dense":
        assert np.array_equal(broken.y, run(fx.User(damp)).y[:, : len(broken.t)])
    assert stop.traceback[-1].name == "breaks_off"
    with pytest.raises(OutOfAirError) as at_once:
        run(fx.User(breaks_off), store=store, t_span=(2, 3))
    broken = getattr(at_once.value, "solution", None)
    assert broken is None or len(broken.t) <= 1


@pytest.mark.parametrize("method", ["dopri5", "dop853", "rk4", "radau5"])
def test_a_run_that_its_function_broke_off_ends_at_its_last_step(method):
    """The run ends there even where the function fails at the end of a step that was kept."""
    options = {"step": 0.05} if method == "rk4" else {}
    turn = pc.events.LinkAngle(link=1, value=0.5, every_turn=True)
    solutions = 0
    for calls in range(1, 80):  # so many reach into the first steps of each method
        left = iter(range(calls))

        def fails(t, q, qd, left=left):
            if next(left, None) is None:
                raise OutOfAirError
            return damp(t, q, qd)

        with pytest.raises(OutOfAirError) as stop:
            run(fx.User(fails), method=method, events=[turn], **options)
        sol = getattr(stop.value, "solution", None)
        if sol is None:
            continue
        solutions += 1
        assert sol._run.t_reached == sol.t[-1]
        assert np.array_equal(sol._run.y_reached, sol.y[:, -1])
        assert all(event.t <= sol.t[-1] for event in sol.events[0])
    assert solutions > 9


def test_ctrl_c_in_a_function_interrupts():
    def stop(t, q, qd):
        if t > 0.5:
            raise KeyboardInterrupt
        return damp(t, q, qd)

    with pytest.raises(KeyboardInterrupt) as interrupt:
        run(fx.User(stop))
    assert interrupt.value.solution.status == "interrupted"
    assert interrupt.value.solution.message.startswith("interrupted: ")


@pytest.mark.parametrize(
    "limit",
    [{"max_steps": 2000}, {"max_steps": 10_000, "method": "dopri5"}, {"time_limit": 0.5}],
)
def test_a_run_that_creeps_at_a_jump_of_a_law_says_so(limit):
    sign = fx.User(lambda t, q, qd: -0.5 * np.sign(qd))
    scene = pc.Scene(links=[ROD, ROD], effects=[sign])
    sol = pc.simulate(scene, (0, 5), np.pi / 2, [0.1, 0.0], on_failure="ignore", **limit)
    assert sol.status == next(iter(limit))
    assert "a law of yours may jump, as sign(w) does" in sol.message
    assert "DryJointFriction" in sol.message


def test_a_function_lives_as_long_as_what_runs_under_it():
    def make():
        def own(t, q, qd):
            return damp(t, q, qd)

        return own, weakref.ref(own)

    function, alive = make()
    sol = run(fx.User(function))
    core = sol._run
    del function
    gc.collect()
    longer = sol.resume(3.0)
    del sol
    gc.collect()
    assert alive() is not None
    assert np.array_equal(longer.y, run(fx.User(damp)).resume(3.0).y)
    del longer
    gc.collect()
    assert alive() is not None  # the core's run could go on
    assert core.resume(2.5, None, 100, None, None).t_reached > 2
    del core
    gc.collect()
    assert alive() is None


def test_a_compiled_function_is_kept_alive_through_replace():
    kept = fx.CompiledUser(FORCES(lambda *_: None))
    alive = weakref.ref(kept._origins["address"])
    varied = kept.replace(data=5)
    del kept
    gc.collect()
    assert alive() is not None
    assert varied.data == 5


@pytest.mark.parametrize("effect", [fx.User(damp), fx.CompiledUser(compiled_damp)], ids=["py", "c"])
def test_what_cannot_be_kept_says_so_by_name(effect, tmp_path):
    own, name = scene(effect), type(effect).__name__
    sol = run(effect)
    for keep in (
        lambda: pickle.dumps(effect),
        lambda: pickle.dumps(own),
        lambda: pickle.dumps(sol),
        lambda: pc.Case(scene=own, **START).to_toml(),
    ):
        with pytest.raises(TypeError, match=rf"{name}.*function"):
            keep()
    kept_so = r"cannot be saved: a function .*sol\.to_pandas\(\) or numpy\.savez\("
    with pytest.raises(TypeError, match=rf"{name}.*{kept_so}"):
        sol.save(tmp_path / "run.npz")
    assert [*tmp_path.iterdir()] == []
    with pytest.raises(SyntaxError):
        eval(repr(effect))
    assert copy.deepcopy(own) == copy.copy(own) == own
    assert hash(own) == hash(scene(effect))


def test_tables_have_no_case_of_a_function():
    pytest.importorskip("pandas")
    assert "case" not in run(fx.User(damp)).to_pandas().attrs
    assert "case" in pc.simulate(scene(), **START).to_pandas().attrs


@pytest.mark.parametrize("how", [{}, {"method": "radau5", "step": 0.01}])
def test_a_function_that_gives_no_number_is_named_from_the_start_on(how) -> None:
    for begin in (0.0, 1.0):
        law = fx.User(lambda t, q, qd, begin=begin: np.full(2, np.nan if t >= begin else 0.0))
        scene = pc.Scene.textbook().replace(effects=[fx.Payload(mass=0.1), law])
        sol = pc.simulate(scene, (0, 5), 1.0, on_failure="ignore", **how)
        assert sol.status == "non_finite"
        assert sol.t_reached == pytest.approx(begin, abs=2 * how.get("step", 5e-7))
        assert "qd_1, by effect 2 (user)" in sol.message
