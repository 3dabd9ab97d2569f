"""What several tests of ensembles need."""

from __future__ import annotations

import shutil

import pendcore as pc
import pytest
from stored_ensembles import ASKED, BOOK, STARTS, TIMES, make


@pytest.fixture(scope="module")
def cluster():
    """Two processes of Dask's on this machine."""
    distributed = pytest.importorskip("distributed", exc_type=ImportError)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="session")
def plain():
    return pc.ensemble(BOOK, q0=STARTS, **ASKED)


@pytest.fixture(scope="session")
def stored(tmp_path_factory):
    """A whole store, which no test may change."""
    path = tmp_path_factory.mktemp("store") / "whole.zarr"
    make(path)
    return path


@pytest.fixture(scope="session")
def timed(tmp_path_factory):
    """The same with states at times."""
    path = tmp_path_factory.mktemp("store") / "times.zarr"
    make(path, **TIMES)
    return path


@pytest.fixture
def copied(tmp_path, stored):
    """A store to be damaged."""
    shutil.copytree(stored, tmp_path / "a.zarr")
    return tmp_path / "a.zarr"
