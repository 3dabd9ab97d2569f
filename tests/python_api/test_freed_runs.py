"""A run that was broken off, or whose functions know it, is freed with the last name for it."""

from __future__ import annotations

import gc
import mmap
import signal
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import cycle, islice
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import FORCES
from pendcore import effects as fx

BOOK = pc.Scene.textbook()
LONG: dict[str, Any] = {"q0": [-1.0, -1.0], "t_span": (0, 1e9)}
HERE: dict[str, Any] = {"q0": [-1.0, -1.0], "t_span": (0, 20)}


class Boom(Exception):
    pass


class CtrlC(KeyboardInterrupt):
    """One that can be referred to weakly."""


def press(*_: object) -> None:
    raise CtrlC


def late(t: float, q: Any, qd: Any) -> Any:
    if t > 5:
        raise Boom
    return np.zeros(2)


def crossing(t: float, q: Any, qd: Any) -> float:
    return 1.0 + late(t, q, qd)[0]


def show(done: float) -> None:
    raise Boom


def by_ctrl_c(**options: Any) -> None:
    signal.setitimer(signal.ITIMER_REAL, 0.02)
    pc.simulate(BOOK, **LONG, **options)


def by_event(**options: Any) -> None:
    pc.simulate(BOOK, **HERE, events=[pc.events.Function(crossing)], **options)


def by_effect(**options: Any) -> None:
    pc.simulate(BOOK.replace(effects=[fx.User(late)]), **HERE, **options)


def by_progress(**options: Any) -> None:
    pc.simulate(BOOK, **LONG, progress=show, **options)


SOURCES = {"ctrl-c": by_ctrl_c, "event": by_event, "effect": by_effect, "progress": by_progress}
KEPT: dict[str, dict[str, Any]] = {
    "dense": {}, "steps": {"store": "steps"}, "times": {"t_eval": [0, 1, 2]},
    "dopri5": {"method": "dopri5"},
}  # fmt: skip


def resumed() -> None:
    pc.simulate(BOOK, q0=[-1.0, -1.0], t_span=(0, 1)).resume(1e9, progress=show)


def resumed_by_event() -> None:
    sol = pc.simulate(BOOK, q0=[-1.0, -1.0], t_span=(0, 1), events=[pc.events.Function(crossing)])
    sol.resume(20)


def for_an_error() -> None:
    pc.simulate(BOOK.replace(effects=[fx.User(late)]), **HERE, error=1e-6)


def of_a_case() -> None:
    options = {"events": [pc.events.Function(crossing)]}
    pc.Case(scene=BOOK, **HERE, options=options).simulate()


def of_its_error() -> None:
    pc.simulate(BOOK, q0=[0.5, 0.5], t_span=(0, 2000)).estimate_error(progress=show)


def members(**options: Any) -> None:
    pc.ensemble(BOOK, q0=np.zeros((64, 2)), t_span=(0, 2e3), progress=show, **options)


STORES = TemporaryDirectory()


def in_blocks() -> None:
    members(store=f"{mkdtemp(dir=STORES.name)}/store", chunk=8)


def by_threads() -> None:
    with ThreadPoolExecutor(2) as pool:
        members(executor=pool, chunk=8)


def members_that_fail() -> None:
    pc.ensemble(BOOK, q0=np.zeros((4, 2)), t_span=(0, 1), max_steps=2, on_failure="raise")


def run_that_fails() -> None:
    pc.simulate(BOOK, **HERE, max_steps=50, on_failure="raise")


OTHERS: dict[str, Callable[[], object]] = {
    "resume": resumed, "resume by event": resumed_by_event, "error=": for_an_error,
    "error= by progress": lambda: by_progress(error=1e-6), "case": of_a_case,
    "lyapunov": lambda: pc.lyapunov(BOOK, q0=[0.5, 0.5], t_span=(0, 1e6), progress=show),
    "sol.error": of_its_error, "ensemble": members, "ensemble in blocks": in_blocks,
    "ensemble by threads": by_threads, "ensemble that fails": members_that_fail,
    "run that fails": run_that_fails,
}  # fmt: skip


@contextmanager
def alarm_is_ctrl_c() -> Iterator[None]:
    before = signal.signal(signal.SIGALRM, press)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def without_collector() -> Iterator[None]:
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def arrays_of(stop: BaseException) -> list[Any]:
    """Return what an exception carries that takes memory."""
    carried: dict[str, Any] = vars(stop)
    found = [one._run for name, one in carried.items() if name == "solution"]
    found += [one.q for name, one in carried.items() if name == "ensemble"]
    found += [one.growth for name, one in carried.items() if name == "exponents"]
    found += [one.angle for name, one in carried.items() if name == "estimate"]
    assert found
    return found


def traces(call: Callable[[], object]) -> list[weakref.ref[Any]]:
    """Return weak references to an exception and to what it carries."""
    try:
        call()
    except (Boom, CtrlC, RuntimeError) as stop:
        return [weakref.ref(x) for x in (stop, *arrays_of(stop)) if type(x).__weakrefoffset__]
    raise AssertionError("nothing broke it off")


