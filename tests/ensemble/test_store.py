"""Stores on disk: the same bytes however they came about, and never a mixture."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from _thread import interrupt_main
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from threading import Timer

import numpy as np
import pendcore as pc
import pytest
from pendcore._ensemble.run import run_members
from stored_ensembles import (
    ASKED,
    BOOK,
    LONG,
    OVER,
    STARTS,
    TIMES,
    begun_in_a_process,
    chunks,
    contents,
    make,
    pool_of,
    stop_early,
)

pytest.importorskip("zarr", exc_type=ImportError)


def assert_same(one, other):
    assert {*one.arrays} == {*other.arrays}
    for name, values in other.arrays.items():
        assert (one.arrays[name].shape, one.arrays[name].dtype) == (values.shape, values.dtype)
        assert np.array_equal(np.asarray(one.arrays[name]), values, equal_nan=True), name
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one["over"], other["over"], equal_nan=True)


@pytest.mark.parametrize("chunk", [1, 7, 1000, None])
def test_a_store_has_the_bits_of_memory(tmp_path, plain, chunk):
    found = make(tmp_path / "a.zarr", chunk=chunk)
    assert_same(found, plain)
    assert found.statistics == plain.statistics
    one = {"q0": [0.5, 1.0], "t_span": (0, 1), "vary": {"gravity": 5.0}}  # without axes
    found = pc.ensemble(BOOK, store=tmp_path / "one.zarr", chunk=chunk, **one)
    assert found.shape == ()
    assert np.array_equal(found.q, pc.ensemble(BOOK, **one).q)


def test_a_store_and_an_npz_file_keep_all_of_it(stored, tmp_path, plain):
    plain.save(tmp_path / "all.npz")
    with pytest.raises(ValueError, match=r"^path = '.*all.zarr'.*store=\"NAME.zarr\"\)$"):
        plain.save(tmp_path / "all.zarr")
    for path in (stored, tmp_path / "all.npz"):
        found = pc.load(path)
        assert_same(found, plain)
        assert found.request == plain.request
        assert found.ending == "finished"
        assert found.members.scene == BOOK
        assert isinstance(found.members.scene, pc.Scene)
        alone = found.member((3, 4))
        assert alone.scene.gravity == np.linspace(5, 10, 9)[4]
        assert np.array_equal(alone.q[-1], plain.q[3, 4])
    assert found.statistics == plain.statistics
    times = pc.ensemble(BOOK, q0=[0.5, 1.0], **TIMES)
    times.save(tmp_path / "times.npz")
    again = pc.load(tmp_path / "times.npz")
    assert np.array_equal(again.q, times.q)
    assert np.array_equal(again.t, [0.5, 1.0])
    (tmp_path / "broken.npz").write_bytes((tmp_path / "all.npz").read_bytes()[:900])
    with pytest.raises(ValueError, match=r"broken.npz: is no"):
        pc.load(tmp_path / "broken.npz")


def test_xarray_reads_it_with_units_and_coordinates(stored, plain):
    xr = pytest.importorskip("xarray", exc_type=ImportError)
    data = xr.open_zarr(stored)
    assert np.array_equal(data["over"], plain["over"], equal_nan=True)
    assert data["over"].units == "s"
    assert data["q"].units == "rad"
    assert data["gravity"].dims == ("member_1",)
    assert data.coords["q0"].dims == ("member_0", "member_1", "link")
    assert list(data["component"].values) == ["q_1", "q_2", "qd_1", "qd_2"]
    meanings = data["status"].flag_meanings.split()
    assert meanings[int(data["status"][0, 0])] == plain.status[0, 0]
    assert data.attrs["pendcore"] == pc.__version__


# Stopped and begun again ------------------------------------------------------------------------


@pytest.mark.unsanitized
def test_what_kill_leaves_is_finished_to_the_same_bytes(tmp_path):
    whole, killed = tmp_path / "whole.zarr", tmp_path / "killed.zarr"
    pc.ensemble(BOOK, q0=STARTS, store=whole, **LONG)
    process = begun_in_a_process(killed)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    (killed / "q" / "c" / "left.partial").write_text("of a write that kill ended")
    found = pc.ensemble(BOOK, q0=STARTS, store=killed, t_span=(0, 2000), on_failure="ignore")
    assert "not_run" not in found.counts()
    assert contents(killed) == contents(whole)


def test_what_a_worker_left_when_it_died_is_gone_at_the_end(tmp_path):
    class WithOneThatDied(ThreadPoolExecutor):
        def submit(self, *task):
            (tmp_path / "a.zarr" / "q" / "left.partial").write_text("of a write that kill ended")
            return super().submit(*task)

    plain, there = tmp_path / "plain.zarr", tmp_path / "a.zarr"
    make(plain)
    with WithOneThatDied(1) as pool:
        make(there, executor=pool)
    assert contents(there) == contents(plain)


SLOW = {
    "scene": pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * 40),
    "q0": np.full((16, 40), 0.3),
    "t_span": (0, 50),
    "method": "dop853",
    "on_failure": "ignore",
}
"""Before its first chunk, the members that tell how large a chunk should be take a while."""


@pytest.mark.parametrize("by", ["store", "executor"])
def test_ctrl_c_before_the_first_chunk_ends_the_run(by, tmp_path, monkeypatch):
    def interrupted(*given):
        Timer(0.1, interrupt_main).start()
        return run_members(*given)

    monkeypatch.setattr("pendcore._ensemble.blocks.run_members", interrupted)
    path = tmp_path / "it.zarr"
    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt) as raised:
        pc.ensemble(**SLOW, **{"store": path} if by == "store" else {"executor": pool})
    assert raised.value.ensemble.ending == "interrupted"
    assert raised.value.ensemble.counts() == {"not_run": 16}
    assert not path.exists()


def test_a_time_limit_holds_before_the_first_chunk(tmp_path):
    found = pc.ensemble(**SLOW, store=tmp_path / "it.zarr", time_limit=1e-3)
    assert found.ending == "time_limit"
    assert found.counts() == {"not_run": 16}
    assert not (tmp_path / "it.zarr").exists()


def test_an_empty_folder_becomes_a_store(tmp_path, stored):
    make(tmp_path)
    assert contents(tmp_path) == contents(stored)


# Refused ----------------------------------------------------------------------------------------

ANOTHER = "another scene, or other options or events"
OTHERS = [
    ({"rtol": 1e-6}, ANOTHER),
    ({"t_span": (0, 4)}, rf"{ANOTHER} \(t_end = 3.0, and now t_end = 4.0\): results"),
    ({"keep": "end"}, ANOTHER),
    ({"keep": {"other": pc.reducers.FirstEvent(OVER)}}, "other reducers"),
    ({"vary": None}, "other parameters that vary"),
    ({"vary": {"gravity": 9.0}}, "other starts, parameters or times"),
    ({"scene": BOOK.replace(gravity=9.0)}, "another scene"),
    ({"q0": STARTS + 1}, "other starts"),
]


def test_results_are_never_mixed(stored, copied):
    before = contents(stored)
    for changed, told in OTHERS:
        how = {"scene": BOOK, "q0": STARTS} | ASKED | changed
        with pytest.raises(ValueError, match=told):
            pc.ensemble(store=stored, **how)
    assert contents(stored) == before
    text = (copied / "zarr.json").read_text()
    version = f'"pendcore": "{pc.__version__}"'
    (copied / "zarr.json").write_text(text.replace(version, '"pendcore": "0.0"'))
    with pytest.raises(ValueError, match=rf"pendcore 0\.0, not {pc.__version__}"):
        make(copied)


def test_what_cannot_be_a_store(tmp_path, monkeypatch):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").touch()
    (tmp_path / "file").touch()
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for name, error, told in (
        ("other", ValueError, "is no store of an ensemble"),
        ("file", OSError, r"file': is a file: choose another name"),
        ("none/a.zarr", OSError, r"the folder .* does not exist"),
        ("here", OSError, "is the current folder or a disk: name a folder in it"),
    ):
        with pytest.raises(error, match=told):
            make(tmp_path / name)
    with pytest.raises(OSError, match="is the current folder or a disk"):
        make(".")
    with pytest.raises(ValueError, match="is no store of an ensemble"):
        pc.load(tmp_path / "other")
    own = BOOK.replace(effects=[pc.effects.User(lambda t, q, qd: -qd)])
    with pytest.raises(TypeError, match="cannot be saved"):
        pc.ensemble(own, q0=STARTS, t_span=(0, 1), store=tmp_path / "own.zarr")
    with pytest.raises(ValueError, match="chunk = 0: must be >= 1"):
        make(tmp_path / "a.zarr", chunk=0)
    free = shutil.disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: free)
    with pytest.raises(OSError, match=r"needs up to [\d.]+ kB, but 1 kB are free"):
        make(tmp_path / "a.zarr")
    assert {path.name for path in tmp_path.iterdir()} == {"other", "file", "here"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OSError, match=r"a\.zarr': the folder .* cannot be written"):
        make(tmp_path / "a.zarr")


def test_a_store_has_one_writer_at_a_time(tmp_path, stored):
    pytest.importorskip("fcntl")
    path = tmp_path / "plain.zarr"
    with pytest.raises(OSError, match=r"plain.zarr': another run is writing it: wait until"):
        make(path, progress=lambda fraction: make(path))
    make(path)
    assert contents(path) == contents(stored)


def test_of_two_runs_that_make_one_store_the_later_is_refused(tmp_path, monkeypatch):
    made = Path.rename

    def be_late(building, path):
        made(building, path)
        (tmp_path / "late").mkdir()
        made(tmp_path / "late", path)

    monkeypatch.setattr(Path, "rename", be_late)
    with pytest.raises(OSError, match=r"one.zarr': another run is writing it"):
        make(tmp_path / "one.zarr")


# Full and damaged -------------------------------------------------------------------------------


@pytest.mark.unsanitized
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs limits of files")
def test_a_full_disk_loses_nothing_that_was_written(tmp_path):
    """A limit of the size of files stands for the disk."""
    path = tmp_path / "a.zarr"
    script = f"""
