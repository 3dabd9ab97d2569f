"""Members run, wherever: in threads, by an executor, into a store."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

from pendcore._ensemble.blocks import blocks_of, usual_block
from pendcore._ensemble.distribution import run_blocks
from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.members import Members
from pendcore._ensemble.new_store import bytes_of, in_words
from pendcore._ensemble.request import Request
from pendcore._ensemble.run import run_members
from pendcore._ensemble.store import store_for
from pendcore._messages.arguments import at_least, require_known, time_limit_of
from pendcore._messages.handed_over import hand_over, raise_with
from pendcore._messages.progress import Progress, reporting
from pendcore._messages.warning import PendcoreWarning, warn
from pendcore._run.run_error import REMEDY, require_on_failure
from pendcore.options import OnFailure


class Execution(NamedTuple):
    """How members are run: by whom, for how long, and where their results go.

    Its fields are the parameters of `ensemble` from ``workers`` on. None of them changes a bit of a
    member.
    """

    workers: int | None = None
    executor: Any = None
    store: str | os.PathLike[str] | None = None
    chunk: int | None = None
    time_limit: float | None = None
    on_failure: OnFailure = "warn"
    progress: Progress = None


def execution(owner: str, given: dict[str, Any], others: Iterable[str] = ()) -> Execution:
    """Return the execution with these fields; a name that is none of them is refused."""
    require_known(owner, given, [*others, *Execution._fields])
    return Execution(**given)


def run_ensemble(members: Members, request: Request, how: Execution) -> Ensemble:
    """Run members; arguments are checked before the first of them."""
    require_on_failure(how.on_failure)
    request.check_reducers(members.scene)
    workers = 0 if how.workers is None else at_least("workers", how.workers, 1)
    chunk = 0 if how.chunk is None else at_least("chunk", how.chunk, 1)
    limit = time_limit_of(how.time_limit)
    until = monotonic() + limit
    executor, path = how.executor, how.store
    if chunk and executor is None and path is None:
        raise TypeError("chunk: counts only with a store or an executor")
    what = f"running {members.count} members"
    if path is not None:
        what += f" into {path}, up to {in_words(bytes_of(members, request))}"
    with reporting(how.progress, what, members.count, "members") as report:
        by = executor, workers, until, report
        if path is not None:
            with store_for(Path(path), members, request, chunk, limit) as store:
                # Without a store the limit is up, and no block is run, however small.
                blocks = blocks_of(members.shape, 1) if store is None else store.blocks
                found = run_blocks(members, request, blocks, store, *by)
        elif executor is not None:
            blocks = blocks_of(members.shape, chunk or usual_block(members, request, limit))
            found = run_blocks(members, request, blocks, None, *by)
        else:
            found = run_members(members, request, workers, limit, report)
    result = Ensemble(members, request, found.arrays, found.ending, found.statistics)
    raise_with(found.take_error(), ensemble=result)
    return _checked(result, how.on_failure)


def _checked(found: Ensemble, on_failure: str) -> Ensemble:
    if on_failure == "ignore" or found.success.all():
        return found
    told = ", ".join(f"{count} {name}" for name, count in found.counts().items())
    place = tuple(found.failed[0].tolist())
    complaint = f"of {len(found)} members {told}; .failed lists those that failed, the first is "
    complaint += f"{place}: .message({place}) says why"
    try:
        if on_failure == "raise":
            raise RuntimeError(complaint)
        warn(f"{complaint}; {REMEDY}")
    except (RuntimeError, PendcoreWarning) as error:
        hand_over(error, ensemble=found)
        raise
    return found
