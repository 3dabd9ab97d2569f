"""Events: what a user may look for along a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from math import inf
from typing import Any, ClassVar, NoReturn, Self

import numpy as np

from pendcore import _core
from pendcore._messages.arguments import Floats, flag, number, numbers, whole_number


@dataclass(frozen=True, slots=True, repr=False)
class Event:
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
    >>> bottom = pc.events.LinkAngle(1, np.pi / 2, direction=1, terminal=True, name="bottom")
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
        self._take(where)
        self._set("direction", whole_number(where + "direction", self.direction))
        if isinstance(self.terminal, np.bool_):
            self._set("terminal", bool(self.terminal))
        if not isinstance(self.terminal, bool):
            self._set("terminal", whole_number(where + "terminal", self.terminal))
            if self.terminal < 1:
                wanted = "True, False, or so many occurrences, >= 1"
                raise ValueError(f"{where}terminal = {self.terminal}: must be {wanted}")
        if self.name is not None and not (isinstance(self.name, str) and self.name.isprintable()):
            raise TypeError(f"{where}name = {self.name!r}: must be a text of one line")
        _core.check_event(where, self._as_pair())

    def _take(self, where: str) -> None:
        """Check and convert the parameters of a kind of event."""
        raise NotImplementedError

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _take_angle(self, where: str, number_of: str) -> None:
        """Check and set the parameters of the kinds for an angle."""
        values: Any = self
        self._set(number_of, whole_number(where + number_of, getattr(values, number_of)))
        self._set("value", number(where + "value", values.value, "rad"))
        self._set("every_turn", flag(where + "every_turn", values.every_turn))

    def particulars(self) -> dict[str, Any]:
        """Return the parameters that differ from their defaults, enough to make it again."""
        return {
            f.name: value for f in fields(self) if (value := getattr(self, f.name)) != f.default
        }

    def replace(self, **changes: Any) -> Self:
        """Return an event with other parameters; those not given stay."""
        return type(self)(**{**self.particulars(), **changes})

    __replace__ = replace  # copy.replace() of Python 3.13

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

    def _take(self, where: str) -> None:
        self._take_angle(where, "joint")


@dataclass(frozen=True, slots=True, repr=False)
class LinkAngle(Event):
    """The absolute angle of a link passes a value.

    Parameters
    ----------
    link : int
        From 1.
    value : float
        rad; angles are not wrapped.
    every_turn : bool
        Whether ``value + 2 pi k`` counts for every whole k.
    direction, terminal, name
        As in `Event`.

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

    def _take(self, where: str) -> None:
        self._take_angle(where, "link")


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

    def _take(self, where: str) -> None:
        for name, value in (("joint", self.joint), ("link", self.link)):
            if value is not None:
                self._set(name, whole_number(where + name, value))


@dataclass(frozen=True, slots=True, repr=False)
class TipLine(Event):
    """The tip crosses a straight line: ``normal . (tip - point)`` is zero.

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

    def _take(self, where: str) -> None:
        self._set("point", numbers(where + "point", self.point, "m", 2))
        self._set("normal", numbers(where + "normal", self.normal, "1", 2))


@dataclass(frozen=True, slots=True, repr=False)
class Function(Event):
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
    >>> together = pc.events.Function(lambda t, q, qd: qd[0] - qd[1])  # joint 2 is at rest
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, events=[together])
    >>> [round(event.t, 3) for event in sol.events[0][:2]]  # s
    [0.387, 0.773]
    """

    kind = "function"
    f: Callable[[float, Floats, Floats], float]
    samples: int = field(default=8, kw_only=True)
    max_step: float = field(default=inf, kw_only=True)

    def _take(self, where: str) -> None:
        if not callable(self.f):
            raise TypeError(f"{where}f = {self.f!r}: must be a function of t, q, qd")
        self._set("samples", whole_number(where + "samples", self.samples))
        self._set("max_step", number(where + "max_step", self.max_step, "s"))

    def cannot_be(self, what: str, remedy: str = "") -> TypeError:
        """Return the error that says why it cannot be pickled, written, saved."""
        reason = "a function lives in one process alone"
        return TypeError(f"{self!r}: cannot be {what}: {reason}{remedy}")

    def __reduce__(self) -> NoReturn:
        raise self.cannot_be("pickled")


KINDS: dict[str, type[Event]] = {
    cls.kind: cls for cls in (JointAngle, LinkAngle, RateZero, TipLine, Function)
}
"""The classes of events by their kind, as in case files."""


def event_of(kind: str, values: Mapping[str, Any]) -> Event:
    """Return an event from the values that the core keeps."""
    terminal = {0: False, 1: True}.get(values["terminal"], values["terminal"])
    return KINDS[kind](**{**values, "terminal": terminal, "name": values["name"] or None})


def events_asked_for(events: Iterable[Event]) -> tuple[Event, ...]:
    """Return the events to look for; raise TypeError for anything else."""
    if type(events) is tuple and not events:
        return ()
    remedy = "must be a list of pendcore.events"
    if isinstance(events, Event):
        raise TypeError(f"events = {events!r}: {remedy}: put it in brackets")
    try:
        events = tuple(events)
    except TypeError:
        raise TypeError(f"events = {events!r}: {remedy}") from None
    for i, event in enumerate(events, start=1):
        if not isinstance(event, Event):
            raise TypeError(
                f"event {i} = {event!r}: must be one of pendcore.events, as RateZero(1)"
            )
    return events


for public in (Event, *KINDS.values()):
    public.__module__ = "pendcore.events"  # where a user finds them
