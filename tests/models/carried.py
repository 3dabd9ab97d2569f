"""The scenes that a method supports: Taylor series need equations that have a series."""

from __future__ import annotations

from typing import Any

import pendcore as pc

WITHOUT_SERIES = ("rod_drag", "user", "compiled_user")


def carried(method: str, scene: pc.Scene) -> str:
    """Return the method, with ``dop853`` in place of ``taylor`` if that refuses the scene."""
    return method.replace("taylor", "dop853") if any(map(_refused, scene.effects)) else method


def is_refusal_of_series(error: ValueError) -> bool:
    """Whether `error` is the refusal by taylor of an effect that has no series, and no other."""
    kinds = (*WITHOUT_SERIES, "dry_joint_friction")
    return any(f"({kind}) has no Taylor series" in str(error) for kind in kinds)


def _refused(effect: Any) -> bool:
    if effect.kind == "dry_joint_friction":
        return effect.static is not None and effect.static > effect.coulomb
    return effect.kind in WITHOUT_SERIES
