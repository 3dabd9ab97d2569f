"""Ensembles on executors: processes, threads, and a cluster of Dask's that loses a worker."""

from __future__ import annotations

import os
import signal
import threading
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, starts
from pendcore._ensemble.distribution import Task, run_task
from stored_ensembles import contents, wait_for_a_chunk

pytestmark = pytest.mark.unsanitized  # processes and a cluster

STARTS = starts(40, 2, 1, 2.0)
PLAIN = {"q0": STARTS, "t_span": (0, 3)}


@pytest.mark.few_cases
@pytest.mark.parametrize("chunk", [1, 7, 1000])
@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_an_executor_changes_nothing(kind, chunk):
    """Effects and events travel as well."""
    scene = BOOK.replace(effects=[pc.effects.JointStop(joint=2, range=(-1, 1), restitution=0.5)])
    asked = {"keep": pc.reducers.FirstEvent(pc.events.RateZero(link=1)), "method": "dop853"}
    for own, how in ((BOOK, PLAIN), (scene, PLAIN | asked | {"q0": STARTS / 9})):
        here = pc.ensemble(own, **how)
        with kind(2) as pool:
            there = pc.ensemble(own, **how, executor=pool, chunk=chunk)
        assert {*here.arrays} == {*there.arrays}
        for name, values in here.arrays.items():
            assert np.array_equal(there.arrays[name], values, equal_nan=True), name
        assert there.counts() == {"finished": 40}
        assert there.statistics == here.statistics


def test_another_version_on_a_worker_is_told():
    found = pc.ensemble(BOOK, **PLAIN)
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
        pc.ensemble(BOOK, **PLAIN, executor=Elsewhere())
    assert told.value.ensemble.counts() == {"not_run": 40}


def test_processes_that_die_are_told():
    how = {"t_span": (0, 1e6), "max_steps": 10**9, "chunk": 1, "on_failure": "ignore"}
    with ProcessPoolExecutor(1) as pool:
        pool.submit(os.getpid).result()
        pid = next(iter(pool._processes))
        threading.Timer(0.3, os.kill, (pid, signal.SIGKILL)).start()
        with pytest.raises(RuntimeError, match="the executor's workers died"):
            pc.ensemble(BOOK, q0=STARTS, executor=pool, **how)


def kill_a_worker(client, path):
    """Kill one of the processes when the store has its first chunk."""
    pids = client.run(os.getpid)
    wait_for_a_chunk(path)
    os.kill(next(iter(pids.values())), signal.SIGKILL)


def test_a_cluster_makes_good_a_worker_that_dies(cluster, tmp_path):
    here, there = tmp_path / "here.zarr", tmp_path / "there.zarr"
    asked = {"t_span": (0, 3000), "chunk": 2, "on_failure": "ignore"}
    pc.ensemble(BOOK, q0=STARTS, store=here, **asked)
    killer = threading.Thread(target=kill_a_worker, args=(cluster, there))
    killer.start()
    found = pc.ensemble(BOOK, q0=STARTS, store=there, executor=cluster, **asked)
    killer.join()
    assert "not_run" not in found.counts()
    assert contents(here) == contents(there)


def test_a_limit_that_passes_while_an_executor_works_ends_the_whole():
    how = {"chunk": 1, "time_limit": 0.05, "on_failure": "ignore"}
    with ThreadPoolExecutor(1) as pool:
        starts_of_many = [[0.1 * k, 0.2] for k in range(50)]
        found = pc.ensemble(BOOK, (0, 300), starts_of_many, executor=pool, **how)
    assert found.ending == "time_limit"
    assert found.counts()["not_run"] > 0
