"""Dry friction in one joint, solved event by event in many digits: nothing is shared with the core.

One rod of moment of inertia 1 without gravity under the torque bias + amplitude sin(frequency t);
friction is the same in sliding and at rest. Every phase is a closed form, and what ends it the root
of a scalar function.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from mpmath import asin, findroot, mp, mpf, pi  # type: ignore[import-untyped]

DIGITS = 34


@dataclass(frozen=True, slots=True, kw_only=True)
class Hum:
    """The torque, and the friction against it."""

    bias: Any = 0
    amplitude: Any
    frequency: Any
    friction: Any

    def torque(self, t: Any) -> Any:
        return self.bias + self.amplitude * mp.sin(self.frequency * t)

    def impulse(self, begin: Any, t: Any) -> Any:
        """The integral of the torque."""
        turned = mp.cos(self.frequency * begin) - mp.cos(self.frequency * t)
        return self.bias * (t - begin) + self.amplitude / self.frequency * turned

    def release(self, t: Any) -> tuple[Any, int]:
        """When the torque next leaves the range that friction holds, and to which side."""
        found = []
        for side in (1, -1):
            level = (side * self.friction - self.bias) / self.amplitude
            if abs(level) >= 1:
                continue
            # the torque leaves to that side at the angle where the sine passes `level` that way
            angle = asin(level) if side > 0 else pi - asin(level)
            turn = 2 * pi / self.frequency
            time = angle / self.frequency
            found.append((time + turn * mp.ceil((t - time) / turn), side))
        return min(found)


@dataclass(frozen=True, slots=True)
class Slide:
    """From rest at `begin` and `angle` to rest again at `end`, in the direction `side`."""

    hum: Hum
    begin: Any
    angle: Any
    side: int
    end: Any

    def rate(self, t: Any) -> Any:
        hum = self.hum
        return hum.impulse(self.begin, t) - self.side * hum.friction * (t - self.begin)

    def angle_at(self, t: Any) -> Any:
        hum, past = self.hum, t - self.begin
        sines = mp.sin(hum.frequency * t) - mp.sin(hum.frequency * self.begin)
        swung = mp.cos(hum.frequency * self.begin) * past - sines / hum.frequency
        steady = (hum.bias - self.side * hum.friction) * past**2 / 2
        return self.angle + steady + hum.amplitude / hum.frequency * swung


def zero_after(rate: Callable[[Any], Any], begin: Any, turn: Any, side: int) -> Any:
    """The first zero of a slide's rate: it turns back once in a turn of the torque at most."""
    step = turn / 1000
    t = begin + step
    while side * rate(t) > 0:
        t += step
    return findroot(rate, (t - step, t), solver="anderson", tol=mpf(10) ** (6 - 2 * DIGITS))


def slides(hum: Hum, t_end: Any) -> Iterator[Slide]:
    """The slides from rest at t = 0 and angle 0, each followed by rest; none goes on beyond t_end.

    Where the torque at the end of a slide is beyond what friction holds, the next begins at once.
    """
    t = angle = mpf(0)
    while True:
        torque = hum.torque(t)
        side = int(mp.sign(torque)) if abs(torque) > hum.friction else 0
        begin, side = (t, side) if side else hum.release(t)
        if begin >= t_end:
            return
        slide = Slide(hum, begin, angle, side, None)
        end = zero_after(slide.rate, begin, 2 * pi / hum.frequency, side)
        slide = Slide(hum, begin, angle, side, end)
        yield slide
        t, angle = end, slide.angle_at(end)
