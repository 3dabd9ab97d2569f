"""What is looked for along a run: times at which a function of time and state is zero.

    import pendcore as pc

    bottom = pc.events.LinkAngle(1, np.pi / 2)
    sol = pc.simulate(scene, (0, 10), q0, events=[bottom, pc.events.RateZero(joint=2)])
    [event.t for event in sol.events[0]]

Events change no bit of a run; with ``terminal`` they end it. docs/how_to/events.md says what is
found, and what is not.
"""

from __future__ import annotations

from pendcore._run.events import Event, Function, JointAngle, LinkAngle, RateZero, TipLine
from pendcore._run.found_events import Found, FoundEvents

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
