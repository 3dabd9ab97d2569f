"""What several tests of ensembles need."""

from __future__ import annotations

import pytest


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
