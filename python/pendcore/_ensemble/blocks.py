"""How an ensemble is cut into blocks, which are run one after the other, or on many machines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import log2, prod

import numpy as np

from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.members import Index, Members
from pendcore._ensemble.request import Request
from pendcore._ensemble.run import run_members
from pendcore._messages.handed_over import raise_with

Block = tuple[slice, ...]

SECONDS = 2.0
"""The time that a block is to take on one processor. A scheduler wants tasks of 1 to 10 s."""
PILOTS = 8
"""The number of members whose work tells that of all."""
PILOT_STEPS = 20_000
"""The most steps of each."""
SECONDS_A_STEP = 1e-6
"""The rough time of a step of a link or two. A rough one is enough, and it must be the same on
every machine: the blocks of a store follow from it."""
MOST_BYTES = 2**26
"""The largest block of a result."""
MOST_BLOCKS = 2**18
"""A store has as many files, or several times as many."""


@dataclass(frozen=True, slots=True)
class Blocks:
    """Blocks of an ensemble, in the order of its members."""

    shape: Index
    """That of the ensemble."""
    block_shape: Index
    """That of a block; the last ones along an axis may be shorter."""

    @property
    def grid(self) -> Index:
        """The number of blocks along each axis."""
        return tuple(-(-a // b) for a, b in zip(self.shape, self.block_shape, strict=True))

    def __iter__(self) -> Iterator[Block]:
        for place in np.ndindex(self.grid):
            edges = zip(place, self.block_shape, self.shape, strict=True)
            yield tuple(slice(k * size, min((k + 1) * size, end)) for k, size, end in edges)


def require_few_blocks(blocks: Blocks) -> None:
    """Raise a ValueError unless a folder can hold the files of all blocks."""
    count = prod(blocks.grid)  # a damaged store may say more than len() can hold
    if count > MOST_BLOCKS:
        raise ValueError(
            f"block_shape = {list(blocks.block_shape)}: makes {count:,} blocks: must make at most "
            f"{MOST_BLOCKS:,}: give a larger chunk"
        )


def size_of(block: Block) -> int:
    """Return the number of members of a block."""
    return int(np.prod([one.stop - one.start for one in block], dtype=np.int64))


def blocks_of(shape: Index, count: int) -> Blocks:
    """Return blocks of at most ``count`` members, but at least 1, which are neighbours."""
    sizes: list[int] = []
    for length in reversed(shape):
        sizes.append(max(1, min(length, count)))
        count //= sizes[-1]
    return Blocks(shape, tuple(reversed(sizes)))


def usual_block(members: Members, request: Request, time_limit: float) -> int:
    """Return how many members a block should have, from the work of a few of them.

    The work is counted in steps, which are the same everywhere, and not in seconds. It is unknown,
    and the number 0, if these few take longer than the limit. What stops them is raised.
    """
    count = members.count
    if count == 0:
        return 1
    few = np.unique(np.linspace(0, count - 1, PILOTS).astype(np.intp))
    steps = min(request.options["max_steps"], PILOT_STEPS)
    pilot = request.with_options(max_steps=steps)
    found = run_members(members.selected(few), pilot, 0, time_limit, None)
    if found.error is not None:
        nothing = request.empty(members.shape, len(members.scene.links))
        not_run = Ensemble(members, request, nothing, found.ending)
        raise_with(found.take_error(), ensemble=not_run)
    if found.ending != "finished":
        return 0
    reached = np.abs(found.arrays["t_reached"] - request.t_span[0])
    share = np.nansum(reached) / (len(few) * abs(request.t_span[1] - request.t_span[0]) or 1.0)
    work = found.statistics["accepted"] / (len(few) * max(share, 1e-6))
    n = len(members.scene.links)
    seconds = max(work, 1.0) * SECONDS_A_STEP * n
    if request.sensitivity_names:
        seconds *= 8 + n**2 / 5  # as measured with Taylor series
    wanted = 2 ** round(log2(max(SECONDS / seconds, 1.0)))
    variables = request.variables(n)
    most = MOST_BYTES // max(sum(one.bytes_a_member for one in variables), 1)
    return max(1, min(int(wanted), most))
