"""A store that is lost while it is written, in whole or in part, is told, and nothing is mixed."""

from __future__ import annotations

import os
import shutil
from contextlib import contextmanager, nullcontext
from time import monotonic, sleep

import numpy as np
import pendcore as pc
import pytest
from pendcore._ensemble import store as store_module
from pendcore._ensemble.distribution import Task, run_task
from test_store import ASKED, BOOK, STARTS, contents, pool_of

pytest.importorskip("zarr", exc_type=ImportError)


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
    pc.ensemble(
        BOOK, q0=STARTS + 0.1, store=path, chunk=7, time_limit=1e-9, on_failure="ignore", **ASKED
    )


def once(done, path):
    """Return a report that does something to a store when a quarter is run."""
    left = [done]

    def report(fraction):
        if fraction > 0.25 and left:
            left.pop()(path)

    return report


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("store") / "whole.zarr"
    pc.ensemble(BOOK, q0=STARTS, store=path, chunk=7, **ASKED)
    return path


@pytest.mark.unsanitized
@pytest.mark.parametrize("kind", [None, "threads", "processes"])
@pytest.mark.parametrize("lost", [move, move_its_parent, remove, empty])
def test_a_store_that_goes_while_it_is_written_is_told_and_made_by_nobody(tmp_path, lost, kind):
    path = tmp_path / "folder" / "a.zarr"
    path.parent.mkdir()
    how = {"store": path, "chunk": 7, "on_failure": "ignore"} | ASKED
    with pool_of(kind) as pool, pytest.raises(OSError, match=r"a\.zarr': is no longer there: it w"):
        pc.ensemble(BOOK, q0=STARTS, progress=once(lost, path), executor=pool, **how)
    if lost not in (remove, empty):  # which take their time, in which a worker may write on
        assert not path.exists()


def test_what_a_worker_raises_can_be_pickled_with_its_causes(tmp_path, stored):
    """Dask pickles the causes of an exception as well, and cannot read all of Zarr's."""
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    found = pc.load(path)
    shutil.rmtree(path / "q")
    block = (slice(0, 7),)
    with pytest.raises(OSError, match="is no longer there") as raised:
        run_task(Task(pc.__version__, found.members, found.request, 1, path, block))
    assert raised.value.__cause__ is raised.value.__context__ is None


@pytest.mark.unsanitized
@pytest.mark.parametrize("kind", [None, "processes"])
def test_a_store_that_is_put_back_loses_nothing(tmp_path, stored, kind):
    path = tmp_path / "a.zarr"
    how = {"store": path, "chunk": 7} | ASKED
    with pool_of(kind) as pool, pytest.raises(OSError, match="is no longer there") as told:
        pc.ensemble(BOOK, q0=STARTS, progress=once(move, path), executor=pool, **how)
    moved = tmp_path / "elsewhere.zarr"
    done = len([*moved.glob("status/c/*/*")])
    assert done >= 2
    moved.rename(path)
    assert told.value.ensemble.counts()["not_run"] < len(STARTS) * 9
    fractions = []
    pc.ensemble(BOOK, q0=STARTS, progress=fractions.append, **how)
    assert contents(path) == contents(stored)


@pytest.mark.unsanitized
def test_a_store_that_goes_while_a_cluster_writes_it_is_told(tmp_path, cluster):
    path = tmp_path / "a.zarr"
    how = {"store": path, "chunk": 7} | ASKED
    with pytest.raises(OSError, match="is no longer there"):
        pc.ensemble(BOOK, q0=STARTS, progress=once(move, path), executor=cluster, **how)
    until = monotonic() + 10  # nobody can wait for a worker of a cluster that takes its file back
    while path.exists() and monotonic() < until:
        sleep(0.01)
    assert not path.exists()


def test_nothing_is_written_into_a_store_that_took_the_place(tmp_path, stored):
    path = tmp_path / "a.zarr"
    with pytest.raises(OSError, match="is no longer there"):
        pc.ensemble(BOOK, q0=STARTS, store=path, chunk=7, progress=once(replace, path), **ASKED)
    with pytest.warns(pc.PendcoreWarning, match="54 of 54 members were not run"):
        assert pc.load(path).counts() == {"not_run": 54}


