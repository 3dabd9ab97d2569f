"""What several tests share: the multiple-precision trajectories, and a Ctrl-C that is heard."""

from __future__ import annotations

import signal
from collections.abc import Callable

import pytest
from hypothesis import settings
from reference.trajectories import Trajectory, trajectory

# A busy machine is no failure.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Among several processes what builds programs begins first, lest one end with it alone."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: item.get_closest_marker("outside_build") is None)


@pytest.fixture(scope="session")
def reference_case() -> Callable[[str], Trajectory]:
    """Read a case of tests/data/trajectories.json by its name."""
    return trajectory


@pytest.fixture(scope="session", autouse=True)
def _ctrl_c_is_heard() -> None:
    """Undo that a shell starts what it runs in the background with Ctrl-C ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
