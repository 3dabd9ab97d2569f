"""Processes that are watched: one that dies or hangs names its case; another goes on after it."""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import TypeVar

from fuzz.verdict import Verdict

HANGS_AFTER = 60.0
"""s without an answer: twelve time limits."""
FORKS = multiprocessing.get_context("forkserver")
FORKS.set_forkserver_preload(["fuzz.verdict"])  # so that a process is there at once

Case = TypeVar("Case")
Judge = Callable[[Case], Verdict]


def work(judge: Judge[Case], pipe: Connection, errors: str) -> None:
    """Judge the cases that come through a pipe; what the process says before it dies is kept."""
    with Path(errors).open("wb") as file:
        os.dup2(file.fileno(), 2)
    faulthandler.enable()
    pipe.send("ready")
    while True:
        pipe.send(judge(pipe.recv()))


class Worker:
    """A process that judges one case after the other."""

    def __init__(self, judge: Judge[Case]) -> None:
        self.folder = TemporaryDirectory()
        self.errors = Path(self.folder.name, "errors")
        self.pipe, theirs = FORKS.Pipe()
        self.process = FORKS.Process(target=work, args=(judge, theirs, str(self.errors)))
        self.process.start()
        theirs.close()
        self.pipe.recv()

    def judged(self, case: Case, patience: float) -> Verdict:
        """Return the verdict; after a crash or a hang the process is no more."""
        self.pipe.send(case)
        how = "hang"
        if self.pipe.poll(patience):
            try:
                found: Verdict = self.pipe.recv()
            except EOFError:
                how = "crash"
            else:
                return found
        tail = self.end()
        return Verdict(how, [f"{how}: the worker ended with {self.process.exitcode}: {tail}"])

    def end(self) -> str:
        """End the process, and return the last that it said of errors."""
        self.process.kill()
        self.process.join()
        self.pipe.close()
        tail = self.errors.read_bytes().decode(errors="replace").strip()[-2000:]
        self.folder.cleanup()
        return tail


def run(
    judge: Judge[Case], cases: Iterable[Case], workers: int = 1, patience: float = HANGS_AFTER
) -> Iterator[Verdict]:
    """Yield what becomes of every case, in their order."""
    free: SimpleQueue[Worker] = SimpleQueue()

    def judged(case: Case) -> Verdict:
        worker = free.get()
        found = worker.judged(case, patience)
        free.put(worker if worker.process.is_alive() else Worker(judge))
        return found

    for _ in range(workers):
        free.put(Worker(judge))
    try:
        with ThreadPoolExecutor(workers) as threads:
            yield from threads.map(judged, cases)
    finally:
        while not free.empty():
            free.get().end()
