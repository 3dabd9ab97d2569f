"""A run that was broken off, or whose functions know it, is freed with the last name for it."""

from __future__ import annotations

import gc
import mmap
import signal
import weakref
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import cycle, islice
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp

import numpy as np
import pendcore as pc
import pytest
from compiled_functions import FORCES
from pendcore import effects as fx

BOOK = pc.Scene.textbook()
Q0 = {"q0": [-1.0, -1.0]}
LONG, HERE, SHORT = ({**Q0, "t_span": (0, t)} for t in (1e9, 20, 1))


@pytest.fixture(scope="module", autouse=True)
def _only_what_is_new_is_looked_through():
    """What was there before takes the collector a fifth of a second each time."""
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()


class Boom(Exception):
    pass


class CtrlC(KeyboardInterrupt):
    """One that can be referred to weakly."""


def press(*_):
    raise CtrlC


def late(t, q, qd):
    if t > 5:
        raise Boom
    return np.zeros(2)


def show(done):
    raise Boom


CROSSING = [pc.events.Function(lambda t, q, qd: 1.0 + late(t, q, qd)[0])]
RUBBED = BOOK.replace(effects=[fx.User(late)])
STORES = TemporaryDirectory()


def by_ctrl_c(**options):
    signal.setitimer(signal.ITIMER_REAL, 0.02)
    pc.simulate(BOOK, **LONG, **options)


def members(**options):
    pc.ensemble(BOOK, q0=np.zeros((64, 2)), t_span=(0, 2e3), progress=show, **options)


def by_threads():
    with ThreadPoolExecutor(2) as pool:
        members(executor=pool, chunk=8)


SOURCES = {
    "ctrl-c": by_ctrl_c,
    "event": lambda **options: pc.simulate(BOOK, **HERE, events=CROSSING, **options),
    "effect": lambda **options: pc.simulate(RUBBED, **HERE, **options),
    "progress": lambda **options: pc.simulate(BOOK, **LONG, progress=show, **options),
}
KEPT = {
    "dense": {}, "steps": {"store": "steps"}, "times": {"t_eval": [0, 1, 2]},
    "dopri5": {"method": "dopri5"},
}  # fmt: skip
OTHERS = {
    "resume": lambda: pc.simulate(BOOK, **SHORT).resume(1e9, progress=show),
    "resume by event": lambda: pc.simulate(BOOK, **SHORT, events=CROSSING).resume(20),
    "error=": lambda: pc.simulate(RUBBED, **HERE, error=1e-6),
    "error= by progress": lambda: pc.simulate(BOOK, **LONG, progress=show, error=1e-6),
    "case": lambda: pc.Case(scene=BOOK, **HERE, options={"events": CROSSING}).simulate(),
    "lyapunov": lambda: pc.lyapunov(BOOK, q0=[0.5, 0.5], t_span=(0, 1e6), progress=show),
    "sol.error": lambda: pc.simulate(BOOK, q0=0.5, t_span=(0, 2000)).estimate_error(progress=show),
    "ensemble": members,
    "ensemble in blocks": lambda: members(store=f"{mkdtemp(dir=STORES.name)}/store", chunk=8),
    "ensemble by threads": by_threads,
    "ensemble that fails": lambda: pc.ensemble(
        BOOK, q0=np.zeros((4, 2)), t_span=(0, 1), max_steps=2, on_failure="raise"
    ),
    "run that fails": lambda: pc.simulate(BOOK, **HERE, max_steps=50, on_failure="raise"),
}


WAYS = OTHERS | {
    f"{source}, {kept}": partial(SOURCES[source], **KEPT[kept])
    for source in SOURCES
    for kept in KEPT
}


@contextmanager
def alarm_is_ctrl_c():
    before = signal.signal(signal.SIGALRM, press)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def without_collector():
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


CARRIED = {"solution": "_run", "ensemble": "q", "exponents": "growth", "estimate": "angle"}
"""What an exception carries, and the part of each that takes memory."""


