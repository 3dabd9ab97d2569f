"""Workers that are watched: one that dies or hangs names its case, and another goes on after it."""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

HANGS_AFTER = 60.0
"""s without a sign of life: twelve time limits."""


class Worker:
    """A process that runs every stride-th case from `first` to `end`."""

    def __init__(self, command: list[str], first: int, end: int, stride: int) -> None:
        self.command = command
        self.next = first
        self.end = end
        self.stride = stride
        self.process: subprocess.Popen[bytes]
        self.errors: IO[bytes]
        self._start()

    def _start(self) -> None:
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115  (closed by _ended)
        numbers = [str(x) for x in (self.next, self.end, self.stride)]
        tests = Path(__file__).parents[1]
        paths = [str(tests), str(tests / "models"), os.environ.get("PYTHONPATH", "")]
        self.process = subprocess.Popen(
            [*self.command, *numbers],
            stdout=subprocess.PIPE,
            stderr=self.errors,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))},
        )
        self.heard = time.monotonic()
        self.rest = b""

    def hear(self) -> list[dict[str, Any]]:
        """Return what it has told; a death is told in its place."""
        assert self.process.stdout is not None
        data = os.read(self.process.stdout.fileno(), 1 << 16)
        self.heard = time.monotonic()
        if not data:
            return self._ended("crash")
        *lines, self.rest = (self.rest + data).split(b"\n")
        found = [json.loads(line) for line in lines]
        for told in found:
            if "begins" in told:
                self.next = told["begins"]
        done = [told for told in found if "case" in told]
        if done and done[-1]["case"] == self.next:
            self.next += self.stride
        return done

    def hang(self) -> list[dict[str, Any]]:
        """End a process that has been silent for too long."""
        self.process.kill()
        return self._ended("hang")

    def _ended(self, how: str) -> list[dict[str, Any]]:
        code = self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()
        self.errors.seek(0)
        tail = self.errors.read().decode(errors="replace").strip()[-2000:]
        self.errors.close()
        if self.next >= self.end and code == 0:
            return []
        case, self.next = self.next, self.next + self.stride
        if self.next < self.end:
            self._start()
        told = f"{how}: the worker ended with {code}: {tail}"
        return [{"case": case, "outcome": how, "breaches": [told], "seconds": 0.0}]

    @property
    def is_done(self) -> bool:
        return self.process.returncode is not None


def run(
    command: list[str], cases: range, workers: int, patience: float
) -> Iterator[dict[str, Any]]:
    """Yield what becomes of every case, in the order in which they end."""
    first, end = cases.start, cases.stop
    team = [Worker(command, first + k, end, workers) for k in range(min(workers, len(cases)))]
    try:
        while team:
            with selectors.DefaultSelector() as selector:
                for worker in team:
                    assert worker.process.stdout is not None
                    selector.register(worker.process.stdout, selectors.EVENT_READ, worker)
                ready = [key.data for key, _ in selector.select(timeout=1.0)]
            for worker in team:
                if worker in ready:
                    yield from worker.hear()
                elif time.monotonic() - worker.heard > patience:
                    yield from worker.hang()
            team = [worker for worker in team if not worker.is_done]
    finally:
        for worker in team:
            worker.process.kill()
            worker.process.wait()
