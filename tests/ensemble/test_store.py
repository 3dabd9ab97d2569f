"""Stores on disk: the same bytes however they came about, and never a mixture."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest

pytest.importorskip("zarr", exc_type=ImportError)

BOOK = pc.Scene.textbook()
OVER = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True, terminal=True)
STARTS = pc.sampling.uniform(-2, 2, (6, 9, 2), seed=1)
ASKED = {
    "t_span": (0, 3),
    "vary": {"gravity": np.linspace(5, 10, 9)},
    "keep": {"over": pc.reducers.FirstEvent(OVER), "extremes": pc.reducers.Extremes()},
}


def contents(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def plain():
    return pc.ensemble(BOOK, q0=STARTS, **ASKED)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("store") / "plain.zarr"
    pc.ensemble(BOOK, q0=STARTS, store=path, chunk=7, **ASKED)
    return path


def assert_same(one, other):
    assert np.array_equal(one.codes, other.codes)
    for name in ("t", "q", "qd", "over", "extremes"):
        a, b = (found[name] if name[0] in "oe" else getattr(found, name) for found in (one, other))
        assert np.array_equal(a, b, equal_nan=True), name


@pytest.mark.parametrize("chunk", [1, 7, 1000, None])
def test_a_store_has_the_bits_of_memory(tmp_path, plain, chunk):
    found = pc.ensemble(BOOK, q0=STARTS, store=tmp_path / "a.zarr", chunk=chunk, **ASKED)
    assert_same(found, plain)
    assert found.statistics == plain.statistics


def test_load_reads_all_of_it(stored, plain):
    found = pc.load(stored)
    assert_same(found, plain)
    assert found.request == plain.request
    assert found.members.scene == BOOK
    assert isinstance(found.members.scene, pc.Scene)
    alone = found.member((3, 4))
    assert alone.scene.gravity == np.linspace(5, 10, 9)[4]
    assert np.array_equal(alone.q[-1], plain.q[3, 4])


def test_an_npz_file_keeps_all_of_it_as_well(tmp_path, plain):
    plain.save(tmp_path / "all.npz")
    found = pc.load(tmp_path / "all.npz")
    assert_same(found, plain)
    assert found.request == plain.request
    assert (found.statistics, found.ending) == (plain.statistics, "finished")
    times = pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 1), keep="times", t_eval=[0.5, 1.0])
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


def stop_early(fraction):
    if fraction > 0.1:
        raise KeyboardInterrupt


def pool_of(kind):
    pools = {"threads": ThreadPoolExecutor, "processes": ProcessPoolExecutor}
    return pools[kind](2) if kind else nullcontext()


@pytest.mark.unsanitized
@pytest.mark.parametrize("kind", [None, "threads", "processes"])
def test_an_interrupted_store_ends_as_the_same_bytes(tmp_path, stored, kind):
    path = tmp_path / "plain.zarr"
    how = {"store": path, "chunk": 7} | ASKED
    with pool_of(kind) as pool, pytest.raises(KeyboardInterrupt) as stop:
        pc.ensemble(BOOK, q0=STARTS, progress=stop_early, executor=pool, **how)
    done = stop.value.ensemble.counts()
    assert 0 < done.get("not_run", 0) < len(STARTS) * 9
    missing = f"{done['not_run']} of 54 members were not run, or files of theirs are missing, the"
    with pytest.warns(pc.PendcoreWarning, match=missing):
        assert pc.load(path).ending == "interrupted"
    found = pc.ensemble(BOOK, q0=STARTS, **how)
    assert "not_run" not in found.counts()
    assert contents(path) == contents(stored)


KILLED = """
import numpy as np, pendcore as pc, sys
starts = pc.sampling.uniform(-2, 2, (6, 9, 2), seed=1)
pc.ensemble(
    pc.Scene.textbook(), (0, 2000), starts, store=sys.argv[1], chunk=2, workers=1,
    on_failure="ignore",
)
"""


@pytest.mark.unsanitized
def test_what_kill_leaves_is_finished_to_the_same_bytes(tmp_path):
    whole, killed = tmp_path / "whole.zarr", tmp_path / "killed.zarr"
    pc.ensemble(BOOK, q0=STARTS, t_span=(0, 2000), store=whole, chunk=2, on_failure="ignore")
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(killed)])
    until = time.monotonic() + 60
    while not [*killed.glob("status/c/*")] and time.monotonic() < until:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    (killed / "q" / "c" / "left.partial").write_text("of a write that kill ended")
    found = pc.ensemble(BOOK, q0=STARTS, t_span=(0, 2000), store=killed, on_failure="ignore")
    assert "not_run" not in found.counts()
    assert contents(killed) == contents(whole)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"rtol": 1e-6}, "another scene, or other options or events"),
        ({"t_span": (0, 4)}, "another scene, or other options or events"),
        ({"keep": "end"}, "another scene, or other options or events"),
        ({"keep": {"other": pc.reducers.FirstEvent(OVER)}}, "other reducers"),
        ({"vary": None}, "other parameters that vary"),
        ({"vary": {"gravity": 9.0}}, "other starts, parameters or times"),
    ],
)
def test_results_are_never_mixed(stored, changed, told):
    before = contents(stored)
    with pytest.raises(ValueError, match=told):
        pc.ensemble(BOOK, q0=STARTS, store=stored, **(ASKED | changed))
    with pytest.raises(ValueError, match="another scene"):
        pc.ensemble(BOOK.replace(gravity=9.0), q0=STARTS, store=stored, **ASKED)
    with pytest.raises(ValueError, match="other starts"):
        pc.ensemble(BOOK, q0=STARTS + 1, store=stored, **ASKED)
    assert contents(stored) == before


def test_another_version_is_refused(stored, tmp_path):
    other = tmp_path / "other.zarr"
    shutil.copytree(stored, other)
    path = other / "zarr.json"
    text = path.read_text()
    path.write_text(text.replace(f'"pendcore": "{pc.__version__}"', '"pendcore": "0.0"'))
    with pytest.raises(ValueError, match=rf"pendcore 0\.0, not {pc.__version__}"):
        pc.ensemble(BOOK, q0=STARTS, store=other, **ASKED)


def test_what_cannot_be_a_store(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").touch()
    with pytest.raises(ValueError, match="is no store of an ensemble"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=tmp_path / "other")
    with pytest.raises(ValueError, match="is no store of an ensemble"):
        pc.load(tmp_path / "other")
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match=r"file': is a file: choose another name"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=tmp_path / "file")
    (tmp_path / "file").unlink()
    with pytest.raises(OSError, match=r"the folder .* does not exist"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=tmp_path / "none" / "a.zarr")
    own = BOOK.replace(effects=[pc.effects.User(lambda t, q, qd: -qd)])
    with pytest.raises(TypeError, match="cannot be saved"):
        pc.ensemble(own, q0=STARTS, t_span=(0, 1), store=tmp_path / "own.zarr")
    with pytest.raises(TypeError, match="chunk: counts only with"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), chunk=3)
    with pytest.raises(ValueError, match="chunk = 0: must be 1 or more members"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=tmp_path / "a.zarr", chunk=0)
    assert [path.name for path in tmp_path.iterdir()] == ["other"]


def test_a_disk_that_is_too_small_is_told_before_the_work(tmp_path, monkeypatch):
    free = shutil.disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: free)
    with pytest.raises(OSError, match=r"needs up to [\d.]+ kB, but 1 kB are free"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=tmp_path / "a.zarr")


@pytest.mark.unsanitized
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs limits of files")
def test_a_full_disk_loses_nothing_that_was_written(tmp_path):
    """A limit of the size of files stands for the disk."""
    path = tmp_path / "a.zarr"
    script = f"""
