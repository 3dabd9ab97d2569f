"""Scenes of the core made from what the reference describes."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import pendcore as pc
from reference.effects import Described
from reference.newton_euler import Body


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
