"""What is looked for along a run: times at which a function of time and state is zero.

    import pendcore as pc

    bottom = pc.events.LinkAngle(1, np.pi / 2)
    sol = pc.simulate(scene, (0, 10), q0, events=[bottom, pc.events.RateZero(joint=2)])
    [event.t for event in sol.events[0]]

Events change no bit of a run; with ``terminal`` they end it. docs/how_to/events.md says what is
found, and what is not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import partial
from math import inf
from typing import Any, ClassVar, Self, SupportsIndex, overload

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import Floats, flag, function, number, numbers, whole_number
from pendcore._scene.parametrized import OfFunction, Parametrized, tuple_of


@dataclass(frozen=True, slots=True, repr=False)
class Event(Parametrized):
    """What every kind of event has.

    Parameters
    ----------
    direction : {0, 1, -1}
        1: only where the function rises through zero; -1: only where it falls; 0: both, and where
        it touches zero and turns back.
    terminal : bool or int
        Whether the run ends there, with status ``event``; a number k: at every k-th occurrence. A
        run that is resumed goes on, to the next such one.
    name : str
        For people: the message of a run that ended says it.

    Examples
    --------
    >>> bottom = pc.events.LinkAngle(1, np.pi / 2, direction=1, terminal=True)
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[bottom])
    >>> f"{sol.status} at {sol.t[-1]:.3f} s"
    'event at 0.653 s'
    """

    kind: ClassVar[str]

    direction: int = field(default=0, kw_only=True)
    terminal: bool | int = field(default=False, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        where = f"{type(self).__name__}: "
        for f in fields(self):
            given = getattr(self, f.name)
            if given is not f.default:
                object.__setattr__(self, f.name, _PLAIN[f.name](where + f.name, given))
        _core.check_event(where, self._as_pair())

    def _as_pair(self) -> tuple[str, dict[str, Any]]:
        """Return the values from which the core makes an event."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return self.kind, values | {"terminal": int(self.terminal), "name": self.name or ""}

    def __repr__(self) -> str:
        values = sorted(self.particulars().items(), key=lambda item: item[0] in _COMMON)
        return f"{type(self).__name__}({', '.join(f'{name}={x!r}' for name, x in values)})"


_COMMON = tuple(f.name for f in fields(Event))


@dataclass(frozen=True, slots=True, repr=False)
class JointAngle(Event):
    """The angle of a joint, phi_j = q_j - q_{j-1}, passes a value.

    Parameters
    ----------
    joint : int
        From 1.
    value : float
        rad; angles are not wrapped.
    every_turn : bool
        Whether ``value + 2 pi k`` counts for every whole k, as in the section of a joint that turns
        over.
    direction, terminal, name
        As in `Event`.

    Examples
    --------
    >>> straight = pc.events.JointAngle(2, 0.0, every_turn=True)
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[straight])
    >>> sol.events[0].t[:3].round(3)  # s
    array([0.592, 1.008, 1.279])
    """

    kind = "joint_angle"
    joint: int
    value: float
    every_turn: bool = field(default=False, kw_only=True)


@dataclass(frozen=True, slots=True, repr=False)
class LinkAngle(Event):
    """The absolute angle of a link passes a value.

    Parameters
    ----------
    link : int
        From 1.
    value, every_turn, direction, terminal, name
        As in `JointAngle`.

    Examples
    --------
    >>> down = pc.events.LinkAngle(link=2, value=np.pi / 2)
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[down])
    >>> sol.events[0].q[:, 1].round(6)  # rad
    array([1.570796, 1.570796, 1.570796, 1.570796])
    """

    kind = "link_angle"
    link: int
    value: float
    every_turn: bool = field(default=False, kw_only=True)


@dataclass(frozen=True, slots=True, repr=False)
class RateZero(Event):
    """A joint or a link turns back: its rate is zero. A joint that comes to stick is found once.

    Parameters
    ----------
    joint, link : int
        One of the two, from 1: the rate of phi_j, or of q_i.
    direction, terminal, name
        As in `Event`; 1 is where the rate rises: the angle is at its least.

    Examples
    --------
    >>> turn = pc.events.RateZero(link=1)
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[turn])
    >>> sol.events[0].t.round(3)  # s
    array([1.195, 2.464, 3.744, 4.957])
    """

    kind = "rate_zero"
    joint: int | None = field(default=None, kw_only=True)
    link: int | None = field(default=None, kw_only=True)


