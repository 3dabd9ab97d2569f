"""Checks of the numbers that a user hands over, for everything but a run (the core checks those).

Booleans, strings and complex numbers are a TypeError; a wrong shape, and what is not finite, a
ValueError.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from difflib import SequenceMatcher
from inspect import signature
from math import inf
from numbers import Real
from operator import index
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]

OTHER_NAMES = {
    "t_span": ("t_end", "t_max", "t_stop", "t_final", "duration"),
    "store": ("dense_output",),
}
"""Our names of parameters, and those of other programs for them; `_` may be missing."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the remedy for a name that is not known."""
    names = [*known]
    for meant, others in OTHER_NAMES.items():
        if meant in names and name.replace("_", "") in [x.replace("_", "") for x in others]:
            return f"did you mean {meant!r}?"
    known_ones = f"known are {', '.join(names)}" if names else "there are none"
    near = _nearest(name, names, 0.55)
    return f"did you mean {near!r}?" if near else known_ones


def suggestion(name: object, known: Iterable[str]) -> str:
    """Return the end of a message that has said already what is known; nothing if none is near."""
    near = _nearest(str(name), known, 0.6)
    return f": did you mean {near!r}?" if near else ""


def _nearest(name: str, known: Iterable[str], least: float) -> str:
    """Return the most alike of some names, of equals the first; "" if none is alike enough."""

    def likeness(one: str) -> float:
        return SequenceMatcher(None, one, name).ratio()

    near = max(known, key=likeness, default="")
    return near if likeness(near) >= least else ""


def require_known(owner: str, given: Iterable[str], known: Iterable[str]) -> None:
    """Raise a TypeError for a name that is none of the parameters of its owner."""
    names = [*known]
    for name in given:
        if name not in names:
            raise TypeError(f"{owner} has no parameter {name!r}: {did_you_mean(name, names)}")


def number(name: str, value: object, unit: str) -> float:
    """Return one real number as a float."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} = {value!r}: must be a real number{in_unit(unit)}")
    try:
        return float(value)
    except OverflowError:
        raise _too_large(name, unit) from None


def text(name: str, value: object) -> str:
    """Return a text that files can hold: UTF-8 has no lone surrogates."""
    if not isinstance(value, str):
        raise TypeError(f"{name} = {value!r}: must be a text")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        half = value[error.start]
        raise ValueError(
            f"{name} = {value!r}: holds {half!r}, half a character, which no file in UTF-8 can "
            "hold: leave it out; os.fsencode(x).decode(errors='replace') makes a text of the name "
            "of a file"
        ) from None
    return value


def listed_names(argument: str, given: object, example: str, kind: type = str) -> tuple[Any, ...]:
    """Return what a list of names, or of another kind, holds; a text alone is none."""
    if isinstance(given, Iterable) and not isinstance(given, str):
        names = tuple(str.__str__(x) if isinstance(x, str) else x for x in given)  # no np.str_
        if all(isinstance(name, kind) for name in names):
            return names
    raise TypeError(f'{argument} = {given!r}: must be a list of names, such as ["{example}"]')


def positive(name: str, value: object, unit: str) -> float:
    """Return one real number above 0 as a float."""
    given = number(name, value, unit)
    if not given > 0:
        raise ValueError(f"{name} = {given}: must be > 0{in_unit(unit)}")
    return given


def whole_number(name: str, value: Any, most: int = 2**31 - 1) -> int:
    """Return a whole number up to ``most`` in size as an int."""
    try:
        if isinstance(value, bool | np.bool_):
            raise TypeError
        whole = index(value)
    except TypeError:
        raise TypeError(f"{name} = {value!r}: must be a whole number") from None
    if abs(whole) > most:
        raise ValueError(f"{name}: is too large: must be at most {most}")
    return whole


def at_least(name: str, value: Any, least: int) -> int:
    """Return a whole number from ``least`` on as an int."""
    whole = whole_number(name, value)
    if whole < least:
        raise ValueError(f"{name} = {whole}: must be >= {least}")
    return whole


def flag(name: str, value: object) -> bool:
    """Return a bool of Python or NumPy as one of Python."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} = {value!r}: must be True or False")
    return bool(value)


def function(name: str, value: object) -> object:
    """Return a function of the user's, which takes three arguments."""
    if not callable(value):
        raise TypeError(f"{name} = {value!r}: must be a function of t, q, qd")
    try:
        parameters = signature(value, follow_wrapped=False)
    except (TypeError, ValueError):
        return value  # some functions in C do not tell
    try:
        parameters.bind(None, None, None)
    except TypeError:
        raise TypeError(f"{name} takes {parameters}: must take (t, q, qd)") from None
    return value


def time_span(t_span: Any) -> tuple[float, float]:
    """Return the start and the end of a run, finite, as two floats."""
    try:
        given_start, given_end = t_span
    except (TypeError, ValueError):
        raise no_time_span(t_span) from None
    try:
        t_start, t_end = (number("t_span", t, "s") for t in (given_start, given_end))
    except TypeError:
        raise no_time_span(t_span) from None
    for i, t in enumerate((t_start, t_end)):
        if not np.isfinite(t):
            raise ValueError(f"t_span[{i}] = {t}: must be finite (s)")
    if not np.isfinite(length := t_end - t_start):
        raise ValueError(f"t_span = {t_span!r}: is {length} s long: must be below 1.8e308 (s)")
    return t_start, t_end


