"""An ensemble run block by block: here, or by the workers of an executor.

A result goes where the blocks go: into arrays in memory, or into a store. Workers write into a
store themselves, so that results never pass through this process.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from os import cpu_count
from pathlib import Path
from time import monotonic
from typing import Any

from pendcore import _core
from pendcore._ensemble.blocks import Block, Blocks, size_of
from pendcore._ensemble.members import Members
from pendcore._ensemble.request import Request
from pendcore._ensemble.run import Arrays, Outcome, run_members
from pendcore._ensemble.store import Store, write_block

Report = Callable[[float], object] | None

AHEAD = 4
"""The number of tasks that wait for each processor: enough that no worker has nothing to do."""
LOOK = 0.2
"""s between two looks at the clock."""
PATIENCE = 60.0
"""s that the end of the whole waits for blocks that workers have begun."""


@dataclass(frozen=True, slots=True)
class Task:
    """A block for a worker, with all that it needs to run it."""

    version: str
    members: Members
    request: Request
    workers: int
    store: Path | None
    block: Block


@dataclass(frozen=True, slots=True)
class Limits:
    """What bounds the whole."""

    workers: int
    time_limit: float
    report: Report


class InMemory:
    """Arrays in memory that take the results of blocks."""

    def __init__(self, members: Members, request: Request) -> None:
        variables = request.variables(len(members.scene.links))
        self.arrays = {one.name: one.empty(members.shape) for one in variables}

    def is_done(self, block: Block) -> bool:
        """Return whether a block was written: none is, to begin with."""
        return False

    def require_all(self) -> None:
        """Raise an error if results were lost: none are."""

    def write(self, block: Block, arrays: Arrays) -> None:
        """Take the results of a block."""
        for name, values in arrays.items():
            self.arrays[name][block] = values


def run_blocks(
    members: Members,
    request: Request,
    blocks: Blocks,
    target: InMemory | Store,
    limits: Limits,
    executor: Any = None,
) -> Outcome:
    """Run the blocks that are not done: by the workers of an executor, or else by threads."""
    if executor is not None:
        return _run_by(executor, members, request, blocks, target, limits)
    return _run_here(members, request, blocks, target, limits)


def _run_here(
    members: Members, request: Request, blocks: Blocks, target: InMemory | Store, limits: Limits
) -> Outcome:
    """Run one block after the other."""
    until, done, total = monotonic() + limits.time_limit, 0, max(members.count, 1)
    statistics: Counter[str] = Counter()
    try:
        for block in blocks:
            size = size_of(block)
            if not target.is_done(block):
                left = until - monotonic()
                if left <= 0:  # threads may run a whole block before they look at a limit of 0
                    return Outcome(target.arrays, "time_limit", dict(statistics), None)
                report = _part(limits.report, done / total, size / total)
                found = run_members(members.block(block), request, limits.workers, left, report)
                if found.ending != "finished" or found.error is not None:
                    try:
                        return found._replace(arrays=target.arrays, statistics=dict(statistics))
                    finally:
                        del found  # its exception may hold this frame, and wait for the collector
                target.write(block, found.arrays)
                statistics.update(found.statistics)
            done += size
            if limits.report is not None:
                limits.report(done / total)
        target.require_all()
    except BaseException as stop:  # Ctrl-C between blocks, an exception of progress, a full disk
        return Outcome(target.arrays, "interrupted", dict(statistics), stop)
    return Outcome(target.arrays, "finished", dict(statistics), None)


def _run_by(
    executor: Any,
    members: Members,
    request: Request,
    blocks: Blocks,
    target: InMemory | Store,
    limits: Limits,
) -> Outcome:
    """Run blocks side by side."""
    store = target.path.resolve() if isinstance(target, Store) else None
    left = (block for block in blocks if not target.is_done(block))
    tasks = (
        Task(_core.__version__, members.block(block), request, limits.workers or 1, store, block)
        for block in left
    )
    until, done, total = monotonic() + limits.time_limit, 0, max(members.count, 1)
    statistics: Counter[str] = Counter()
    pool, processors = _pool(executor)
    running: set[Future[Any]] = set()
    ending, error = "finished", None
    try:
        results = _results(pool, tasks, AHEAD * processors, running, lambda: monotonic() < until)
        for block, arrays, counted in results:
            if arrays is not None:
                target.write(block, arrays)
            elif isinstance(target, Store):
                target.require_there()
            statistics.update(counted)
            done += size_of(block)
            if limits.report is not None:
                limits.report(done / total)
        if monotonic() >= until and done < total:
            ending = "time_limit"
        else:
            target.require_all()
    except BaseException as stop:  # Ctrl-C, an exception of progress, or what a worker raised
        ending, error = "interrupted", _in_words(stop)
    finally:
        begun = [one for one in running if not one.cancel()]
        if len(begun) < len(running):
            _let_see_cancelled(pool)
        if store is not None:  # these still write into it, so it must be held until they have
            wait(begun, PATIENCE)
    try:
        return Outcome(target.arrays, ending, dict(statistics), error)
    finally:
        del error  # as above


def run_task(task: Task) -> tuple[Block, Arrays | None, dict[str, Any]]:
    """Run a block in the process of a worker."""
    if task.version != _core.__version__:
        raise RuntimeError(
            f"a worker has pendcore {_core.__version__}, and the ensemble is run by "
            f"{task.version}: install the same version everywhere"
        )
    found = run_members(task.members, task.request, task.workers, inf, None)
    if found.error is not None:
        try:
            raise found.error
        finally:
            del found  # as above
    if task.store is None:
        return task.block, found.arrays, found.statistics
    variables = task.request.variables(len(task.members.scene.links))
    try:
        write_block(task.store, variables, task.block, found.arrays)
    except Exception as error:
        # Dask's way to pickle exceptions takes their causes with them, and cannot read all of
        # Zarr's: the pool would count as broken.
        error.__cause__ = error.__context__ = None
        raise
    return task.block, None, found.statistics


def _results(
    pool: Executor,
    tasks: Iterable[Task],
    most: int,
    running: set[Future[Any]],
    goes_on: Callable[[], bool],
) -> Iterator[Any]:
    """Yield results as they come, with at most so many tasks on their way."""
    left = iter(tasks)
    while goes_on():
        while len(running) < most and (task := next(left, None)) is not None:
            running.add(pool.submit(run_task, task))
        if not running:
            return
        for one in wait(running, LOOK, FIRST_COMPLETED).done:
            running.discard(one)
            yield one.result()


def _let_see_cancelled(pool: Executor) -> None:
    """Let a pool of processes see which tasks were cancelled.

    In Python 3.11.2 and before, a pool that is shut down right after that waits for them for ever
    (github.com/python/cpython/issues/94440), unless the result of another task comes.
    """
    if isinstance(pool, ProcessPoolExecutor):
        with suppress(RuntimeError):  # it is broken, or shut down
            pool.submit(int)


def _pool(executor: Any) -> tuple[Executor, int]:
    """Return an executor of concurrent.futures, and the number of its processors."""
    if hasattr(executor, "get_executor") and hasattr(executor, "nthreads"):  # a client of Dask's
        threads = sum(executor.nthreads().values())
        return executor.get_executor(pure=False, retries=2), max(threads, 1)
    if not isinstance(executor, Executor):
        raise TypeError(
            f"executor = {executor!r}: must be an executor of concurrent.futures, or a Client of "
            "dask.distributed"
        )
    return executor, getattr(executor, "_max_workers", None) or cpu_count() or 1


def _in_words(error: BaseException) -> BaseException:
    """Return what a worker raised, in words where it does not speak for itself."""
    if isinstance(error, ModuleNotFoundError) and (error.name or "").startswith("pendcore"):
        return RuntimeError(
            f"a worker has no pendcore ({error}): install pendcore {_core.__version__} where the "
            "executor's workers run"
        )
    if type(error).__name__ in ("BrokenProcessPool", "KilledWorker"):
        return RuntimeError(
            f"the executor's workers died ({error}): they ran out of memory or were killed, or "
            f"have no pendcore {_core.__version__}; what was finished stays"
        )
    return error


def _part(report: Report, begin: float, share: float) -> Report:
    """Return a report for a part of the whole."""
    if report is None:
        return None
    return lambda fraction: report(begin + share * fraction)
