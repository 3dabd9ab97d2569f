"""The same motion in other units, in a mirror, run backward, or with whole turns added.

Each function makes of what was drawn another run, whose motion follows from the first one's.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, pi, tau
from typing import Any

import pendcore as pc
from fuzz.drawn_run import Drawn
from pendcore._scene.effect_class import Part
from pendcore._scene.effect_description import Parameter

Change = Callable[[str, Parameter, Any, str], Any]
"""From the name of an effect, a parameter, its value and its unit to another value."""


def with_effects(scene: pc.Scene, effects: list[Any], **changes: Any) -> pc.Scene:
    """Return a scene with other effects; that it is implausible was known before."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return scene.replace(effects=effects, **changes)


def changed(effect: Any, change: Change) -> Any:
    """Return an effect with every parameter changed, those of its parts included."""
    return _changed(effect, effect.kind, "", change)


def _changed(whole: Any, where: str, unit: str, change: Change) -> Any:
    values = {}
    for p in whole.description.parameters:
        value = getattr(whole, p.name)
        own = unit if " or " in p.unit else p.unit
        if isinstance(value, Part):
            values[p.name] = _changed(value, f"{where}.{p.name}", p.unit, change)
        elif value is not None:
            values[p.name] = change(where, p, value, own)
    return type(whole)(**values)


def _each(value: Any, f: Callable[[float], float]) -> Any:
    return tuple(map(f, value)) if isinstance(value, tuple) else f(value)


# Units ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Units:
    """How many new units of mass, length and time make one old unit; powers of two."""

    kg: float = 1.0
    m: float = 1.0
    s: float = 1.0

    def factor(self, unit: str) -> float:
        """Return what a number of a unit such as ``"N m s/rad"`` is multiplied with."""
        known = {"kg": self.kg, "m": self.m, "s": self.s, "rad": 1.0, "1": 1.0, "": 1.0}
        known["N"] = self.kg * self.m / self.s**2
        known["J"] = known["N"] * self.m
        above, _, below = unit.partition("/")
        product = 1.0
        for sign, part in ((1, above), (-1, below)):
            for word in part.split():
                name, _, power = word.partition("^")
                product *= known[name] ** (sign * int(power or 1))
        return product


def in_units(drawn: Drawn, units: Units) -> Drawn:
    """Return the same run, told in other units; the first step must be given, or a fixed one."""

    def scale(where: str, p: Parameter, value: Any, unit: str) -> Any:
        if p.type in ("int", "bool"):
            return value
        return _each(value, lambda x: x * units.factor(unit))

    scene = drawn.scene
    units_of = {"mass": "kg", "length": "m", "center": "m", "inertia": "kg m^2"}
    links = [
        pc.Link(**{x: getattr(link, x) * units.factor(unit) for x, unit in units_of.items()})
        for link in scene.links
    ]
    gravity = scene.gravity * units.factor("m/s^2")
    effects = [changed(effect, scale) for effect in scene.effects]
    steps = {"first_step", "max_step", "step"} & {*drawn.options}
    options = drawn.options | {name: drawn.options[name] * units.s for name in steps}
    n, atol = len(links), options["atol"]
    options["atol"] = [atol] * n + [atol / units.s] * n
    begin, end = drawn.t_span
    return replace(
        drawn,
        scene=with_effects(scene, effects, links=links, gravity=gravity),
        qd0=[x / units.s for x in drawn.qd0],
        t_span=(begin * units.s, end * units.s),
        options=options,
    )


# Mirrors --------------------------------------------------------------------------------------

TORQUES = {("motor", "constant"), ("motor.sinusoid", "amplitude"), ("motor.table", "torque")}
ANGLES = {
    ("torsional_spring", "rest_angle"),
    ("motor.pd", "reference"),
    ("lock", "angle"),
    ("joint_stop", "range"),
}
ALONG_X = {("driven_pivot.x", "amplitude"), ("driven_pivot.spline", "x")}
ALONG_Y = {("driven_pivot.y", "amplitude"), ("driven_pivot.spline", "y")}
MIRRORED = {
    "viscous_joint", "dry_joint_friction", "rod_drag", "torsional_spring", "motor",
    "rotor_inertia", "payload", "lock", "driven_pivot", "joint_stop",
}  # fmt: skip
"""The kinds of effects whose mirror image is known here."""


def _mirror_of(axis: int, first_joint: float) -> Callable[[Any], Any]:
    """Return what makes an effect its mirror image; that of an angle of joint 1 is added."""
    moved = (ALONG_X, ALONG_Y)[axis]

    def image(effect: Any) -> Any:
        shift = first_joint if getattr(effect, "joint", 0) == 1 else 0.0

        def change(where: str, p: Parameter, value: Any, unit: str) -> Any:
            if (where, p.name) in TORQUES | moved:
                return _each(value, lambda x: -x)
            if (where, p.name) in ANGLES:
                turned = _each(value, lambda x: shift - x)
                return tuple(reversed(turned)) if isinstance(turned, tuple) else turned
            if (where, p.name) == ("rod_drag", "wind"):
                return (-value[0], value[1]) if axis == 0 else (value[0], -value[1])
            return value

        return changed(effect, change)

    return image


def upside_down(drawn: Drawn) -> Drawn:
    """Return the mirror image in the horizontal: q -> -q, and gravity pulls up. Exact bits."""
    image = _mirror_of(1, 0.0)
    scene = with_effects(
        drawn.scene, [image(e) for e in drawn.scene.effects], gravity=-drawn.scene.gravity
    )
    return replace(drawn, scene=scene, q0=[-x for x in drawn.q0], qd0=[-x for x in drawn.qd0])


def left_to_right(drawn: Drawn) -> Drawn:
    """Return the mirror image in the vertical: q -> pi - q, which rounds."""
    image = _mirror_of(0, pi)
    scene = with_effects(drawn.scene, [image(e) for e in drawn.scene.effects])
    return replace(drawn, scene=scene, q0=[pi - x for x in drawn.q0], qd0=[-x for x in drawn.qd0])


def turned_once(drawn: Drawn) -> Drawn:
    """Return the same with a turn more in every angle, which rounds."""

    def of(effect: Any) -> Any:
        def change(where: str, p: Parameter, value: Any, unit: str) -> Any:
            if (where, p.name) in ANGLES and effect.joint == 1:
                return _each(value, lambda x: x + tau)
            return value

        return changed(effect, change)

    scene = with_effects(drawn.scene, [of(effect) for effect in drawn.scene.effects])
    return replace(drawn, scene=scene, q0=[x + tau for x in drawn.q0])


def backward(drawn: Drawn) -> Drawn:
    """Return the run of a scene without losses in reversed time. Exact bits."""
    return replace(drawn, qd0=[-x for x in drawn.qd0], t_span=(-drawn.t_span[0], -drawn.t_span[1]))


# Absence --------------------------------------------------------------------------------------

STRENGTHS = {
    "damping", "damping2", "damping3", "coulomb", "drag_coefficient", "stiffness", "constant",
    "amplitude", "torque", "kp", "kd", "armature", "mass", "inertia",
}  # fmt: skip


def without_strength(effect: Any) -> Any:
    """Return an effect that does nothing: what it could do is zero, and the rest as it is."""

    def change(where: str, p: Parameter, value: Any, unit: str) -> Any:
        if p.name in STRENGTHS or (where == "driven_pivot.spline" and p.name in "xy"):
            return _each(value, lambda x: 0.0)
        if where == "dry_joint_friction" and p.name == "static":
            return 0.0
        return (-inf, 1e6) if (where, p.name) == ("joint_stop", "range") else value

    return changed(effect, change)
