"""The table [map] of a case file: which two numbers span the map, and what it shows.

A name is that of a parameter (`Scene.parameters`), or of an angle or rate at the start: ``q0[1]``,
``q0_deg[1]``, ``qd0[2]``. `pendcore map --help` shows a table.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pendcore.case_files import TomlText, text_of
from pendcore.messages import Floats

KEYS = {"map": ("show", "x", "y")}
AXIS_KEYS = ("name", "start", "stop", "count")
MOST = 100_000
"""The most pixels along an axis."""


@dataclass(frozen=True, slots=True)
class MapAxis:
    """Pixels along an axis, whose edges are even from ``start`` to ``stop``."""

    name: str
    start: float
    stop: float
    count: int

    @property
    def values(self) -> Floats:
        """The values at the centres, in the unit of the name, (count,)."""
        width = (self.stop - self.start) / self.count
        from_middle = np.arange(self.count) - 0.5 * (self.count - 1)
        return np.asarray(0.5 * (self.start + self.stop) + width * from_middle, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class MapTable:
    """What [map] asks for."""

    show: str
    x: MapAxis
    y: MapAxis


def read_map_table(path: Path) -> MapTable:
    """Read the table [map] of a case file; messages name file and line."""
    text = TomlText(text_of(path), str(path))
    if "map" not in text.content:
        raise ValueError(
            f"{path}: has no table [map]: it needs show, and x and y such as "
            'x = {name = "q0_deg[1]", start = -180, stop = 180, count = 300}'
        )
    text.check_keys(("map",), KEYS)
    table = text.table(("map",))
    for key in KEYS["map"]:
        if key not in table:
            raise text.error(("map",), f"[map] needs {key}")
    show = table["show"]
    if not isinstance(show, str):
        raise text.error(("map", "show"), f"show = {show!r}: must be a text")
    x, y = _axis(text, "x"), _axis(text, "y")
    if x.name.replace("_deg", "") == y.name.replace("_deg", ""):
        raise text.error(("map", "y"), f"y.name = {y.name!r}: is that of x too: name another one")
    return MapTable(show, x, y)


def _axis(text: TomlText, key: str) -> MapAxis:
    place = ("map", key)
    table = text.value(place)
    if not isinstance(table, dict) or set(table) != set(AXIS_KEYS):
        raise text.error(place, f"{key}: must be a table with {', '.join(AXIS_KEYS)}")
    name, count = table["name"], table["count"]
    if not isinstance(name, str):
        raise text.error(place, f"{key}.name = {name!r}: must be a text")
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST:
        complaint = f"{key}.count = {count!r}: must be a whole number from 2 to {MOST:,}"
        raise text.error(place, complaint)
    start, stop = (text.number((*place, one)) for one in ("start", "stop"))
    if not start < stop:
        raise text.error(place, f"{key}: start = {start:g}, stop = {stop:g}: must be increasing")
    return MapAxis(name, start, stop, count)