def traces(call):
    """Return weak references to an exception and to what it carries."""
    try:
        call()
    except (Boom, CtrlC, RuntimeError) as stop:
        found = [getattr(x, CARRIED[name]) for name, x in vars(stop).items() if name in CARRIED]
        assert found
        return [weakref.ref(x) for x in (stop, *found) if type(x).__weakrefoffset__]
    raise AssertionError("nothing broke it off")


@pytest.mark.parametrize("way", WAYS)
def test_what_was_broken_off_is_freed_with_its_exception(way):
    with alarm_is_ctrl_c(), without_collector():
        found = traces(WAYS[way])
        assert [x() for x in found] == [None] * len(found)


class Rig:
    """A user's object, whose methods are laws and events of what it holds itself."""

    def __init__(self, make):
        self.made = make(self)

    def law(self, t, q, qd):
        return -0.1 * qd

    def crossing(self, t, q, qd):
        return float(q[0])

    def compiled(self, t, n, q, qd, forces, data):
        forces[0] -= 0.1 * qd[0]

    def scene(self):
        return BOOK.replace(effects=[fx.User(self.law)])

    def compiled_scene(self):
        law = fx.CompiledUser(FORCES(self.compiled), data=np.zeros(2))
        return BOOK.replace(effects=[law])

    def events(self):
        return [pc.events.Function(self.crossing)]

    def members(self, scene, **how):
        return pc.ensemble(scene, q0=[[0.3, 0.4]] * 3, t_span=(0, 1), **how)


START = {"q0": [0.3, 0.4], "t_span": (0, 1)}
MADE = {
    "scene": Rig.scene,
    "scene of a compiled law": Rig.compiled_scene,
    "run with a law": lambda rig: pc.simulate(rig.scene(), **START),
    "run with an event": lambda rig: pc.simulate(BOOK, **START, events=rig.events()),
    "run with both": lambda rig: pc.simulate(rig.scene(), **START, events=rig.events()),
    "run resumed": lambda rig: pc.simulate(rig.scene(), **START, events=rig.events()).resume(2),
    "run for an error": lambda rig: pc.simulate(rig.scene(), **START, error=1e-6),
    "error": lambda rig: pc.simulate(rig.scene(), **START).estimate_error(),
    "case": lambda rig: pc.Case(scene=rig.scene(), **START, options={"events": rig.events()}),
    "ensemble": lambda rig: rig.members(rig.scene()),
    "ensemble with events": lambda rig: rig.members(
        BOOK, keep=pc.reducers.FirstEvent(*rig.events())
    ),
    "exponents": lambda rig: pc.lyapunov(rig.scene(), **START),
}


@pytest.mark.parametrize("made", MADE)
def test_what_knows_its_own_functions_is_collected(made):
    gc.collect()
    trace = weakref.ref(Rig(MADE[made]))
    gc.collect()
    assert trace() is None


def resident():
    """Return the memory of this process, MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * mmap.PAGESIZE / 1e6


QUICK = [
    "event, dense",
    "effect, dense",
    "resume by event",
    "case",
    "run that fails",
    "ensemble that fails",
]


@pytest.mark.few_cases
@pytest.mark.unsanitized
@pytest.mark.parametrize("count", [1000, pytest.param(100_000, marks=pytest.mark.whole)])
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
def test_any_number_of_runs_may_be_broken_off(count):
    slow = cycle(["ctrl-c, dense", "progress, dense", "resume"])
    names = (name if i % 100 else next(slow) for i, name in enumerate(cycle(QUICK)))
    with alarm_is_ctrl_c():
        for name in islice(names, 201):
            traces(WAYS[name])
        before = resident()
        for name in islice(names, count):
            traces(WAYS[name])
    assert resident() - before < 30


def test_functions_live_as_long_as_the_core_can_call_them():
    scene = Rig(MADE["scene"]).made._compiled
    run = Rig(MADE["run with both"]).made._run
    gc.collect()
    assert scene.acceleration_of_state(0.0, [0.3, 0.4], [1.0, 1.0]) is not None
    assert run.resume(3.0, None, 10**6, None, None).t_reached == 3.0