import resource, signal, numpy as np, pendcore as pc
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
starts = pc.sampling.uniform(-2, 2, (64, 2), seed=1)
how = dict(t_span=(0, 1), store={str(path)!r}, chunk=16)
def limit(fraction):
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
try:
    pc.ensemble(pc.Scene.textbook(), q0=starts, progress=limit, **(how | {{"t_span": (0, 1000)}}))
except OSError as error:
    print(error, error.ensemble.counts())
"""
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout
    assert "the same call goes on with it" in told
    assert "not_run" in told
    found = pc.ensemble(
        BOOK, q0=pc.sampling.uniform(-2, 2, (64, 2), seed=1), t_span=(0, 1000), store=path
    )
    assert found.counts() == {"finished": 64}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OSError, match=r"a\.zarr': the folder .* cannot be written"):
        pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=tmp_path / "a.zarr")


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


def test_a_store_has_one_writer_at_a_time(tmp_path, stored):
    pytest.importorskip("fcntl")
    how = {"store": tmp_path / "plain.zarr", "chunk": 7} | ASKED

    def write_too(fraction):
        pc.ensemble(BOOK, q0=STARTS, **how)

    with pytest.raises(OSError, match=r"plain.zarr': another run is writing it: wait until"):
        pc.ensemble(BOOK, q0=STARTS, progress=write_too, **how)
    pc.ensemble(BOOK, q0=STARTS, **how)
    assert contents(tmp_path / "plain.zarr") == contents(stored)


def test_arrays_of_a_store_are_as_those_in_memory(stored, plain):
    array = pc.load(stored).arrays["q"]
    assert (array.shape, array.dtype) == (plain.q.shape, plain.q.dtype)
    assert np.array_equal(np.asarray(array), plain.q)


def test_an_empty_folder_becomes_a_store(tmp_path, stored):
    pc.ensemble(BOOK, q0=STARTS, store=tmp_path, chunk=7, **ASKED)
    assert contents(tmp_path) == contents(stored)


def without_its_end(chunk):
    return chunk[:-5]


def with_one_other_bit(chunk):
    place = len(chunk) - 9  # in the numbers, before the checksum
    return chunk[:place] + bytes([chunk[place] ^ 1]) + chunk[place + 1 :]


@pytest.mark.parametrize("damaged", [without_its_end, with_one_other_bit])
@pytest.mark.parametrize("name", ["q", "status", "extremes"])
def test_a_chunk_that_is_damaged_is_named_and_can_be_made_anew(tmp_path, stored, name, damaged):
    path = tmp_path / "damaged.zarr"
    shutil.copytree(stored, path)
    chunk = max(path for path in path.glob(f"{name}/c/**/*") if path.is_file())
    chunk.write_bytes(damaged(chunk.read_bytes()))
    where = re.escape(chunk.relative_to(path).as_posix())
    read = {"q": lambda found: found.q, "status": lambda found: found.codes}
    found = pc.load(path)
    with pytest.raises(OSError, match=f"damaged.zarr': {where} cannot be read .*: remove ") as said:
        read.get(name, lambda found: found[name])(found)
    (remedy,) = re.findall(r"remove (\S+) from the store", str(said.value))
    (path / remedy).unlink()
    pc.ensemble(BOOK, q0=STARTS, store=path, **ASKED)
    assert contents(path) == contents(stored)


def test_starts_that_are_damaged_are_told(tmp_path, stored):
    path = tmp_path / "damaged.zarr"
    shutil.copytree(stored, path)
    chunk = path / "q0" / "c" / "0" / "0" / "0"
    chunk.write_bytes(with_one_other_bit(chunk.read_bytes()))
    with pytest.raises(OSError, match=r"damaged.zarr': its starts cannot be read"):
        pc.load(path)


def test_of_two_runs_that_make_one_store_the_later_is_refused(tmp_path, monkeypatch):
    made = Path.rename

    def be_late(building, path):
        made(building, path)
        (tmp_path / "late").mkdir()
        made(tmp_path / "late", path)

    monkeypatch.setattr(Path, "rename", be_late)
    with pytest.raises(OSError, match=r"one.zarr': another run is writing it"):
        pc.ensemble(BOOK, q0=STARTS, store=tmp_path / "one.zarr", **ASKED)


@pytest.mark.parametrize("chunk", [None, 1])
def test_a_store_of_one_member_without_axes(tmp_path, chunk):
    how = {"t_span": (0, 1), "vary": {"gravity": 5.0}}
    found = pc.ensemble(BOOK, q0=[0.5, 1.0], store=tmp_path / "one.zarr", chunk=chunk, **how)
    assert found.shape == ()
    assert np.array_equal(found.q, pc.ensemble(BOOK, q0=[0.5, 1.0], **how).q)