import resource, signal, numpy as np, pendcore as pc
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
starts = pc.sampling.uniform(-2, 2, (64, 2), seed=1)
how = dict(t_span=(0, 1000), store={str(path)!r}, chunk=16)
def limit(fraction):
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
try:
    pc.ensemble(pc.Scene.textbook(), q0=starts, progress=limit, **how)
except OSError as error:
    print(error, error.ensemble.counts())
"""
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout
    assert "the same call goes on with it" in told
    assert "not_run" in told
    q0 = pc.sampling.uniform(-2, 2, (64, 2), seed=1)
    found = pc.ensemble(BOOK, q0=q0, t_span=(0, 1000), store=path)
    assert found.counts() == {"finished": 64}


def test_members_that_run_four_times_as_long_go_in_chunks_of_a_quarter(tmp_path):
    starts = np.linspace(0.1, 0.2, 600)[:, np.newaxis] * [1, 1]
    found = {}
    for t_end in (0.0, 250.0, 1000.0):
        path = tmp_path / f"{t_end}.zarr"
        with suppress(KeyboardInterrupt):
            pc.ensemble(BOOK, (0, t_end), starts, store=path, progress=stop_early)
        told = json.loads((path / "zarr.json").read_text())
        (found[t_end],) = told["attributes"]["block_shape"]
    assert found[0.0] == 600
    assert found[250.0] == 4 * found[1000.0]


def test_progress_rises_to_1_within_blocks_and_from_one_to_the_next(tmp_path):
    fractions = []
    starts = pc.sampling.uniform(-2, 2, (6, 2), seed=1)
    how = {"t_span": (0, 20_000), "chunk": 2, "progress": fractions.append, "workers": 1}
    pc.ensemble(BOOK, q0=starts, store=tmp_path / "a.zarr", **how)
    assert fractions == sorted(fractions)
    assert {1 / 3, 1 / 2, 2 / 3} < {*fractions}  # one half is within the second of three blocks
    assert fractions[-1] == 1


@pytest.mark.unsanitized
def test_memory_is_that_of_the_result():
    """A million members of one start, which broadcast: 41 MB of results."""
    script = """
