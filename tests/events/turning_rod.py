"""A rod that nothing turns, and what is looked at of the events that are found of it."""

from __future__ import annotations

import pendcore as pc
from unit_rods import rod


def turning(rate, span, events, q0=0.0, **how):
    return pc.simulate(rod(), span, q0, rate, events=events, **how)


def times(found):
    return [one.t for one in found]


def directions(found):
    return [one.direction for one in found]
