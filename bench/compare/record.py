"""The record of a comparison: one table in long form, and where and when it was measured.

A row has a contender, a case and a setting, and then the value of each metric, null where there is
none. Facts of contenders (label, version) and of cases stand once; so does the machine.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

KEYS = ("contender", "case", "setting")
ONE_STEP = "one step"
"""The setting of the call whose interval one step covers."""

Point = dict[str, Any]
"""The values of a row by metric, without nulls, and its setting."""


class Record:
    """What JSON holds: `measured`, `contenders` and `cases` by name, `metrics`, `rows`."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.data = data
        self.measured: dict[str, Any] = data["measured"]
        self.contenders: dict[str, Any] = data["contenders"]
        self.cases: dict[str, Any] = data["cases"]
        self._points: dict[tuple[str, str], list[Point]] = {}
        for contender, case, setting, *values in data["rows"]:
            named = zip(data["metrics"], values, strict=False)
            point = {"setting": setting, **{key: x for key, x in named if x is not None}}
            self._points.setdefault((contender, case), []).append(point)

    @classmethod
    def read(cls, path: Path) -> Record:
        return cls(json.loads(path.read_text(encoding="utf-8")))

    @classmethod
    def of(
        cls,
        measured: Mapping[str, Any],
        contenders: Mapping[str, Any],
        cases: Mapping[str, Any],
        rows: Iterable[Point],
    ) -> Record:
        """Make a record of rows that name contender, case, setting, and any metrics."""
        listed = list(rows)
        metrics = list(dict.fromkeys(key for row in listed for key in row if key not in KEYS))
        table = [[row.get(key) for key in (*KEYS, *metrics)] for row in listed]
        data = {"measured": measured, "contenders": contenders, "cases": cases}
        return cls({**data, "metrics": metrics, "rows": table})

    def write(self, path: Path) -> None:
        """Write a row a line, numbers in nine digits, without the nulls at the end of a row."""
        heads = [
            f"{json.dumps(key)}: {json.dumps(_rounded(value))}"
            for key, value in self.data.items()
            if key != "rows"
        ]
        rows = ",\n".join(json.dumps(_rounded(_stripped(row))) for row in self.data["rows"])
        path.parent.mkdir(parents=True, exist_ok=True)
        text = ",\n".join(heads) + f',\n"rows": [\n{rows}\n]'
        path.write_text("{" + text + "}\n", encoding="utf-8")

    def rows(self) -> list[Point]:
        """List the rows as `of` takes them."""
        keys = (*KEYS, *self.data["metrics"])
        return [dict(zip(keys, row, strict=False)) for row in self.data["rows"]]

    def points(self, contender: str, case: str) -> list[Point]:
        """List the rows of a contender on a case, in their order."""
        return self._points.get((contender, case), [])

    def taking_part(self, case: str = "") -> list[dict[str, Any]]:
        """List contenders that have rows on a case: facts, name, points, the call of one step.

        The case need not be named where it is the only one.
        """
        found = []
        case = case or next(iter(self.cases), "")
        for name, facts in self.contenders.items():
            rows = self.points(name, case)
            points = [row for row in rows if row["setting"] != ONE_STEP]
            if rows:
                one_step = next((row for row in rows if row["setting"] == ONE_STEP), None)
                found.append({**facts, "name": name, "points": points, "one_step": one_step})
        return found


def _stripped(row: list[Any]) -> list[Any]:
    while row and row[-1] is None:
        row = row[:-1]
    return row


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.9g}")
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, (list, tuple)) else value
