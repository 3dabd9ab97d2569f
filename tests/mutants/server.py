"""Runs pytest in forks of a process that has imported what tests import, but not pendcore.

    python server.py      # each line of its input is an order, each of its output an exit code

A short run takes half the time so. An order names the site of the package, the files and the tests
in them (a file that is named itself runs whole), and the arguments of pytest.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

OFTEN_IMPORTED = ("gmpy2", "matplotlib.pyplot", "mpmath", "numpy", "sympy", "tqdm")
NOT_ENDED = -99
"""The exit code of a run that was not over in time."""
UNKNOWN = 0.3
"""How long a test takes of which that is not known, s."""


class Chosen:
    """Runs the quickest of the chosen tests first; whole files come last, in their order.

    They are not named to pytest: it would run each with all its parameters, not with the few of
    `make test`.
    """

    def __init__(self, tests: Sequence[str], seconds: dict[str, float]) -> None:
        self.tests = {test: place for place, test in enumerate(tests)}
        self.seconds = seconds

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = [item for item in items if self.wants(item.nodeid)]
        items.sort(key=self.rank)

    def rank(self, item: pytest.Item) -> tuple[int, float]:
        name = base(item.nodeid)
        of_file = 0 if name in self.tests else 1 + self.tests[name.partition("::")[0]]
        return of_file, self.seconds.get(name, UNKNOWN)

    def wants(self, name: str) -> bool:
        return base(name) in self.tests or name.partition("::")[0] in self.tests

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        before = self.seconds.get(base(report.nodeid), 0.0)
        self.seconds[base(report.nodeid)] = max(before, report.duration)


def base(name: str) -> str:
    """Return the name of a test without its parameters."""
    return name.partition("[")[0]


def run_in_a_fork(order: dict[str, Any]) -> int:
    """Run pytest as ordered; return its exit code, or NOT_ENDED."""
    child = os.fork()
    if child == 0:
        os.setsid()
        output = os.open(order["output"], os.O_CREAT | os.O_TRUNC | os.O_WRONLY)
        os.dup2(output, 1)
        os.dup2(output, 2)
        sys.path.insert(0, order["site"])
        os.environ.update(order["environment"], PYTHONPATH=order["site"])
        seconds = read(order["seconds"])
        code = int(pytest.main(order["arguments"], [Chosen(order["tests"], seconds)]))
        Path(order["seconds"]).write_text(json.dumps(seconds))
        sys.stdout.flush()
        os._exit(code)
    until = time.monotonic() + order["patience"]
    code = None
    while code is None and time.monotonic() < until:
        done, status = os.waitpid(child, os.WNOHANG)
        code = os.waitstatus_to_exitcode(status) if done else None
        time.sleep(0.02)
    with suppress(ProcessLookupError):  # what a test started, or a run that is not over
        os.killpg(child, signal.SIGKILL)
    if code is None:
        os.waitpid(child, 0)
    return NOT_ENDED if code is None else code


def read(path: str) -> dict[str, float]:
    """Return how long each test took, s; a run that was killed may have left half a file."""
    try:
        found: dict[str, float] = json.loads(Path(path).read_text())
    except (OSError, ValueError):
        return {}
    return found


if __name__ == "__main__":
    sys.path[:] = [place for place in sys.path if place != str(Path(__file__).parent)]
    for name in OFTEN_IMPORTED:
        import_module(name)
    for line in sys.stdin:
        print(run_in_a_fork(json.loads(line)), flush=True)