@pytest.mark.every_value("kept", "source")
@pytest.mark.parametrize("kept", KEPT)
@pytest.mark.parametrize("source", SOURCES)
def test_a_run_that_was_broken_off_is_freed_with_its_exception(source: str, kept: str) -> None:
    with alarm_is_ctrl_c(), without_collector():
        assert [x() for x in traces(lambda: SOURCES[source](**KEPT[kept]))] == [None] * 2


@pytest.mark.every_value("way")
@pytest.mark.parametrize("way", OTHERS)
def test_so_is_what_any_other_work_had_found(way: str) -> None:
    with without_collector():
        found = traces(OTHERS[way])
        assert [x() for x in found] == [None] * len(found)


def test_whoever_keeps_the_exception_keeps_the_run_and_can_go_on() -> None:
    with alarm_is_ctrl_c():
        try:
            by_ctrl_c()
        except CtrlC as stop:
            kept = stop
    gc.collect()
    sol = kept.solution  # type: ignore[attr-defined]
    assert sol.status == "interrupted"
    assert sol(0.5).shape == (4,)
    assert sol.resume(sol.t[-1] + 1.0).success


class Rig:
    """A user's object, whose methods are laws and events of what it holds itself."""

    def __init__(self, make: Callable[[Rig], Any]) -> None:
        self.made = make(self)

    def law(self, t: float, q: Any, qd: Any) -> Any:
        return -0.1 * qd

    def crossing(self, t: float, q: Any, qd: Any) -> float:
        return float(q[0])

    def compiled(self, t: float, n: int, q: Any, qd: Any, forces: Any, data: Any) -> None:
        forces[0] -= 0.1 * qd[0]

    def scene(self) -> pc.Scene:
        return BOOK.replace(effects=[fx.User(self.law)])

    def events(self) -> list[pc.events.Event]:
        return [pc.events.Function(self.crossing)]


def compiled_scene(rig: Rig) -> pc.Scene:
    return BOOK.replace(effects=[fx.CompiledUser(FORCES(rig.compiled), data=np.zeros(2))])


START: dict[str, Any] = {"q0": [0.3, 0.4], "t_span": (0, 1)}
MADE: dict[str, Callable[[Rig], Any]] = {
    "scene": Rig.scene,
    "scene of a compiled law": compiled_scene,
    "run with a law": lambda rig: pc.simulate(rig.scene(), **START),
    "run with an event": lambda rig: pc.simulate(BOOK, **START, events=rig.events()),
    "run with both": lambda rig: pc.simulate(rig.scene(), **START, events=rig.events()),
    "run resumed": lambda rig: pc.simulate(rig.scene(), **START, events=rig.events()).resume(2),
    "run for an error": lambda rig: pc.simulate(rig.scene(), **START, error=1e-6),
    "error": lambda rig: pc.simulate(rig.scene(), **START).estimate_error(),
    "case": lambda rig: pc.Case(scene=rig.scene(), **START, options={"events": rig.events()}),
    "ensemble": lambda rig: pc.ensemble(rig.scene(), q0=[[0.3, 0.4]] * 3, t_span=(0, 1)),
    "ensemble with events": lambda rig: pc.ensemble(
        BOOK, q0=[[0.3, 0.4]] * 3, t_span=(0, 1), keep=pc.reducers.FirstEvent(*rig.events())
    ),
    "exponents": lambda rig: pc.lyapunov(rig.scene(), q0=[0.3, 0.4], t_span=(0, 1)),
}  # fmt: skip


@pytest.mark.every_value("made")
@pytest.mark.parametrize("made", MADE)
def test_what_knows_its_own_functions_is_collected(made: str) -> None:
    gc.collect()
    rig = Rig(MADE[made])
    trace = weakref.ref(rig)
    del rig
    gc.collect()
    assert trace() is None


@pytest.mark.parametrize("made", ["scene", "run with a law", "run with both", "run resumed"])
def test_functions_live_as_long_as_the_core_can_call_them(made: str) -> None:
    """Python's own scene and solution may be gone."""
    rig = Rig(MADE[made])
    run = getattr(rig.made, "_run", None)
    scene = rig.made._compiled if run is None else None
    del rig
    gc.collect()
    if run is None:
        assert scene.acceleration_of_state(0.0, [0.3, 0.4], [1.0, 1.0]) is not None
    else:
        longer = run.resume(3.0, None, 10**6, None, None)
        assert longer.success
        assert longer.t_reached == 3.0


def resident() -> float:
    """Return the memory of this process, MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * mmap.PAGESIZE / 1e6


def calls() -> Iterator[Callable[[], None]]:
    """Yield ways to be broken off; those that take 50 ms are rare."""
    quick = [by_event, by_effect, resumed_by_event, of_a_case, run_that_fails, members_that_fail]
    slow = cycle([by_ctrl_c, by_progress, resumed])
    for i, one in enumerate(cycle(quick)):
        yield one if i % 100 else next(slow)


@pytest.mark.unsanitized
@pytest.mark.parametrize("count", [1000, pytest.param(100_000, marks=pytest.mark.whole)])
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
def test_any_number_of_runs_may_be_broken_off(count: int) -> None:
    with alarm_is_ctrl_c():
        for call in islice(calls(), 201):
            traces(call)
        before = resident()
        for call in islice(calls(), count):
            traces(call)
    assert resident() - before < 30
