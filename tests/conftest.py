"""What tests share: reduced sweeps, the methods, trajectories in many digits, a Ctrl-C heard."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Any

import pytest
import sweeps
from carried import is_refusal_of_series
from hypothesis import settings
from pendcore import _core
from reference.trajectories import Trajectory, trajectory
from sweeps import every, few, random_examples

VALUES = 4
"""Values of each parameter that a reduced sweep meets."""


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("sweeps")
    group.addoption("--full", action="store_true", help="run all cases of every test")
    group.addoption(
        "--values",
        type=int,
        default=VALUES,
        help="of each parameter, in tests marked few_cases or with --share",
    )
    group.addoption("--examples", type=int, help="of each random test")
    group.addoption("--share", type=int, default=1, help="run one test function of so many")


def pytest_configure(config: pytest.Config) -> None:
    sweeps.reduced = not config.getoption("full") and not any("::" in one for one in config.args)
    sweeps.asked_for = config.getoption("examples")
    # A busy machine is not a failure.
    settings.register_profile("untimed", deadline=None, max_examples=random_examples(100))
    settings.load_profile("untimed")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Reduce sweeps, unless one test is asked for by name, or all tests are.

    Tests that build programs begin first, so that with several processes none of these runs on
    alone at the end.
    """
    if sweeps.reduced:
        _reduce(config, items)
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: item.get_closest_marker("outside_build") is None)


def _reduce(config: pytest.Config, items: list[pytest.Item]) -> None:
    functions: dict[str, list[Case]] = {}
    numbers: dict[tuple[str, str, int], int] = {}
    for item in items:
        if item.get_closest_marker("whole") is None:
            functions.setdefault(item.nodeid.partition("[")[0], []).append(Case(item, numbers))
    values, share = config.getoption("values"), config.getoption("share")
    kept = set()
    for name in every(functions, share):
        keeps_all = share == 1 and not functions[name][0].takes_long
        cases = functions[name] if keeps_all else few(functions[name], values)
        kept |= {case.nodeid for case in cases}
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid not in kept])
    items[:] = [item for item in items if item.nodeid in kept]


class Case:
    """Describe a test as `few` needs it.

    `numbers` counts the values of each parameter as they are met; the `indices` of pytest 9.2 count
    cases.
    """

    def __init__(self, item: pytest.Item, numbers: dict[tuple[str, str, int], int]) -> None:
        self.nodeid = item.nodeid
        function, callspec = item.nodeid.partition("[")[0], getattr(item, "callspec", None)
        self.indices: dict[str, int] = {
            name: numbers.setdefault((function, name, id(value)), len(numbers))
            for name, value in (callspec.params if callspec else {}).items()
        }
        self.takes_long = item.get_closest_marker("few_cases") is not None
        marks = item.iter_markers("every_value")
        self.kept_whole = frozenset(name for mark in marks for name in mark.args)


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Any:
    """Skip, of tests that run with each method, scenes that Taylor series refuse."""
    try:
        return (yield)
    except ValueError as refusal:
        if is_refusal_of_series(refusal) and "taylor" in pyfuncitem.name:
            pytest.skip(str(refusal))
        raise


@pytest.fixture(scope="session")
def reference_case() -> Callable[[str], Trajectory]:
    """Read a case of tests/data/trajectories.json by its name."""
    return trajectory


@pytest.fixture(params=[m["name"] for m in _core.methods() if m["error_order"]])
def method(request: pytest.FixtureRequest) -> str:
    """Run a test once with each method that chooses its own steps."""
    return str(request.param)


@pytest.fixture
def fine(method: str) -> dict[str, Any]:
    """Return options of a run whose errors are those of rounding or next to it."""
    return {"method": method, "rtol": 1e-12, "atol": 1e-14}


@pytest.fixture(scope="session", autouse=True)
def _ctrl_c_is_heard() -> None:
    """Heed Ctrl-C, which a shell has ignored by the programs that it starts in the background."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
