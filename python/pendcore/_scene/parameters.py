"""The numbers of a scene by name, such as ``"link[1].mass"`` and ``"effect[2].wind.x"``.

The core lists the names (cpp/include/pendcore/parameters.hpp); here a scene is made again
with other values.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Any

from pendcore import _core
from pendcore._messages.arguments import number
from pendcore._scene.effect_class import Described, Effect
from pendcore._scene.link import Link

PLACE = re.compile(r"(link|effect)\[(\d+)\]\.(.+)")


def changed(
    scene: _core.Scene,
    links: tuple[Link, ...],
    gravity: float,
    effects: tuple[Effect, ...],
    values: Mapping[str, Any],
) -> tuple[list[Link], float, list[Effect]]:
    """Return links, gravity and effects with other values of some parameters."""
    check_parameter_names(scene, values)
    links_changed: dict[int, dict[str, float]] = {}
    new_links, new_effects = list(links), list(effects)
    for name, value in values.items():
        given = number(name, value, "")
        place = PLACE.fullmatch(name)
        if place is None:
            gravity = given
            continue
        kind, counted, field = place.groups()
        i = int(counted) - 1
        if kind == "link":
            links_changed.setdefault(i, {})[field] = given
        else:
            new_effects[i] = _with(new_effects[i], field.split("."), given)
    for i, fields in links_changed.items():
        new_links[i] = links[i].replace(**fields)
    return new_links, gravity, new_effects


def check_parameter_names(scene: _core.Scene, names: Collection[Any]) -> None:
    """Raise a ValueError for a name that the scene does not have, a TypeError if it is no text."""
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f'parameter {name!r}: must be a name, such as "link[1].mass"')
    _core.check_parameter_names(scene, list(names))


def _with(owner: Any, path: list[str], value: float) -> Any:
    """Return an effect, or a part of one, with another value at a path of names."""
    name, *inner = path
    if not inner:
        return owner.replace(**{name: value})
    held = getattr(owner, name)
    if isinstance(held, Described):
        return owner.replace(**{name: _with(held, inner, value)})
    (components,) = (p.components for p in owner.description.parameters if p.name == name)
    which = components.index(inner[0])
    return owner.replace(**{name: tuple(value if k == which else x for k, x in enumerate(held))})
