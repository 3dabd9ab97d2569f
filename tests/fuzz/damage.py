"""Damage to what is read: case files, archives, the state dictionaries of pickles.

Each function makes one or a few mistakes, chosen by `fuzz.choices`. Arbitrary bytes of pickles are
not among them: a pickle runs what it says by design.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fuzz.choices import Choices, happens

TOKENS = (
    "nan", "inf", "-inf", "-1", "0", "-0.0", "1e308", "5e-324", "1e400", "9" * 400, "0x7fff",
    "true", '"text"', "''", "[]", "[[]]", "{}", "[1, [2]]", "[1.0, \"a\"]", "1979-05-27",
    "07:32:00", "{ t = [0, 1], torque = [1, 2] }", "[nan, inf]", "[1e300, 1e300]", "10000000",
    '"dopri5"', '"\\u0000"', '"""\n\n"""', "[0, 0, 0]", "2", "1.5", "-9223372036854775809",
)  # fmt: skip
"""What stands for a value in a damaged case file."""

LINES = (
    "[[link]]", "[link]", "[[effect]]", "[start]", "[run]", "mass = 1", "q = 1", "t_end = 1",
    'kind = "lock"', 'kind = "motor"', "joint = 1", "joint = 99", "= 3", "[[", "\x00", "#", '"""',
    "start.q = 2", "run = 5", "link = 3", "effect = [1]", 'name = ["x"]', "ledger = 1", "[a.b.c]",
    "store = \"times\"", "t_eval = [0.5]", "max_steps = 0", "first_step = 1e-3", "constant = 1",
    3000 * " ", "x = " + 2000 * "[", 5000 * "a." + "b = 1", 2000 * '"""\\', 2000 * "'",
    "t_eval = {start = 0, stop = 5, count = 10000000}",
)  # fmt: skip

VALUES = (
    None, True, 0, -1, 1, 3, 2**31, 2**62, -(2**63), 10**30, 0.5, -1.5, float("nan"),
    float("inf"), 1e308, "", "text", "dense", "max_steps", b"bytes", [], [1.0], {}, (1, 2), 1j,
)  # fmt: skip


def text(choices: Choices, whole: str) -> str:
    """Return a text in lines with some mistakes in it."""
    lines = whole.split("\n")
    for _ in range(choices.integer(1, 4)):
        i = choices.integer(0, len(lines) - 1)
        how = choices.integer(0, 6)
        if how <= 1:
            lines[i] = re.sub(r"=.*", lambda _: f"= {choices.one_of(TOKENS)}", lines[i])
        elif how == 2:
            del lines[i]
        elif how == 3:
            lines.insert(i, lines[choices.integer(0, len(lines) - 1)])
        elif how == 4:
            lines.insert(i, choices.one_of(LINES))
        elif how == 5:
            at = choices.integer(0, len(lines[i]))
            lines[i] = lines[i][:at] + chr(choices.integer(0, 0x2FF)) + lines[i][at + 1 :]
        else:
            del lines[i:]
        lines = lines or [""]
    return "\n".join(lines)


def raw(choices: Choices, whole: bytes) -> bytes:
    """Return bytes with some of them changed, left out or doubled."""
    data = bytearray(whole)
    for _ in range(choices.integer(1, 6)):
        at = choices.integer(0, max(len(data) - 1, 0))
        how = choices.integer(0, 4)
        if how <= 2 and data:
            data[at] = choices.integer(0, 255)
        elif how == 3:
            del data[at : at + choices.integer(1, 64)]
        else:
            data[at:at] = data[at : at + choices.integer(1, 64)]
    return bytes(data)


def value(choices: Choices, whole: Any) -> Any:
    """Return something in place of a value of a state."""
    if isinstance(whole, np.ndarray) and whole.ndim and happens(choices, 80):
        return _array(choices, whole)
    if isinstance(whole, str) and len(whole) > 20 and happens(choices, 70):
        return text(choices, whole)
    return choices.one_of(VALUES)


def _array(choices: Choices, whole: np.ndarray) -> Any:
    how = choices.integer(0, 8)
    if how <= 3 and whole.size and whole.dtype.kind == "f":
        changed = whole.copy()
        at = choices.integer(0, whole.size - 1)
        changed.flat[at] = choices.one_of(
            (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 5e-324, 2.5, 1e9, -3.0)
        )
        return changed
    if how == 4:
        return whole[: choices.integer(0, len(whole))]
    if how == 5:
        return np.concatenate([whole, whole[: choices.integer(0, len(whole))]])
    if how == 6:
        return whole.astype(choices.one_of((np.float32, np.int64, np.complex128, object, "U8")))
    return whole[::-1] if how == 7 else whole[np.newaxis]


def entries(
    choices: Choices, whole: Mapping[str, Any], changed: Callable[[str, int], Any]
) -> dict[str, Any]:
    """Return entries with some changed, left out, or taken from one another."""
    damaged = dict(whole)
    for _ in range(choices.integer(1, 3)):
        key = choices.one_of(sorted(whole))
        how = choices.integer(0, 9)
        if how == 0:
            damaged.pop(key, None)
        elif how == 1:
            damaged[key] = whole[choices.one_of(sorted(whole))]
        else:
            damaged[key] = changed(key, how)
    return damaged


def state(choices: Choices, whole: Mapping[str, Any]) -> dict[str, Any]:
    """Return a damaged state of a pickle."""
    return entries(choices, whole, lambda key, _: value(choices, whole[key]))


def _json(choices: Choices, whole: Any) -> Any:
    """Return JSON with one value replaced, or left out, at any depth."""
    if isinstance(whole, dict | list) and whole and happens(choices, 80):
        keys = sorted(whole) if isinstance(whole, dict) else list(range(len(whole)))
        key = choices.one_of(keys)
        changed = whole.copy()
        if happens(choices, 10):
            del changed[key]
        else:
            changed[key] = _json(choices, whole[key])
        return changed
    if isinstance(whole, str) and len(whole) > 20 and happens(choices, 70):
        return text(choices, whole)
    return choices.one_of([one for one in VALUES if not isinstance(one, bytes | complex)])


def folder(choices: Choices, whole: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the damaged files of a store."""

    def changed(name: str, how: int) -> bytes:
        if name.endswith(".json") and how < 9:
            return json.dumps(_json(choices, json.loads(whole[name]))).encode()
        return raw(choices, whole[name])

    return entries(choices, whole, changed)


def archive(choices: Choices, whole: bytes) -> bytes:
    """Return an npz file with bytes damaged, or with entries that are whole and wrong."""
    if happens(choices, 30):
        return raw(choices, whole)
    with np.load(io.BytesIO(whole)) as file:
        entries = {k: (v.item() if v.ndim == 0 else v) for k, v in file.items()}
    entries = {k: v for k, v in state(choices, entries).items() if v is not None}
    file = io.BytesIO()
    np.savez(file, **entries)
    return file.getvalue()
