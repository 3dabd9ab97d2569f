"""An ensemble run block by block: here, or by the workers of an executor.

A result goes where the blocks go: into arrays in memory, or into a store. Workers write into a
store themselves, so that results never pass through this process.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import closing, suppress
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
from pendcore._messages.handed_over import raise_with
from pendcore._messages.progress import part_of

Report = Callable[[float], object]
Result = tuple[Block, Arrays | None, dict[str, Any]]
"""A block, its arrays unless they are in a store, and its statistics."""

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


def run_blocks(
    members: Members,
    request: Request,
    blocks: Blocks,
    store: Store | None,
    executor: Any,
    workers: int,
    until: float,
    report: Report,
) -> Outcome:
    """Run the blocks that are not done: side by side by an executor, or else one by one.

    A store takes their results, or else memory. At ``until``, a time of `monotonic`, they end.
    """
    n = len(members.scene.links)
    kept: Arrays = request.empty(members.shape, n) if store is None else store.arrays
    done, total = 0, members.count
    statistics: Counter[str] = Counter()
    ending, error = "finished", None

    def count_as_done(block: Block) -> None:
        nonlocal done
        done += size_of(block)
        report(done / total)

    def left() -> Iterator[Block]:
        for block in blocks:
            if store is not None and store.is_done(block):
                count_as_done(block)
            else:
                yield block

    def one_by_one() -> Generator[Result]:
        for block in left():
            seconds = until - monotonic()
            if seconds <= 0:  # threads may run a whole block before they look at a limit of 0
                return
            part = part_of(report, done / total, size_of(block) / total)
            found = run_members(members.block(block), request, workers, seconds, part)
            raise_with(found.take_error())
            if found.ending != "finished":
                return
            yield block, found.arrays, found.statistics

    if executor is None:
        results = one_by_one()
    else:
        place = None if store is None else store.place
        tasks = (
            Task(_core.__version__, members.block(block), request, workers or 1, place, block)
            for block in left()
        )
        results = _side_by_side(*_pool(executor), tasks, until, place is not None)
    try:
        with closing(results):
            for block, arrays, counted in results:
                if store is None:
                    for name, values in (arrays or {}).items():
                        kept[name][block] = values
                elif arrays is None:
                    store.require_there()
                else:
                    store.write(block, arrays)
                statistics.update(counted)
                count_as_done(block)
        if done < total:
            ending = "time_limit"
        elif store is not None:
            store.require_all()
    except BaseException as stop:  # Ctrl-C, an exception of progress or of a worker, a full disk
        ending, error = "interrupted", _in_words(stop)
    try:
        return Outcome(kept, ending, dict(statistics), error)
    finally:
        del error  # its traceback holds this frame, which would wait for the collector


def run_task(task: Task) -> Result:
    """Run a block in the process of a worker."""
    if task.version != _core.__version__:
        raise RuntimeError(
            f"a worker has pendcore {_core.__version__}, and the ensemble is run by "
            f"{task.version}: install the same version everywhere"
        )
    found = run_members(task.members, task.request, task.workers, inf, None)
    raise_with(found.take_error())
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


def _side_by_side(
    pool: Executor, processors: int, tasks: Iterator[Task], until: float, in_store: bool
) -> Generator[Result]:
    """Yield results as they come; when this ends, no worker begins another task."""
    running: set[Future[Any]] = set()
    try:
        while monotonic() < until:
            while len(running) < AHEAD * processors and (task := next(tasks, None)) is not None:
                running.add(pool.submit(run_task, task))
            if not running:
                return
            for one in wait(running, LOOK, FIRST_COMPLETED).done:
                running.discard(one)
                yield one.result()
    finally:
        begun = [one for one in running if not one.cancel()]
        if len(begun) < len(running):
            _let_see_cancelled(pool)
        if in_store:  # these still write into it, so it must be held until they have
            wait(begun, PATIENCE)


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
