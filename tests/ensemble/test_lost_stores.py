"""A store that is lost while it is written, in whole or in part, is told, and nothing is mixed."""

from __future__ import annotations

import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Event
from time import monotonic, sleep

import numpy as np
import pendcore as pc
import pytest
from pendcore._ensemble import store as store_module
from pendcore._ensemble.distribution import Task, run_task
from stored_ensembles import BOOK, STARTS, chunks, contents, make, pool_of

pytest.importorskip("zarr", exc_type=ImportError)
GONE = r"a\.zarr': is no longer there"


def move(path):
    path.rename(path.with_name("elsewhere.zarr"))


def move_its_parent(path):
    path.parent.rename(path.parent.with_name("elsewhere"))


def remove(path):
    shutil.rmtree(path, ignore_errors=True)


def empty(path):
    for one in path.iterdir():
        shutil.rmtree(one, ignore_errors=True) if one.is_dir() else one.unlink()


def replace(path):
    move(path)
    make(path, q0=STARTS + 0.1, time_limit=1e-9, on_failure="ignore")


def once(done, path):
    """Return a report that does something to a store when a quarter is run."""
    left = [done]

    def report(fraction):
        if fraction > 0.25 and left:
            left.pop()(path)

    return report


def interrupt(path):
    raise KeyboardInterrupt


def block(path):
    if (path / "extremes" / "c").exists():
        (path / "extremes" / "c").rename(path / "c")
    (path / "extremes" / "c").touch()


def unblock(path):
    (path / "extremes" / "c").unlink()
    if (path / "c").exists():
        (path / "c").rename(path / "extremes" / "c")


def folders(path):
    return [path, *(one for one in path.rglob("*") if one.is_dir())]


def forbid(path):
    for folder in folders(path):
        folder.chmod(0o500)


def allow(path):
    for folder in reversed(folders(path)):
        folder.chmod(0o700)


def remove_a_chunk(name):
    told = rf"files of [27] of 54 members are gone, the first of them is {name}/c/[0-9/]+: some"
    return lambda path: chunks(path, name)[0].unlink(), OSError, told, lambda path: None


GOES_ON = r"the same call goes on with it: '.*a\.zarr'"
root_may = pytest.mark.skipif(os.geteuid() == 0, reason="root may")
ENDS = {  # what happens, what is told, and how it is mended
    "interrupted": (interrupt, KeyboardInterrupt, None, lambda path: None),
    "moved": (move, OSError, GONE, lambda path: path.with_name("elsewhere.zarr").rename(path)),
    "no status": remove_a_chunk("status"),
    "no time": remove_a_chunk("t_reached"),
    "no event": remove_a_chunk("over"),
    "blocked": (block, OSError, GOES_ON, unblock),
    "forbidden": (forbid, OSError, GOES_ON, allow),
}


@pytest.mark.unsanitized
@pytest.mark.parametrize(
    "end", [pytest.param(end, marks=root_may if end == "forbidden" else ()) for end in ENDS]
)
def test_whatever_ends_a_run_the_same_call_goes_on_to_the_same_bytes(tmp_path, stored, end):
    happens, error, told, mend = ENDS[end]
    for kind in ("alone", "threads", "processes"):
        path = tmp_path / kind / "a.zarr"
        path.parent.mkdir()
        with pool_of(kind) as pool, pytest.raises(error, match=told) as raised:
            make(path, progress=once(happens, path), executor=pool)
        mend(path)
        assert len(chunks(path, "status")) >= 2  # what was done is not lost
        if "no" not in end.split():
            assert 0 < raised.value.ensemble.counts()["not_run"] < 54
        missing = "of 54 members were not run, or files of theirs are missing, the"
        with pytest.warns(pc.PendcoreWarning, match=missing):
            assert pc.load(path).ending == "interrupted"
        assert "not_run" not in make(path).counts()
        assert contents(path) == contents(stored)


@pytest.mark.few_cases
@pytest.mark.unsanitized
@pytest.mark.parametrize("kind", [None, "threads", "processes"])
@pytest.mark.parametrize("lost", [move, move_its_parent, remove, empty])
def test_a_store_that_goes_while_it_is_written_is_told_and_made_by_nobody(tmp_path, lost, kind):
    path = tmp_path / "folder" / "a.zarr"
    path.parent.mkdir()
    with pool_of(kind) as pool, pytest.raises(OSError, match=GONE + ": it w"):
        make(path, progress=once(lost, path), executor=pool)
    if lost not in (remove, empty):  # which take their time, in which a worker may write on
        assert not path.exists()


