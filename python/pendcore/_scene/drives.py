"""What depends on time in a scene: the sinusoids, tables and splines of its effects."""

from __future__ import annotations

from collections.abc import Iterator

from pendcore._scene.effect_class import Part
from pendcore._scene.scene import Scene


def fastest_drive(scene: Scene) -> float:
    """Return the largest angular frequency of a sinusoid in any effect, rad/s."""
    return max((abs(getattr(x, "angular_frequency", 0.0)) for x, _ in parts(scene)), default=0.0)


def parts(scene: Scene) -> Iterator[tuple[Part, str]]:
    """Yield the parts of effects, tables, splines and sinusoids among them, and what they are."""
    for i, effect in enumerate(scene.effects, start=1):
        for name, value in effect.particulars().items():
            if isinstance(value, Part):
                yield value, f"the {name} of effect {i} ({effect.kind})"


def changes_with_time(scene: Scene) -> bool:
    """Return whether an effect has a table, a spline or a sinusoid."""
    return any(hasattr(part, "t") or hasattr(part, "angular_frequency") for part, _ in parts(scene))


def outside_of_tables(scene: Scene, t: float) -> str:
    """Name the table or spline that does not reach to a time, and its effect; empty if none."""
    for part, what in parts(scene):
        times = getattr(part, "t", None)
        if times is not None and not times[0] <= t <= times[-1]:
            return f"{what}, {times[0]:.6g} to {times[-1]:.6g} s"
    return ""
