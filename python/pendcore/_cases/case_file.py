"""A case from TOML: docs/how_to/case_files.md has its keys, examples/03_case_file.toml is one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import MISSING, fields
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from pendcore._cases.case import Case
from pendcore._cases.toml_text import Place, TomlText
from pendcore._messages.arguments import did_you_mean, vector
from pendcore._scene.effect_class import Effect, OwnEffect
from pendcore._scene.link import Link
from pendcore._scene.scene import Scene
from pendcore.effects import KINDS, PARTS, made
from pendcore.events import KINDS as EVENT_KINDS
from pendcore.events import Event, Function
from pendcore.options import OPTIONS, RUN_DEFAULTS

KEYS = {
    "": ("name", "gravity", "link", "effect", "event", "start", "run", "map"),
    "link": tuple(f.name for f in fields(Link)),
    "effect": ("kind",),
    "event": ("kind",),
    "start": ("q", "q_deg", "qd"),
    "run": ("t_start", "t_end", *(key for key in RUN_DEFAULTS if key != "events")),
}
"""The known keys of every kind of table; "" stands for what is above all tables."""

_OF_TEXTS = {key for key, one in OPTIONS.items() if one.annotation.startswith("Iterable[str]")}

MOST_TIMES = 1_000_000
"""That a few words of a file may stand for in ``t_eval``."""
MOST_BYTES = 2**26
"""The largest file: room for a million times, and tables of a million rows."""

EFFECT_KEYS = {
    kind: (*KEYS["effect"], *(parameter.name for parameter in cls.description.parameters))
    for kind, cls in KINDS.items()
    if not issubclass(cls, OwnEffect)
}
"""The known keys of an effect of every kind that a file can hold."""

EVENT_KEYS = {
    kind: (*KEYS["event"], *(f.name for f in fields(cls)))
    for kind, cls in EVENT_KINDS.items()
    if cls is not Function
}
"""The same of an event."""

_ANYWHERE = KEYS | {
    "effect": tuple({key for keys in EFFECT_KEYS.values() for key in keys}),
    "event": tuple({key for keys in EVENT_KEYS.values() for key in keys}),
}


def with_line(path: Path, complaint: str) -> str:
    """Return a complaint of `Case.simulate` with file and line of what it begins with."""
    text = TomlText(text_of(path), str(path))
    return str(text.error(_place(complaint), complaint))


def text_of(path: Path) -> str:
    """Return the text of a file in UTF-8."""
    with path.open("rb") as file:
        content = file.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise ValueError(f"{path}: is too large for a case: at most {MOST_BYTES:,} bytes")
    try:
        text = content.decode("utf-8-sig")  # Windows' editors write a byte order mark
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not a text file in UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def case_from_text(content: str, name: str) -> Case:
    """Read a case from TOML that messages call ``name``; see `read_case`."""
    text = TomlText(content.removeprefix("\ufeff"), name)
    text.check_keys((), _ANYWHERE)
    if "qd_deg" in text.table(("start",)):
        raise text.error(("start", "qd_deg"), "unknown key 'qd_deg' in [start]: give qd, in rad/s")
    text.check_keys(("start",), _ANYWHERE)
    text.check_keys(("run",), _ANYWHERE)
    scene = _scene(text)
    q0, qd0 = _start(text, len(scene.links))
    t_span, options = _run(text)
    if events := [_event(text, i, table) for i, table in enumerate(_tables(text, "event"))]:
        options["events"] = events
    title = text.value(("name",)) or ""
    if not isinstance(title, str):
        raise text.error(("name",), f"name = {title!r}: must be a string")
    try:
        return Case(scene=scene, q0=q0, qd0=qd0, t_span=t_span, name=title, options=options)
    except ValueError as error:
        raise text.error(_place(str(error)), str(error)) from None


def _scene(text: TomlText) -> Scene:
    tables = text.value(("link",))
    if isinstance(tables, dict):
        raise text.error(("link",), "[link] is one table: write [[link]], once for each link")
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise text.error(("link",), "links are needed: a table [[link]] for each")
    links = []
    for i, table in enumerate(tables):
        text.check_keys(("link", i), _ANYWHERE)
        for key in ("mass", "length"):
            if key not in table:
                raise text.error(("link", i), f"link {i + 1} needs {key}")
        links.append(Link(**{key: text.number(("link", i, key)) for key in table}))
    gravity = {"gravity": text.number(("gravity",))} if "gravity" in text.content else {}
    effects = [_effect(text, i, table) for i, table in enumerate(_tables(text, "effect"))]
    try:
        return Scene(links=links, effects=effects, **gravity)
    except ValueError as error:
        raise text.error(_place(str(error)), str(error)) from None


def _tables(text: TomlText, noun: str) -> list[dict[str, Any]]:
    tables = text.value((noun,)) or []
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise text.error((noun,), f"{noun}s are tables [[{noun}]], one for each")
    return [dict(table) for table in tables]


def _effect(text: TomlText, i: int, table: dict[str, Any]) -> Effect:
    place = ("effect", i)
    kind = _kind(text, place, table)
    where = f"effect {i + 1} ({kind}): "
    for parameter in KINDS[kind].description.parameters:
        value = table.get(parameter.name)
        if parameter.part and value is not None and not isinstance(value, dict):
            keys = ", ".join(p.name for p in PARTS[parameter.part].description.parameters)
            complaint = f"{where}{parameter.name} = {value!r}: must be a table with {keys}"
            raise text.error((*place, parameter.name), complaint)
    try:
        return made(KINDS[kind], table, where)
    except (ValueError, TypeError) as error:
        raise text.error(_place(str(error)), str(error)) from None


def _event(text: TomlText, i: int, table: dict[str, Any]) -> Event:
    place = ("event", i)
    kind = _kind(text, place, table)
    for f in fields(EVENT_KINDS[kind]):
        if f.default is MISSING and f.name not in table:
            raise text.error(place, f"event {i + 1} ({kind}) needs {f.name}")
    try:
        return EVENT_KINDS[kind](**table)
    except (ValueError, TypeError) as error:
        complaint = str(error).partition(": ")[2] or str(error)
        key = re.match(r"\w*", complaint)
        at = (*place, key[0]) if key and key[0] in table else place
        raise text.error(at, f"event {i + 1} ({kind}): {complaint}") from None


def _kind(text: TomlText, place: tuple[str, int], table: dict[str, Any]) -> str:
    """Take the kind out of the table of an effect or event, and check its keys."""
    noun, i = place
    keys = EFFECT_KEYS if noun == "effect" else EVENT_KEYS
    kind = table.pop("kind", None)
    if kind is None:
        raise text.error(place, f"{noun} {i + 1} needs kind: {', '.join(keys)}")
    if not isinstance(kind, str) or kind not in keys:
        raise text.error((*place, "kind"), f"kind = {kind!r}: {_remedy(noun, kind, keys)}")
    text.check_keys(place, _ANYWHERE | {noun: keys[kind]})
    return kind


def _remedy(noun: str, kind: object, keys: Iterable[str]) -> str:
    """Return what to write for a kind that cannot stand in a file."""
    if not isinstance(kind, str):
        return f"must be one of {', '.join(keys)}"
    if kind in (KINDS if noun == "effect" else EVENT_KINDS):
        where = "to the scene" if noun == "effect" else "to events"
        return f"is a function, which a file cannot hold: add it {where} in Python"
    return f"is no {noun}: {did_you_mean(kind, keys)}"


def _start(text: TomlText, n: int) -> tuple[Sequence[float], Sequence[float] | float]:
    start = text.table(("start",))
    if ("q" in start) == ("q_deg" in start):
        raise text.error(("start",), "[start] needs q (rad) or q_deg (degrees), one of the two")
    if "q" in start:
        q0 = _per_link(text, "q", n, "rad")
    else:
        q0 = tuple(radians(x) for x in _per_link(text, "q_deg", n, "deg"))
    return q0, _per_link(text, "qd", n, "rad/s") if "qd" in start else 0.0


def _per_link(text: TomlText, key: str, n: int, unit: str) -> tuple[float, ...]:
    place = ("start", key)
    numbers = text.numbers(place)
    try:
        return vector(key, numbers, n, unit)
    except ValueError as error:
        raise text.error(place, str(error)) from None


def _run(text: TomlText) -> tuple[tuple[float, float], dict[str, Any]]:
    run = text.table(("run",))
    if "t_end" not in run:
        raise text.error(("run",), "[run] needs t_end (s)")
    t_start = text.number(("run", "t_start")) if "t_start" in run else 0.0
    options = {key: value for key, value in run.items() if key in RUN_DEFAULTS}
    for key, value in options.items():
        if key == "t_eval" and isinstance(value, dict):
            options[key] = _even_times(text, value)
        elif isinstance(value, list):
            if key not in _OF_TEXTS:
                text.numbers(("run", key))
        elif not isinstance(value, int | float | str):
            raise text.error(("run", key), f"{key} = {value!r}: must be a number, text or a list")
    return (t_start, text.number(("run", "t_end"))), options


def _even_times(text: TomlText, table: dict[str, Any]) -> list[float]:
    """Return the times that ``t_eval = {start = 0.0, stop = 5.0, count = 101}`` stands for."""
    place = ("run", "t_eval")
    if set(table) != {"start", "stop", "count"}:
        raise text.error(place, "t_eval: must be a list, or a table with start, stop (s) and count")
    start, stop = (text.number((*place, key)) for key in ("start", "stop"))
    count = table["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST_TIMES:
        complaint = f"t_eval.count = {count!r}: must be a whole number from 2 to {MOST_TIMES:,}"
        raise text.error(place, complaint)
    times: list[float] = np.linspace(start, stop, count).tolist()
    return times


def _place(message: str) -> Place:
    """Return where in the file stands what the message of a Scene or Case begins with."""
    if found := re.match(r"link (\d+): (\w+)", message):
        return ("link", int(found[1]) - 1, found[2])
    if found := re.match(r"effect (\d+) \(\w+\): ([\w.]+)", message):
        return ("effect", int(found[1]) - 1, *found[2].split("."))
    if found := re.match(r"event (\d+) \([^:]*\): (\w+)", message):
        return ("event", int(found[1]) - 1, found[2])
    if found := re.match(r"\w+", message):
        known: dict[str, Place] = {"t_span": ("run",), "links": ("link", 0)}
        known |= {key: ("run", key) for key in KEYS["run"]}
        return known.get(found[0], (found[0],))
    return ()
