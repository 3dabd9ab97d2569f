"""Many runs of one scene: what they found."""

from __future__ import annotations

import os
from collections.abc import Iterable
from operator import index as whole
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore.api.simulate import simulate
from pendcore.api.solution import Solution
from pendcore.ensemble.archive import save
from pendcore.ensemble.blocks import blocks_of, usual_block
from pendcore.ensemble.distribution import InMemory, Limits, run_blocks
from pendcore.ensemble.export import to_xarray
from pendcore.ensemble.figure import plot
from pendcore.ensemble.members import Members
from pendcore.ensemble.new_store import bytes_of, in_words
from pendcore.ensemble.request import NOT_RUN, Request
from pendcore.ensemble.result import EnsembleResult
from pendcore.ensemble.run import run_members
from pendcore.ensemble.store import store_for
from pendcore.ensemble.trust import resolved, second
from pendcore.messages.arguments import (
    did_you_mean,
    time_limit_of,
    whole_number,
)
from pendcore.messages.progress import Progress, callback, close
from pendcore.messages.warning import PendcoreWarning, warn
from pendcore.run.run_error import REMEDY, require_on_failure

if TYPE_CHECKING:
    import xarray as xr


class Ensemble(EnsembleResult):
    """The result of `ensemble`: arrays whose first axes are those of the members.

    Examples
    --------
    >>> masses = np.linspace(0.5, 1.5, 5)
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[0.5, 1.0], t_span=(0, 5), vary={"link[2].mass": masses}
    ... )
    >>> found.q.shape, found.success.all()
    ((5, 2), np.True_)
    >>> one = found.member(3)  # a Solution, with the same bits
    >>> np.array_equal(one.q[-1], found.q[3])
    True
    """

    __slots__ = ()

    def member(self, index: Any) -> Solution:
        """Return the run of one member as a full `Solution`, with the bits that it had.

        Parameters
        ----------
        index : int, tuple of int, or a row of ``failed``
            Which member.

        Raises
        ------
        ValueError
            If the member was refused: the message says why.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> sol = found.member(1)
        >>> sol.status, np.array_equal(sol.q[-1], found.q[1])
        ('finished', True)
        """
        place = _place(index, self.shape)
        scene = self.members.scene_of(place)
        q0, qd0 = self.members.q0[place], self.members.qd0[place]
        return simulate(
            scene, self.request.t_span, q0, qd0, t_eval=self.request.t_eval, on_failure="ignore",
            **self.request.of_simulate(),
        )  # fmt: skip

    def message(self, index: Any) -> str:
        """Return what the run of one member says of its end, or why it was refused.

        The member is run again, because an ensemble keeps no texts.

        Examples
        --------
        >>> starts = [[0.5, np.nan]]
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), starts, on_failure="ignore")
        >>> found.message(0)
        'q0[1] = nan: must be finite (rad)'
        """
        if self.codes[_place(index, self.shape)] == NOT_RUN:
            return "was not run: .rerun() runs it, and with a store the same call of pc.ensemble"
        try:
            return self.member(index).message
        except ValueError as refusal:
            return str(refusal)

    def rerun(self, **options: Any) -> Ensemble:
        """Run the members that failed once more, along one axis, with other options.

        Parameters
        ----------
        **options
            As in `ensemble`; what is not given stays.

        Returns
        -------
        Ensemble
            Member k is the one at ``failed[k]``.

        Examples
        --------
        >>> short = pc.ensemble(
        ...     pc.Scene.textbook(), q0=[[0.1, 0.1], [1.5, 1.5]], t_span=(0, 9), max_steps=60,
        ...     on_failure="ignore",
        ... )
        >>> short.status, short.rerun(max_steps=1000).status
        (array(['max_steps', 'finished'], dtype='<U14'), array(['finished'], dtype='<U14'))
        """
        own = [name for name in self.request.options if name != "events"]
        of_members = {name: options.pop(name) for name in own if name in options}
        of_the_whole = _of_the_whole("rerun", options, own)
        places = np.flatnonzero(~self.success)
        request = self.request.with_options(**of_members)
        return run_ensemble(self.members.selected(places), request, of_the_whole)

    def second(self, **of_the_whole: Any) -> Ensemble:
        """Run the same members once more, independently, to see which of them are resolved.

        Another method runs them at a hundredth of the tolerances, with constants and starts that
        are some last bits off. If events are looked for, Taylor series are kept: their order and
        their steps are others at the other tolerances.

        Parameters
        ----------
        **of_the_whole
            ``workers``, ``executor``, ``store``, ``chunk``, ``time_limit``, ``on_failure`` and
            ``progress``, as in `ensemble`.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> bool(np.abs(found.second().q - found.q).max() < 1e-6)
        True
        """
        members, request = second(self.members, self.request)
        return run_ensemble(members, request, _of_the_whole("second", of_the_whole))

    def resolved(
        self,
        other: Ensemble | None = None,
        *,
        name: str | None = None,
        within: float | None = None,
        progress: Progress = None,
    ) -> npt.NDArray[np.bool_]:
        """Return which members have a value that a second, independent ensemble confirms, (...).

        Parameters
        ----------
        other : Ensemble, optional
            The second one. Default: it is run now, see `second`.
        name : str, optional
            A reducer, or ``"q"`` or ``"qd"``. Default: the first reducer, or ``"q"``. An energy
            drift counts as resolved where the angles at the end are.
        within : float, optional
            How far the two may differ. Default: 1 % of the time of an event, a tenth of the largest
            exponent, and else 0.1 rad or rad/s.
        progress : as in `ensemble`

        Examples
        --------
        >>> found = pc.ensemble(  # the second start is chaotic
        ...     pc.Scene.textbook(), q0=[[1.5, 1.5], [0.0, 0.0]], t_span=(0, 60)
        ... )
        >>> found.resolved()
        array([ True, False])
        """
        if other is None:
            other = self.second(on_failure="ignore", progress=progress)
        return resolved(self, other, name, within)

    def plot(
        self,
        name: str | None = None,
        ax: Any = None,
        *,
        resolved: npt.ArrayLike | None = None,
        **properties: Any,
    ) -> list[Any]:
        """Draw values of the members: a curve over one axis, or a map over two, with units.

        Parameters
        ----------
        name : str, optional
            A reducer with one number for each member, or a component of the end state: ``"q[1]"``,
            ``"qd[2]"``. Default: the first such reducer, or ``"q[1]"``.
        ax : optional
            An axes of matplotlib's.
        resolved : array_like of bool, (...), optional
            What `resolved` found. In a new figure of two axes, it is drawn beside the map.
        **properties
            Passed on to matplotlib's ``pcolormesh`` or ``plot``.

        Returns
        -------
        list
            What was drawn.

        Examples
        --------
        >>> q0 = np.stack(np.meshgrid([0.5, 1.0, 1.5], [0.0, 1.0], indexing="ij"), axis=-1)
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), q0)
        >>> [image] = found.plot("q[2]")
        >>> image.axes.get_xlabel()
        'q0[1] (rad)'
        """
        return plot(self, name, ax, resolved, properties)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write everything to a file of NumPy's npz format; see `pendcore.load`.

        The file is complete or absent.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> found.save("two.npz")
        >>> np.array_equal(pc.load("two.npz").q, found.q)
        True
        """
        save(self, path)

    def to_xarray(self) -> xr.Dataset:
        """Return everything as a data set of xarray, with units.

        The members' axes are ``member_0``, ``member_1``, ...; starts and varied parameters are
        coordinates along the axes on which they depend.

        Raises
        ------
        ImportError
            If xarray is not installed.

        Examples
        --------
        >>> found = pc.ensemble(
        ...     pc.Scene.textbook(), q0=[0.5, 1.0], t_span=(0, 5), vary={"gravity": [9.8, 1.62]}
        ... )
        >>> found.to_xarray().sizes["member_0"]
        2
        """
        return to_xarray(self)


_OF_THE_WHOLE: dict[str, Any] = {
    **dict.fromkeys(("workers", "executor", "store", "chunk", "time_limit", "progress")),
    "on_failure": "warn",
}


def _of_the_whole(owner: str, given: dict[str, Any], others: Iterable[str] = ()) -> dict[str, Any]:
    """Return all options of the whole; one that is unknown is refused."""
    for name in given:
        if name not in _OF_THE_WHOLE:
            remedy = did_you_mean(name, [*others, *_OF_THE_WHOLE])
            raise TypeError(f"{owner}: has no parameter {name!r}: {remedy}")
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
    report = callback(given["progress"], what, members.count, "members")
    limits = Limits(workers, limit, report)
    try:
        if path is not None:
            with store_for(Path(path), members, request, chunk) as store:
                found = run_blocks(members, request, store.blocks, store, limits, executor)
        elif executor is not None:
            blocks = blocks_of(members.shape, chunk or usual_block(members, request))
            target = InMemory(members, request)
            found = run_blocks(members, request, blocks, target, limits, executor)
        else:
            found = run_members(members, request, workers, limit, report)
    finally:
        close(report)
    result = Ensemble(members, request, found.arrays, found.ending, found.statistics)
    if found.error is not None:
        found.error.ensemble = result  # type: ignore[attr-defined]
        try:
            raise found.error
        finally:
            del found  # the traceback holds this frame: what it holds would wait for the collector
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
    if on_failure == "raise":
        try:
            raise RuntimeError(complaint)
        except RuntimeError as error:
            error.ensemble = found  # type: ignore[attr-defined]
            raise
    try:
        warn(f"{complaint}; {REMEDY}")
    except PendcoreWarning as error:
        error.ensemble = found  # type: ignore[attr-defined]
        raise
    return found


def _place(given: Any, shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return an index of a member as a tuple."""
    place: tuple[int, ...]
    try:
        try:
            place = (whole(given),)
        except TypeError:
            place = tuple(whole(one) for one in given)
        if len(place) != len(shape):
            raise TypeError
    except TypeError:
        raise TypeError(
            f"index = {given!r}: must be {len(shape)} whole numbers: the ensemble has the shape "
            f"{shape}"
        ) from None
    for axis, (i, size) in enumerate(zip(place, shape, strict=True)):
        if not -size <= i < size:
            raise IndexError(f"index[{axis}] = {i}: must be below {size}: the shape is {shape}")
    return place