def test_nothing_is_written_into_a_store_that_took_the_place(tmp_path):
    path = tmp_path / "a.zarr"
    with pytest.raises(OSError, match=GONE):
        make(path, progress=once(replace, path))
    with pytest.warns(pc.PendcoreWarning, match="54 of 54 members were not run"):
        assert pc.load(path).counts() == {"not_run": 54}


@pytest.mark.unsanitized
def test_a_store_that_goes_while_a_cluster_writes_it_is_told(tmp_path, cluster):
    path = tmp_path / "a.zarr"
    with pytest.raises(OSError, match=GONE):
        make(path, progress=once(move, path), executor=cluster)
    until = monotonic() + 10  # nobody can wait for a worker of a cluster that takes its file back
    while path.exists() and monotonic() < until:
        sleep(0.01)
    assert not path.exists()


def test_what_was_written_beside_a_store_that_has_just_gone_is_taken_back(tmp_path, monkeypatch):
    named = store_module.named

    @contextmanager
    def gone_before_the_write(place):
        with named(place):
            move(place)
            yield

    monkeypatch.setattr(store_module, "named", gone_before_the_write)
    with pytest.raises(OSError, match=GONE):
        make(tmp_path / "a.zarr")
    assert [one.name for one in tmp_path.iterdir()] == ["elsewhere.zarr"]


def test_a_folder_that_a_worker_makes_anew_by_opening_a_store_is_taken_back(tmp_path, monkeypatch):
    storage = pytest.importorskip("zarr.storage")
    path, writable, named = (
        tmp_path / "a.zarr",
        storage.LocalStore.with_read_only,
        store_module.named,
    )
    writing = Event()

    @contextmanager
    def in_a_worker(place):
        with named(place):
            writing.set()
            yield

    def gone_while_it_is_opened(store, read_only=False):
        if writing.is_set() and path.exists():
            move(path)
        return writable(store, read_only)

    monkeypatch.setattr(store_module, "named", in_a_worker)
    monkeypatch.setattr(storage.LocalStore, "with_read_only", gone_while_it_is_opened)
    with ThreadPoolExecutor(1) as pool, pytest.raises(OSError, match=GONE):
        make(path, executor=pool)
    assert [one.name for one in tmp_path.iterdir()] == ["elsewhere.zarr"]


def test_another_current_folder_changes_nothing(tmp_path, stored, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    make("a.zarr", progress=once(os.chdir, tmp_path / "other"))
    assert contents(tmp_path / "a.zarr") == contents(stored)
    assert not [*(tmp_path / "other").iterdir()]


@pytest.mark.parametrize("name", ["status", "q", "extremes"])
def test_a_file_that_is_missing_is_told_by_load_and_made_anew(copied, stored, name):
    *_, first, last = chunks(copied, name)
    first.unlink()
    last.unlink()
    told = f"of 54 members .* missing, the first of them is {first.relative_to(copied)}: repeat"
    with pytest.warns(pc.PendcoreWarning, match=told):
        assert pc.load(copied).ending == "interrupted"
    make(copied)
    assert contents(copied) == contents(stored)


def test_what_a_worker_raises_can_be_pickled_with_its_causes(copied):
    """Dask pickles the causes of an exception as well, and cannot read all of Zarr's."""
    found = pc.load(copied)
    shutil.rmtree(copied / "q")
    with pytest.raises(OSError, match="is no longer there") as raised:
        run_task(Task(pc.__version__, found.members, found.request, 1, copied, (slice(0, 7),)))
    assert raised.value.__cause__ is raised.value.__context__ is None


def test_an_array_of_a_store_that_was_moved_is_not_nan(copied):
    found = pc.load(copied)
    move(copied)
    with pytest.raises(OSError, match=GONE):
        found.q  # noqa: B018


def test_a_chunk_of_nothing_but_nan_is_written_as_well(tmp_path):
    """A missing file would else mean two things: no event in a whole block, and a lost block."""
    never = pc.reducers.FirstEvent(pc.events.LinkAngle(2, 1e6, every_turn=False))
    how = {"t_span": (0, 1), "store": tmp_path / "a.zarr", "chunk": 7, "keep": never}
    found = pc.ensemble(BOOK, q0=STARTS, **how)
    assert np.isnan(found["first_event"]).all()
    assert np.isnan(pc.load(tmp_path / "a.zarr")["first_event"]).all()  # and load warns of nothing
