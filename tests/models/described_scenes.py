"""Scenes of the core made from what the reference describes, and the other way round."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import pendcore as pc
from reference.arithmetic import DOUBLE, Arithmetic
from reference.effects import Described, law
from reference.newton_euler import Body
from reference.rig import Rig


def effect_of(described: Described) -> Any:
    """Make an effect of the core; a dict among its parameters becomes an object of its own."""
    kind, told = described
    made_of = {
        "sinusoid": pc.effects.Sinusoid,
        "x": pc.effects.Sinusoid,
        "y": pc.effects.Sinusoid,
        "table": pc.effects.Table,
        "spline": pc.effects.Spline,
        "pd": pc.effects.PD,
    }
    parameters = {
        name: made_of[name](**value) if isinstance(value, Mapping) else value
        for name, value in told.items()
    }
    return pc.effects.kinds()[kind](**parameters)


def scene_of(
    bodies: Sequence[Body], gravity: float, described: Sequence[Described] = ()
) -> pc.Scene:
    """Make a scene; that numbers drawn at random are implausible needs no warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(
            links=[pc.Link(**body._asdict()) for body in bodies],
            gravity=gravity,
            effects=[effect_of(one) for one in described],
        )


def rig_of(scene: pc.Scene, arithmetic: Arithmetic = DOUBLE) -> Rig:
    """Make what the reference takes of a scene."""
    laws = []
    for effect in scene.effects:
        told = {
            name: value.particulars() if isinstance(value, pc.effects.Part) else value
            for name, value in effect.particulars().items()
        }
        laws.append(law((effect.kind, told)))
    bodies = [Body(x.mass, x.length, x.center, x.inertia) for x in scene.links]
    return Rig(bodies=bodies, gravity=scene.gravity, effects=laws, arithmetic=arithmetic)
