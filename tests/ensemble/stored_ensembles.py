"""An ensemble that is stored, and what can happen to its store."""

from __future__ import annotations

import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pendcore as pc

BOOK = pc.Scene.textbook()
OVER = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True, terminal=True)
STARTS = pc.sampling.uniform(-2, 2, (6, 9, 2), seed=1)
ASKED = {
    "t_span": (0, 3),
    "vary": {"gravity": np.linspace(5, 10, 9)},
    "keep": {"over": pc.reducers.FirstEvent(OVER), "extremes": pc.reducers.Extremes()},
}
TIMES = {"keep": "times", "t_eval": [0.5, 1.0], "t_span": (0, 1)}
LONG = {"t_span": (0, 2000), "chunk": 2, "on_failure": "ignore"}
"""A run that can be killed before its end."""
IN_A_PROCESS = """
import sys
from stored_ensembles import *
with pool_of(sys.argv[2]) as pool:
    pc.ensemble(BOOK, q0=STARTS, store=sys.argv[1], executor=pool, **LONG)
"""


def make(store, q0=STARTS, **more):
    """Make a store, or go on with it."""
    return pc.ensemble(BOOK, q0=q0, store=store, **(ASKED | {"chunk": 7} | more))


def contents(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file()
    }


def chunks(store, name):
    """Return the files of an array's chunks."""
    return sorted(path for path in store.glob(f"{name}/c/**/*") if path.is_file())


def pool_of(kind):
    pools = {"threads": ThreadPoolExecutor, "processes": ProcessPoolExecutor}
    return pools[kind](2) if kind in pools else nullcontext()


def stop_early(fraction):
    if fraction > 0.1:
        raise KeyboardInterrupt


def wait_for_a_chunk(store):
    until = time.monotonic() + 60
    while not [*store.glob("status/c/*")] and time.monotonic() < until:
        time.sleep(0.005)


def begun_in_a_process(store, kind=""):
    """Begin a long run in a process of its own; return it when the store has its first chunk."""
    command = [sys.executable, "-c", IN_A_PROCESS, str(store), kind]
    process = subprocess.Popen(command, cwd=Path(__file__).parent, start_new_session=True)
    wait_for_a_chunk(store)
    return process
