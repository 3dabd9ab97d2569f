"""Random events: every kind and direction, terminal at times, functions that fail among them."""

from __future__ import annotations

from typing import Any

import pendcore as pc

from fuzz import own_functions
from fuzz.choices import Choices, happens
from fuzz.quantities import angle, signed, size


def events(choices: Choices, regime: str, n: int) -> list[Any]:
    """Return some events of a chain of n links; raises ValueError for values that are none."""
    return [_event(choices, regime, n) for _ in range(choices.one_of((1, 1, 2, 3)))]


def _event(choices: Choices, regime: str, n: int) -> Any:
    fx = pc.events
    common: dict[str, Any] = {"direction": choices.one_of((0, 0, 1, -1))}
    if happens(choices, 20):
        common["terminal"] = choices.one_of((True, 1, 2, 5))
    number = choices.integer(1, n)
    kind = choices.integer(0, 9)
    if kind <= 3:
        turning = fx.JointAngle if kind <= 1 else fx.LinkAngle
        every_turn = happens(choices, 30)
        return turning(number, angle(choices, regime), every_turn=every_turn, **common)
    if kind <= 6:
        return fx.RateZero(**{choices.one_of(("joint", "link")): number}, **common)
    if kind <= 8:
        point = (signed(choices, regime), signed(choices, regime))
        normal = (signed(choices, regime), size(choices, regime))
        return fx.TipLine(point, normal, **common)
    function = own_functions.Watched(choices.one_of(own_functions.WATCHED))
    return fx.Function(function, samples=choices.integer(1, 9), **common)
