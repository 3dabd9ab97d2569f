"""What depends on time in a scene: the sinusoids, tables and splines of its effects."""

from __future__ import annotations

from collections.abc import Iterator

from pendcore._scene.effect_class import Part
from pendcore._scene.scene import Scene


def fastest_drive(scene: Scene) -> float:
    """Return the largest angular frequency of a sinusoid in any effect, rad/s."""
    return max((abs(getattr(x, "angular_frequency", 0.0)) for x in parts(scene)), default=0.0)


def parts(scene: Scene) -> Iterator[Part]:
    """Yield the parts of effects: tables, splines and sinusoids among them."""
    for effect in scene.effects:
        for parameter in effect.description.parameters:
            value = getattr(effect, parameter.name)
            if isinstance(value, Part):
                yield value


def changes_with_time(scene: Scene) -> bool:
    """Return whether an effect has a table, a spline or a sinusoid."""
    names = {p.name for part in parts(scene) for p in part.description.parameters}
    return not names.isdisjoint({"t", "angular_frequency"})


def outside_of_tables(scene: Scene, t: float) -> str:
    """Name the table or spline that does not reach to a time, and its effect; empty if none."""
    for i, effect in enumerate(scene.effects, start=1):
        for parameter in effect.description.parameters:
            value = getattr(effect, parameter.name)
            times = getattr(value, "t", None) if isinstance(value, Part) else None
            if times is not None and not times[0] <= t <= times[-1]:
                where = f"{times[0]:.6g} to {times[-1]:.6g} s"
                return f"the {parameter.name} of effect {i} ({effect.kind}), {where}"
    return ""