def test_what_was_written_beside_a_store_that_has_just_gone_is_taken_back(tmp_path, monkeypatch):
    path = tmp_path / "a.zarr"
    named = store_module.named

    @contextmanager
    def gone_before_the_write(place):
        with named(place):
            move(place)
            yield

    monkeypatch.setattr(store_module, "named", gone_before_the_write)
    with pytest.raises(OSError, match="is no longer there"):
        pc.ensemble(BOOK, q0=STARTS, store=path, chunk=7, **ASKED)
    assert [one.name for one in tmp_path.iterdir()] == ["elsewhere.zarr"]


def test_another_current_folder_changes_nothing(tmp_path, stored, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    to_other = once(lambda path: os.chdir(path), tmp_path / "other")
    pc.ensemble(BOOK, q0=STARTS, store="a.zarr", chunk=7, progress=to_other, **ASKED)
    assert contents(tmp_path / "a.zarr") == contents(stored)
    assert not [*(tmp_path / "other").iterdir()]


@pytest.mark.unsanitized
@pytest.mark.parametrize("kind", [None, "threads", "processes"])
@pytest.mark.parametrize("name", ["status", "t_reached", "over"])
def test_a_file_that_goes_while_a_store_is_written_is_told_and_made_anew(
    tmp_path, stored, name, kind
):
    path = tmp_path / "a.zarr"
    how = {"store": path, "chunk": 7} | ASKED

    def remove_one(path):
        min(one for one in path.glob(f"{name}/c/**/*") if one.is_file()).unlink()

    told = rf"files of 7 of 54 members are gone, the first of them is {name}/c/[0-9/]+: some"
    with pool_of(kind) as pool, pytest.raises(OSError, match=told):
        pc.ensemble(BOOK, q0=STARTS, progress=once(remove_one, path), executor=pool, **how)
    pc.ensemble(BOOK, q0=STARTS, **how)
    assert contents(path) == contents(stored)


@pytest.mark.parametrize("name", ["status", "q", "extremes"])
def test_a_file_that_is_missing_is_told_by_load_and_made_anew(tmp_path, stored, name):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    *_, first, last = sorted(one for one in path.glob(f"{name}/c/**/*") if one.is_file())
    first.unlink()
    last.unlink()
    told = f"of 54 members .* missing, the first of them is {first.relative_to(path)}: repeat"
    with pytest.warns(pc.PendcoreWarning, match=told):
        assert pc.load(path).ending == "interrupted"
    pc.ensemble(BOOK, q0=STARTS, store=path, **ASKED)
    assert contents(path) == contents(stored)


def test_an_array_of_a_store_that_was_moved_is_not_nan(tmp_path, stored):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    found = pc.load(path)
    move(path)
    with pytest.raises(OSError, match=r"a\.zarr': is no longer there"):
        found.q  # noqa: B018


def test_a_chunk_of_nothing_but_nan_is_written_as_well(tmp_path):
    """A missing file would else mean two things: no event in a whole block, and a lost block."""
    never = pc.reducers.FirstEvent(pc.events.LinkAngle(2, 1e6, every_turn=False))
    path = tmp_path / "a.zarr"
    found = pc.ensemble(BOOK, q0=STARTS, t_span=(0, 1), store=path, chunk=7, keep=never)
    assert np.isnan(found["first_event"]).all()
    assert np.isnan(pc.load(path)["first_event"]).all()  # and load warns of nothing


def block(path):
    (path / "extremes" / "c").rename(path / "c") if (path / "extremes" / "c").exists() else None
    (path / "extremes" / "c").touch()


def forbid(path):
    for folder in [path, *(one for one in path.rglob("*") if one.is_dir())]:
        folder.chmod(0o500)


@pytest.mark.parametrize("kind", [None, "threads"])
@pytest.mark.parametrize(
    "lost",
    [block, pytest.param(forbid, marks=pytest.mark.skipif(os.geteuid() == 0, reason="root may"))],
)
def test_a_store_that_cannot_be_written_any_more_is_told(tmp_path, lost, kind):
    path = tmp_path / "a.zarr"
    how = {"store": path, "chunk": 7} | ASKED
    with (
        pool_of(kind) if kind else nullcontext() as pool,
        pytest.raises(OSError, match=r"the same call goes on with it: '.*a\.zarr'") as told,
    ):
        pc.ensemble(BOOK, q0=STARTS, progress=once(lost, path), executor=pool, **how)
    assert 0 < told.value.ensemble.counts()["not_run"] < 54
