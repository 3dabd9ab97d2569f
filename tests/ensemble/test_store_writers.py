"""Nobody writes into a store after its run has ended, and nobody holds it any longer."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress

import pendcore as pc
import pytest
from test_store import ASKED, BOOK, STARTS, contents, stop_early

pytest.importorskip("zarr", exc_type=ImportError)


@pytest.mark.unsanitized
def test_a_store_that_was_interrupted_is_written_no_more(tmp_path):
    how = {"t_span": (0, 2000), "store": tmp_path / "a.zarr", "chunk": 2, "on_failure": "ignore"}
    with ProcessPoolExecutor(2) as pool:
        with pytest.raises(KeyboardInterrupt):
            pc.ensemble(BOOK, q0=STARTS, executor=pool, progress=stop_early, **how)
        left = contents(tmp_path / "a.zarr")
        time.sleep(1.0)
        assert contents(tmp_path / "a.zarr") == left


BY_PROCESSES = """
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
import pendcore as pc, sys
starts = pc.sampling.uniform(-2, 2, (6, 9, 2), seed=1)
with ProcessPoolExecutor(2, mp_context=get_context("fork")) as pool:
    pc.ensemble(
        pc.Scene.textbook(), starts, t_span=(0, 2000), store=sys.argv[1], chunk=2, executor=pool,
        check=False,
    )
"""


@pytest.mark.unsanitized
def test_workers_that_outlive_their_run_do_not_hold_its_store(tmp_path):
    pytest.importorskip("fcntl")
    path = tmp_path / "a.zarr"
    process = subprocess.Popen(
        [sys.executable, "-c", BY_PROCESSES, str(path)], start_new_session=True
    )
    until = time.monotonic() + 60
    while not [*path.glob("status/c/*")] and time.monotonic() < until:
        time.sleep(0.005)
    process.kill()
    process.wait()
    try:
        found = pc.ensemble(
            BOOK, q0=STARTS, t_span=(0, 2000), store=path, chunk=2, on_failure="ignore"
        )
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    assert "not_run" not in found.counts()


def test_a_folder_that_cannot_be_replaced_is_no_store(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for path in (".", tmp_path):
        with pytest.raises(OSError, match="is the current folder or a disk: name a folder in it"):
            pc.ensemble(BOOK, q0=STARTS, store=path, **ASKED)
