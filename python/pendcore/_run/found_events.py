"""What the core found of the events that it looked for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Self, SupportsIndex, overload

import numpy as np
import numpy.typing as npt

from pendcore._messages.arguments import Floats


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Found:
    """An event that was found.

    Attributes
    ----------
    t : float
        s.
    y : ndarray, (2n,)
        The state: q_1..q_n (rad), qd_1..qd_n (rad/s); where it jumps, that after the jump.
    direction : int
        1: the function rose through zero; -1: it fell; 0: it touched zero and turned back.
    y_before, y_after : ndarray, (2n,), or None
        The states on both sides where the state jumps there.

    Examples
    --------
    >>> bottom = pc.events.LinkAngle(1, np.pi / 2)
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[bottom])
    >>> first = sol.events[0][0]
    >>> f"t = {first.t:.3f} s, q_1 = {first.q[0]:.4f} rad, {first.direction}"
    't = 0.653 s, q_1 = 1.5708 rad, 1'
    """

    t: float
    y: Floats
    direction: int
    y_before: Floats | None = None

    @property
    def q(self) -> Floats:
        """Absolute angles, rad, (n,)."""
        return self.y[: len(self.y) // 2]

    @property
    def qd(self) -> Floats:
        """Angular rates, rad/s, (n,)."""
        return self.y[len(self.y) // 2 :]

    @property
    def y_after(self) -> Floats | None:
        """The state after a jump, (2n,), or None."""
        return None if self.y_before is None else self.y

    def __repr__(self) -> str:
        jump = ", the state jumps" if self.y_before is not None else ""
        words = {1: "rising", -1: "falling", 0: "touching"}
        return f"<Found: t = {self.t!r} s, {words[self.direction]}{jump}>"


class FoundEvents(list[Found]):
    """The times at which one event happened, in the order of the run: a list with arrays.

    Attributes
    ----------
    t : ndarray, (k,)
        s.
    y : ndarray, (k, 2n)
        The states: q_1..q_n (rad), qd_1..qd_n (rad/s); where they jump, those after the jump.
    q, qd : ndarray, (k, n)
        Angles, rad, and rates, rad/s.
    direction : ndarray, (k,), int
        1: the function rose through zero; -1: it fell; 0: it touched zero and turned back.

    Examples
    --------
    >>> bottom = pc.events.LinkAngle(1, np.pi / 2)
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[bottom])
    >>> found = sol.events[0]
    >>> len(found), found.direction, found.qd.shape
    (4, array([ 1, -1,  1, -1]), (4, 2))
    """

    def __init__(self, links: int, found: Iterable[Found] = ()) -> None:
        super().__init__(found)
        self._links = links

    @overload
    def __getitem__(self, place: SupportsIndex) -> Found: ...
    @overload
    def __getitem__(self, place: slice) -> Self: ...
    def __getitem__(self, place: SupportsIndex | slice) -> Found | Self:
        if isinstance(place, slice):
            return type(self)(self._links, super().__getitem__(place))
        return super().__getitem__(place)

    @property
    def t(self) -> Floats:
        return np.array([one.t for one in self], dtype=np.float64)

    @property
    def y(self) -> Floats:
        return np.array([one.y for one in self], dtype=np.float64).reshape(-1, 2 * self._links)

    @property
    def q(self) -> Floats:
        return self.y[:, : self._links]

    @property
    def qd(self) -> Floats:
        return self.y[:, self._links :]

    @property
    def direction(self) -> npt.NDArray[np.int_]:
        return np.array([one.direction for one in self], dtype=np.int_)


def found_events(count: int, links: int, found: Iterable[tuple[Any, ...]]) -> list[FoundEvents]:
    """Return what the core found of each of so many events."""
    lists = [FoundEvents(links) for _ in range(count)]
    for event, t, direction, y, y_before in found:
        lists[event].append(Found(t, y, direction, y_before))
    return lists


Found.__module__ = FoundEvents.__module__ = "pendcore.events"  # where a user finds them
