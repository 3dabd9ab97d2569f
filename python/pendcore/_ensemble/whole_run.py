"""Members run, wherever: in threads, by an executor, into a store."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pendcore._ensemble.blocks import blocks_of, usual_block
from pendcore._ensemble.distribution import run_blocks
from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.members import Members
from pendcore._ensemble.new_store import bytes_of, in_words
from pendcore._ensemble.request import Request
from pendcore._ensemble.run import run_members
from pendcore._ensemble.store import store_for
from pendcore._messages.arguments import require_known, time_limit_of, whole_number
from pendcore._messages.handed_over import hand_over, raise_with
from pendcore._messages.progress import reporting
from pendcore._messages.warning import PendcoreWarning, warn
from pendcore._run.run_error import REMEDY, require_on_failure

_OF_THE_WHOLE: dict[str, Any] = {
    **dict.fromkeys(("workers", "executor", "store", "chunk", "time_limit", "progress")),
    "on_failure": "warn",
}


def of_the_whole(owner: str, given: dict[str, Any], others: Iterable[str] = ()) -> dict[str, Any]:
    """Return all options of the whole; one that is unknown is refused."""
    require_known(owner, given, [*others, *_OF_THE_WHOLE])
    return _OF_THE_WHOLE | given


def run_ensemble(members: Members, request: Request, given: dict[str, Any]) -> Ensemble:
    """Run members; ``given`` has the options of the whole."""
    require_on_failure(given["on_failure"])
    request.check_reducers()
    workers = _at_least_1("workers", given["workers"], "threads")
    chunk = _at_least_1("chunk", given["chunk"], "members")
    limit = time_limit_of(given["time_limit"])
    executor, path = given["executor"], given["store"]
    if chunk and executor is None and path is None:
        raise TypeError("chunk: counts only with a store or an executor")
    what = f"running {members.count} members"
    if path is not None:
        what += f" into {path}, up to {in_words(bytes_of(members, request))}"
    with reporting(given["progress"], what, members.count, "members") as report:
        how = executor, workers, limit, report
        if path is not None:
            with store_for(Path(path), members, request, chunk) as store:
                found = run_blocks(members, request, store.blocks, store, *how)
        elif executor is not None:
            blocks = blocks_of(members.shape, chunk or usual_block(members, request))
            found = run_blocks(members, request, blocks, None, *how)
        else:
            found = run_members(members, request, workers, limit, report)
    result = Ensemble(members, request, found.arrays, found.ending, found.statistics)
    try:
        raise_with(found.error, ensemble=result)
    finally:
        del found  # the traceback of its error holds this frame: it would wait for the collector
    return _checked(result, given["on_failure"])


def _at_least_1(name: str, value: Any, unit: str) -> int:
    """Return a whole number from 1, or 0 for None."""
    if value is None:
        return 0
    count = whole_number(name, value)
    if count < 1:
        raise ValueError(f"{name} = {count}: must be 1 or more {unit}")
    return count


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
