"""What several tests share: the multiple-precision trajectories."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from reference.trajectories import Trajectory, trajectory


@pytest.fixture(scope="session")
def reference_case() -> Callable[[str], Trajectory]:
    """Read a case of tests/data/trajectories.json by its name."""
    return trajectory