import resource, numpy as np, pendcore as pc
scene = pc.Scene.textbook()
pc.ensemble(scene, (0, 1e-3), [0.1, 0.1])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
found = pc.ensemble(
    scene, (0, 1e-3), np.broadcast_to([0.1, 0.1], (1_000_000, 2)), method="dopri5",
    rtol=1e-3, vary={"gravity": 9.0},
)
result = sum(values.nbytes for values in found.arrays.values())
print(result, 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before))
"""
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout
    result, used = map(int, told.split())
    assert result == 41_000_000
    assert used < result + 20_000_000


def without_its_end(chunk):
    return chunk[:-5]


def with_one_other_bit(chunk):
    place = len(chunk) - 9  # in the numbers, before the checksum
    return chunk[:place] + bytes([chunk[place] ^ 1]) + chunk[place + 1 :]


@pytest.mark.few_cases
@pytest.mark.parametrize("damaged", [without_its_end, with_one_other_bit])
@pytest.mark.parametrize("name", ["q", "status", "extremes"])
def test_a_chunk_that_is_damaged_is_named_and_can_be_made_anew(copied, stored, name, damaged):
    chunk = chunks(copied, name)[-1]
    chunk.write_bytes(damaged(chunk.read_bytes()))
    where = re.escape(chunk.relative_to(copied).as_posix())
    read = {"q": lambda found: found.q, "status": lambda found: found.codes}
    found = pc.load(copied)
    with pytest.raises(OSError, match=f"a.zarr': {where} cannot be read .*: remove ") as said:
        read.get(name, lambda found: found[name])(found)
    (remedy,) = re.findall(r"remove (\S+) from the store", str(said.value))
    (copied / remedy).unlink()
    make(copied)
    assert contents(copied) == contents(stored)


def test_starts_that_are_damaged_are_told(copied):
    (chunk,) = chunks(copied, "q0")
    chunk.write_bytes(with_one_other_bit(chunk.read_bytes()))
    with pytest.raises(OSError, match=r"a.zarr': its starts cannot be read"):
        pc.load(copied)


# Nobody writes into a store after its run has ended ---------------------------------------------


@pytest.mark.unsanitized
def test_a_store_that_was_interrupted_is_written_no_more(tmp_path):
    path = tmp_path / "a.zarr"
    with pool_of("processes") as pool:
        with pytest.raises(KeyboardInterrupt):
            pc.ensemble(BOOK, q0=STARTS, store=path, executor=pool, progress=stop_early, **LONG)
        left = contents(path)
        time.sleep(1.0)
        assert contents(path) == left


@pytest.mark.unsanitized
def test_workers_that_outlive_their_run_do_not_hold_its_store(tmp_path):
    pytest.importorskip("fcntl")
    process = begun_in_a_process(tmp_path / "a.zarr", "processes")
    process.kill()
    process.wait()
    try:
        found = pc.ensemble(BOOK, q0=STARTS, store=tmp_path / "a.zarr", **LONG)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    assert "not_run" not in found.counts()
