"""What an ensemble keeps of each member beside its end: reducers, which the core computes."""

from __future__ import annotations

from dataclasses import dataclass

from pendcore.messages.arguments import known_keywords
from pendcore.run.events import Event
from pendcore.scene.frozen_state import frozen_state


class Reducer:
    """What makes one number of a whole run.

    Examples
    --------
    >>> isinstance(pc.keep.FirstEvent(pc.events.LinkAngle(1, 0.0)), pc.keep.Reducer)
    True
    """

    __slots__ = ()


@frozen_state
@dataclass(frozen=True, slots=True, init=False)
class FirstEvent(Reducer):
    """The time at which an event first happens, s; NaN where it does not.

    Parameters
    ----------
    event : pendcore.events.Event
        If it is ``terminal``, each member ends there, with status ``event``.

    Examples
    --------
    >>> over = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True, terminal=True)
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[[0.0, 0.0], [-1.2, -0.6]], t_span=(0, 5),
    ...     keep=pc.keep.FirstEvent(over),
    ... )
    >>> found["first_event"].round(3)
    array([  nan, 1.343])
    """

    event: Event

    @known_keywords
    def __init__(self, event: Event) -> None:
        if not isinstance(event, Event):
            raise TypeError(
                f"event = {event!r}: must be an event, such as pc.events.LinkAngle(1, 0.0)"
            )
        object.__setattr__(self, "event", event)


USUAL_NAMES = {FirstEvent: "first_event"}
"""The name of a reducer that is given alone."""