def no_time_span(t_span: object) -> TypeError:
    """Return the error that says what a span is."""
    return TypeError(f"t_span = {t_span!r}: must be (t_start, t_end), in s")


def time_limit_of(time_limit: object) -> float:
    """Return how long something may take, s of the clock; inf for None."""
    if time_limit is None:
        return inf
    return positive("time_limit", time_limit, "s")


def in_unit(unit: str) -> str:
    """Return how a message gives the unit, if there is one."""
    return f" ({unit})" if unit not in ("", "1") else ""


def finite_array(name: str, value: npt.ArrayLike, unit: str) -> Floats:
    """Return finite real numbers of any shape as an array of floats."""
    array = real_array(name, value, unit)
    if not np.isfinite(array).all():
        where = np.argwhere(~np.isfinite(array))[0]
        place = "".join(f"[{i}]" for i in where)
        raise ValueError(f"{name}{place} = {array[tuple(where)]}: must be finite{in_unit(unit)}")
    return array


def moments(t: npt.ArrayLike) -> Floats:
    """Return one time, (), or several, (k,), s."""
    times = finite_array("t", t, "s")
    if times.ndim > 1:
        raise ValueError(f"t: shape {times.shape}: must be a number or (k,) (s)")
    return times


def real_array(name: str, value: npt.ArrayLike, unit: str) -> Floats:
    """Return real numbers of any shape, infinite ones too, as an array of floats."""
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
    except ValueError:
        told = f"{name}: rows of different lengths: must be an array{in_unit(unit)}"
        raise ValueError(told) from None
    if array.dtype.kind == "O" and all(type(x) is int for x in array.flat):
        try:  # integers beyond 64 bits
            array = array.astype(np.float64)
        except OverflowError:
            raise _too_large(name, unit) from None
    if array.dtype.kind not in "iuf":
        held = {"U": "text", "O": "objects", "b": "truth values"}.get(array.dtype.kind, array.dtype)
        raise TypeError(f"{name}: holds {held}: must hold real numbers{in_unit(unit)}")
    return array.astype(np.float64, copy=False)


def refuse_masked(name: str, value: Any, depth: int = 2) -> None:
    """Refuse an array with masked values, and lists with such arrays: NumPy forgets the masks."""
    if "numpy.ma" not in sys.modules:  # nobody has made one
        return
    if isinstance(value, list | tuple):
        for one in value if depth else ():  # a list may hold itself
            if isinstance(one, list | tuple | np.ndarray):
                refuse_masked(name, one, depth - 1)
    elif np.ma.is_masked(value):
        raise ValueError(
            f"{name}: has masked values: must have a number everywhere: x.compressed() leaves "
            "masked ones out, x.filled(...) replaces them"
        )


def numbers(
    name: str, value: Any, unit: str, count: int | None = None, finite: bool = True
) -> tuple[float, ...]:
    """Return numbers along one axis, as many as they are or ``count``."""
    array = finite_array(name, value, unit) if finite else real_array(name, value, unit)
    if array.ndim != 1 or count not in (None, len(array)):
        wanted = "(k,)" if count is None else f"({count},), {count} numbers"
        raise ValueError(f"{name}: shape {array.shape}: must be {wanted}{in_unit(unit)}")
    return tuple(array.tolist())


def vector(name: str, value: npt.ArrayLike, count: int, unit: str) -> tuple[float, ...]:
    """Return as many finite numbers; a scalar holds for each of them."""
    array = finite_array(name, value, unit)
    if array.ndim == 0:
        array = np.full(count, array)
    if array.shape != (count,):
        raise ValueError(f"{name}: shape {array.shape}: must be ({count},){in_unit(unit)}")
    return tuple(array.tolist())


def link_array(name: str, value: npt.ArrayLike, n: int, unit: str) -> Floats:
    """Return an array whose last axis runs over the n links."""
    array = finite_array(name, value, unit)
    if array.ndim == 0 or array.shape[-1] != n:
        wanted = f"must be (..., {n}), one value per link ({unit})"
        raise ValueError(f"{name}: shape {array.shape}: {wanted}")
    return array


def listed(values: Sequence[float] | Floats, most: int = 6) -> str:
    """Return numbers as people read them: six digits, and dots in place of the last of many."""
    some = [f"{x:.6g}" for x in values[:most]]
    return ", ".join([*some, "..."] if len(values) > most else some)


def in_a_row(words: Iterable[str], before_last: str = "and") -> str:
    """Return ``a``, ``a and b``, ``a, b and c``."""
    *most, last = words
    return f"{', '.join(most)} {before_last} {last}" if most else last


def _too_large(name: str, unit: str) -> ValueError:
    return ValueError(f"{name}: is too large: must be below 1.8e308{in_unit(unit)}")
