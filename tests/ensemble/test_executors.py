"""Ensembles on executors: processes, threads, and a cluster of Dask's that loses a worker."""

from __future__ import annotations

import os
import signal
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pendcore as pc
import pytest
from pendcore._ensemble.distribution import Task, run_task

pytestmark = pytest.mark.unsanitized  # processes and a cluster

BOOK = pc.Scene.textbook()
STARTS = pc.sampling.uniform(-2, 2, (40, 2), seed=1)


def plain(scene=BOOK, **asked):
    return pc.ensemble(scene, q0=STARTS, t_span=(0, 3), **asked)


@pytest.mark.parametrize("chunk", [1, 7, 1000])
@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_an_executor_changes_no_bit(kind, chunk):
    pool = ThreadPoolExecutor(2) if kind == "threads" else ProcessPoolExecutor(2)
    with pool:
        found = pc.ensemble(BOOK, q0=STARTS, t_span=(0, 3), executor=pool, chunk=chunk)
    assert np.array_equal(found.q, plain().q)
    assert found.counts() == {"finished": 40}
    assert found.statistics == plain().statistics


def test_effects_and_events_travel_to_processes():
    scene = BOOK.replace(effects=[pc.effects.JointStop(joint=2, range=(-1, 1), restitution=0.5)])
    asked = {"keep": pc.reducers.FirstEvent(pc.events.RateZero(link=1)), "method": "dop853"}
    with ProcessPoolExecutor(1) as pool:
        found = pc.ensemble(scene, q0=STARTS / 9, t_span=(0, 3), executor=pool, chunk=9, **asked)
    here = pc.ensemble(scene, q0=STARTS / 9, t_span=(0, 3), **asked)
    assert np.array_equal(found["first_event"], here["first_event"], equal_nan=True)
    assert np.array_equal(found.q, here.q)


def test_what_is_no_executor():
    with pytest.raises(TypeError, match=r"executor = 3: must be an executor of concurrent"):
        plain(executor=3)


def test_another_version_on_a_worker_is_told():
    found = plain()
    task = Task("0.0.1", found.members, found.request, 1, None, (slice(0, 40),))
    with pytest.raises(RuntimeError, match=r"a worker has pendcore .*, .* is run by 0\.0\.1"):
        run_task(task)


def test_a_worker_without_pendcore_is_told():
    class Elsewhere(Executor):
        def submit(self, function, *args):
            future = Future()
            future.set_exception(ModuleNotFoundError("No module named 'pendcore'", name="pendcore"))
            return future

    with pytest.raises(RuntimeError, match="a worker has no pendcore") as told:
        plain(executor=Elsewhere())
    assert told.value.ensemble.counts() == {"not_run": 40}


def test_processes_that_die_are_told():
    with ProcessPoolExecutor(1) as pool:
        pool.submit(os.getpid).result()
        pid = next(iter(pool._processes))
        threading.Timer(0.3, os.kill, (pid, signal.SIGKILL)).start()
        with pytest.raises(RuntimeError, match="the executor's workers died"):
            pc.ensemble(
                BOOK,
                q0=STARTS,
                t_span=(0, 1e6),
                max_steps=10**9,
                executor=pool,
                chunk=1,
                on_failure="ignore",
            )


def test_a_time_limit_ends_the_whole():
    with ThreadPoolExecutor(1) as pool:
        found = pc.ensemble(
            BOOK,
            q0=STARTS,
            t_span=(0, 3000),
            executor=pool,
            chunk=1,
            time_limit=0.05,
            on_failure="ignore",
        )
    assert found.ending == "time_limit"
    assert found.counts().get("not_run", 0) > 0


def kill_a_worker(client, path):
    """Kill one of the processes when the store has its first chunk."""
    pids = client.run(os.getpid)
    until = time.monotonic() + 60
    while not [*path.glob("status/c/*")] and time.monotonic() < until:
        time.sleep(0.01)
    os.kill(next(iter(pids.values())), signal.SIGKILL)


def test_a_cluster_changes_no_bit_and_makes_good_a_worker_that_dies(cluster, tmp_path):
    from test_store import contents

    here, there = tmp_path / "here.zarr", tmp_path / "there.zarr"
    asked = {"t_span": (0, 3000), "chunk": 2, "on_failure": "ignore"}
    pc.ensemble(BOOK, q0=STARTS, store=here, **asked)
    killer = threading.Thread(target=kill_a_worker, args=(cluster, there))
    killer.start()
    found = pc.ensemble(BOOK, q0=STARTS, store=there, executor=cluster, **asked)
    killer.join()
    assert "not_run" not in found.counts()
    assert contents(here) == contents(there)


def test_without_a_store_results_come_back(cluster):
    found = pc.ensemble(BOOK, q0=STARTS, t_span=(0, 3), executor=cluster, chunk=7)
    assert np.array_equal(found.q, plain().q)