@dataclass(frozen=True, slots=True, repr=False)
class TipLine(Event):
    """The tip crosses a straight line: ``normal @ (tip - point)`` is zero.

    Parameters
    ----------
    point : (float, float)
        A point of the line, m; x right, y down, the origin at the undriven pivot.
    normal : (float, float)
        A vector across the line, of any length: the function rises where the tip goes this way.
    direction, terminal, name
        As in `Event`.

    Examples
    --------
    >>> wall = pc.events.TipLine(point=(-1.0, 0.0), normal=(1.0, 0.0))  # x = -1 m
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[wall])
    >>> sol.events[0].direction  # it swings to the left through the wall, and back
    array([-1,  1, -1,  1])
    """

    kind = "tip_line"
    point: tuple[float, float]
    normal: tuple[float, float]


@dataclass(frozen=True, slots=True, repr=False)
class Function(Event, OfFunction):
    """A function of one's own passes zero.

    The function is sampled at the ends of each step and in between, and every change of sign is
    located; two changes between neighbouring samples are not seen. The function must return the
    same for the same arguments. It cannot be pickled, saved or written in a case file.

    Parameters
    ----------
    f : callable
        ``f(t, q, qd)`` returns a number; q and qd are arrays, (n,), rad and rad/s.
    samples : int
        In each step, >= 1.
    max_step : float
        The longest time between two samples, s, > 0. It changes no step of the run.
    direction, terminal, name
        As in `Event`.

    Examples
    --------
    >>> together = pc.events.Function(lambda t, q, qd: qd[0] - qd[1])  # joint 2 rests
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[together])
    >>> [round(event.t, 3) for event in sol.events[0][:2]]  # s
    [0.387, 0.773]
    """

    kind = "function"
    f: Callable[[float, Floats, Floats], float]
    samples: int = field(default=8, kw_only=True)
    max_step: float = field(default=inf, kw_only=True)


KINDS: dict[str, type[Event]] = {
    cls.kind: cls for cls in (JointAngle, LinkAngle, RateZero, TipLine, Function)
}
"""The classes of events by their kind, as in case files."""


def _occurrences(name: str, terminal: object) -> bool | int:
    if isinstance(terminal, bool | np.bool_):
        return bool(terminal)
    count = whole_number(name, terminal)
    if count < 1:
        raise ValueError(f"{name} = {count}: must be True, False, or so many occurrences, >= 1")
    return count


def _function(name: str, given: object) -> object:
    for attribute in ("terminal", "direction"):
        if value := getattr(given, attribute, None):
            raise TypeError(
                f"{name}.{attribute} = {value!r}: is not read from the function: give it to the "
                f"event, Function(f, {attribute}={value!r})"
            )
    return function(name, given)


def _one_line(name: str, given: object) -> str:
    if not (isinstance(given, str) and given.isprintable()):
        raise TypeError(f"{name} = {given!r}: must be a text of one line")
    return given


_PLAIN: dict[str, Callable[[str, Any], object]] = {
    "direction": whole_number,
    "terminal": _occurrences,
    "name": _one_line,
    "joint": whole_number,
    "link": whole_number,
    "value": partial(number, unit="rad"),
    "every_turn": flag,
    "point": partial(numbers, unit="m", count=2),
    "normal": partial(numbers, unit="1", count=2),
    "f": _function,
    "samples": whole_number,
    "max_step": partial(number, unit="s"),
}
"""What checks the type of each parameter; the core checks its range."""


def event_of(kind: str, values: Mapping[str, Any]) -> Event:
    """Return an event from the values that the core keeps."""
    terminal = {0: False, 1: True}.get(values["terminal"], values["terminal"])
    return KINDS[kind](**{**values, "terminal": terminal, "name": values["name"] or None})


def events_asked_for(events: Iterable[Event]) -> tuple[Event, ...]:
    """Return the events to look for; raise TypeError for anything else."""
    return tuple_of("event", Event, events, "pendcore.events")


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

    ``t`` (k,), ``y`` (k, 2n), ``q`` and ``qd`` (k, n), and ``direction`` (k,) have a row for each
    `Found`, in its units.

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


__all__ = [
    "Event",
    "Found",
    "FoundEvents",
    "Function",
    "JointAngle",
    "LinkAngle",
    "RateZero",
    "TipLine",
]
__dir__ = __all__.copy
