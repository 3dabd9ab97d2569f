"""TOML that knows on which line each key stands, so that an error can say where."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeAlias

from pendcore._messages.arguments import did_you_mean

Place: TypeAlias = tuple[str | int, ...]
"""Way to a key: ``("link", 1, "mass")`` is the mass in the second ``[[link]]``."""

MOST_NESTED = 32
"""Arrays and tables within one another, and names in a dotted key. A case needs four; the parser
takes the square of the names in time, and one level of Python's stack or more for each array."""

_STRING_OR_COMMENT = re.compile(
    r'"""(?:\\.|[^"\\]|"{1,2}(?!"))*+(?:"{3,5}|\Z)'
    r"|'{3}.*?(?:'{3,5}|\Z)"
    r'|"(?:\\.|[^"\\\n])*+"?'
    r"|'[^'\n]*'?"
    r"|#[^\n]*",
    re.DOTALL,
)
"""Where one does not end, it takes the rest: what is no TOML is scanned once as well. The groups
are possessive: one that may be entered anew keeps a hundred bytes for each character."""
_HEADER = re.compile(r"\s*\[(\[?)([^\[\]]+)\]")
_STRUCTURE = re.compile(r"([\[\]{},=])")


class TomlText:
    """A TOML document: its content, and errors that name document and line.

    Messages call it by its name. A text that is not TOML, or nested too deeply, is a ValueError.
    """

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        self._hushed = _STRING_OR_COMMENT.sub(_hushed, text).split("\n")
        self._require_flat()
        try:
            self.content: dict[str, Any] = tomllib.loads(text)
        except ValueError as error:  # TOMLDecodeError, and an integer of too many digits
            twice = "twice" in str(error) and "[" in text
            remedy = ": a table that is there more than once is [[link]], in two brackets"
            raise ValueError(f"{name}: {error}{remedy if twice else ''}") from None

    def error(self, place: Place, complaint: str) -> ValueError:
        """Return an error that names the line of the place, or of the table that holds it."""
        lines = dict(_lines_of_keys(self._hushed))
        for length in range(len(place), 0, -1):
            if place[:length] in lines:
                return ValueError(f"{self.name}, line {lines[place[:length]]}: {complaint}")
        return ValueError(f"{self.name}: {complaint}")

    def _require_flat(self) -> None:
        depth = 0
        for number, line in enumerate(self._hushed, start=1):
            for piece in _STRUCTURE.split(line):
                depth += (piece in ("[", "{")) - (piece in ("]", "}"))
                if max(depth, piece.count(".") + 1) > MOST_NESTED:
                    raise ValueError(
                        f"{self.name}, line {number}: is nested too deeply: at most {MOST_NESTED} "
                        "arrays, tables or names within one another"
                    )

    def check_keys(self, place: Place, known: Mapping[str, Iterable[str]]) -> None:
        """Refuse the first unknown key of a table, and name the nearest known one.

        ``known`` has the keys of every kind of table, so that a key in a wrong table is told where
        it belongs.
        """
        kind = str(place[0]) if place else ""
        here = tuple(known[kind])
        for key in self.table(place):
            if key in here:
                continue
            home = next((other for other, keys in known.items() if key in keys), None)
            remedy = did_you_mean(key, here)
            if home is not None:
                remedy = f"it belongs {f'in [{home}]' if home else 'above all tables'}"
            where = f" in [{kind}]" if kind else ""
            raise self.error((*place, key), f"unknown key {key!r}{where}: {remedy}")

    def value(self, place: Place) -> Any:
        """Return the value at a place; None if there is none."""
        found: Any = self.content
        for step in place:
            found = found.get(step) if isinstance(step, str) else found[step]
        return found

    def table(self, place: Place) -> dict[str, Any]:
        """Return the table at a place; empty if there is none."""
        table = self.value(place)
        if table is None:
            return {}
        if not isinstance(table, dict):
            raise self.error(place, f"{place[0]} = {table!r}: must be a table")
        return table

    def number(self, place: Place) -> float:
        """Return the number at a place."""
        return self._floats(place, [self.value(place)], "must be a number")[0]

    def numbers(self, place: Place) -> float | list[float]:
        """Return the number, or the list of numbers, at a place."""
        value, wanted = self.value(place), "must be a number or a list of numbers"
        if isinstance(value, list):
            return self._floats(place, value, wanted)
        return self._floats(place, [value], wanted)[0]

    def _floats(self, place: Place, given: list[Any], wanted: str) -> list[float]:
        if not all(isinstance(x, int | float) and not isinstance(x, bool) for x in given):
            raise self.error(place, f"{place[-1]} = {self.value(place)!r}: {wanted}")
        try:
            return [float(x) for x in given]
        except OverflowError:
            raise self.error(place, f"{place[-1]}: is too large: must be below 1.8e308") from None


def _lines_of_keys(hushed: list[str]) -> Iterator[tuple[Place, int]]:
    tables: Place = ()
    last: dict[tuple[str, ...], int] = {}  # of the tables [[name]], the index of the last one
    depth = 0
    for number, line in enumerate(hushed, start=1):
        if depth == 0 and (header := _HEADER.match(line)):
            names = _split(header[2])
            if header[1]:
                last[names] = last.get(names, -1) + 1
            tables = _with_indices(names, last)
            yield tables, number
        elif depth == 0 and "=" in line:
            names = _split(line.partition("=")[0])
            for length in range(len(names)):
                yield (*tables, *names[: length + 1]), number
        depth += line.count("[") + line.count("{") - line.count("]") - line.count("}")


def _hushed(match: re.Match[str]) -> str:
    """Keep the lines of a string or comment, and nothing in it that looks like structure."""
    found = match[0]
    if found.startswith(("#", '"""', "'''")):
        return "\n" * found.count("\n")
    return re.sub(r"[\[\]{},=.]", "_", found)


def _split(dotted: str) -> tuple[str, ...]:
    return tuple(name.strip().strip("\"'") for name in dotted.split("."))


def _with_indices(names: tuple[str, ...], last: Mapping[tuple[str, ...], int]) -> Place:
    place: list[str | int] = []
    for length, name in enumerate(names, start=1):
        place.append(name)
        if names[:length] in last:
            place.append(last[names[:length]])
    return tuple(place)
