"""A case: a scene, where it starts, how it is run. It can be written as TOML."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import partial
from math import pi
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore._messages.arguments import numbers, text, vector
from pendcore._run.solution import Solution
from pendcore._scene.effect_class import Part
from pendcore._scene.parametrized import OfFunction
from pendcore._scene.scene import Scene
from pendcore.events import Event, events_asked_for
from pendcore.options import RUN_DEFAULTS, OnFailure


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Case:
    """A scene with its start, its time span and the options of its run; immutable and hashable.

    Parameters
    ----------
    scene : Scene
        What moves.
    q0 : array_like, (n,)
        Absolute angles at the start, rad. A scalar holds for every link.
    qd0 : array_like, (n,), default 0
        Rates at the start, rad/s. A scalar holds for every link.
    t_span : (float, float)
        Start and end, s.
    name : str
        A name for people.
    options : mapping
        Keywords of `simulate`; missing ones have its defaults. Kept as a read-only mapping.

    Raises
    ------
    ValueError, TypeError
        If q0, qd0 or t_span are not finite numbers of that shape, or an option is unknown.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> case = pc.Case(scene=scene, q0=0.5, t_span=(0, 5), options={"rtol": 1e-12})
    >>> case.q0, case.simulate().success
    ((0.5, 0.5), True)
    >>> pc.read_case(case.to_toml()) == case
    True
    """

    scene: Scene
    q0: tuple[float, ...]
    qd0: tuple[float, ...]
    t_span: tuple[float, float]
    name: str
    options: Mapping[str, Any]

    def __init__(
        self,
        *,
        scene: Scene,
        q0: npt.ArrayLike,
        qd0: npt.ArrayLike = 0.0,
        t_span: npt.ArrayLike,
        name: str = "",
        options: Mapping[str, Any] | None = None,
    ) -> None:
        n = len(scene.links)
        given = {key: _plain(value) for key, value in (options or {}).items() if value is not None}
        for key in given:
            if key not in RUN_DEFAULTS:
                known = ", ".join(RUN_DEFAULTS)
                raise TypeError(f"options: simulate() has no keyword {key!r}: known are {known}")
        if "events" in given:
            given["events"] = events_asked_for(given["events"])
        object.__setattr__(self, "scene", scene)
        object.__setattr__(self, "q0", vector("q0", q0, n, "rad"))
        object.__setattr__(self, "qd0", vector("qd0", qd0, n, "rad/s"))
        object.__setattr__(self, "t_span", numbers("t_span", t_span, "s", 2))
        object.__setattr__(self, "name", text("name", name))
        object.__setattr__(self, "options", MappingProxyType(given))

    @classmethod
    def textbook(cls) -> Case:
        """Section 2.1 of the textbook: from rest at 45 and 60 degrees, for 5 s, by ode45.

        Examples
        --------
        >>> case = pc.Case.textbook()
        >>> np.degrees(case.q0).round(6), case.t_span
        (array([45., 60.]), (0.0, 5.0))
        """
        return cls(
            name="double pendulum, section 2.1",
            scene=Scene.textbook(),
            q0=(pi / 4, pi / 3),
            t_span=(0.0, 5.0),
            options={"method": "ode45"},
        )

    def simulate(self, *, on_failure: OnFailure | None = None) -> Solution:
        """Run the case; see `pendcore.simulate`. The solution has the name of the case.

        If ``on_failure`` is given, it replaces that of the case.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.name
        'double pendulum, section 2.1'
        """
        from pendcore._api.simulate import simulate
        from pendcore._run.run_error import require_on_failure

        options = dict(self.options)
        require_on_failure(options.get("on_failure", "warn"))
        if on_failure is not None:
            options["on_failure"] = on_failure
        try:
            solution = simulate(self.scene, self.t_span, self.q0, self.qd0, **options)
        except BaseException as stop:
            if isinstance(so_far := getattr(stop, "solution", None), Solution):
                so_far.name = self.name
            raise
        solution.name = self.name
        return solution

    def to_toml(self) -> str:
        """Return the case as TOML; `pendcore.read_case` makes an equal one of it, to the last bit.

        Raises
        ------
        TypeError
            If an option, an effect or an event is a function, which TOML cannot hold.

        Examples
        --------
        >>> for line in pc.Case.textbook().to_toml().splitlines()[-4:]:
        ...     print(line)
        [run]
        t_start = 0.0
        t_end = 5.0
        method = "ode45"
        """
        t_start, t_end = self.t_span
        options = dict(self.options)
        events = options.pop("events", ())
        refuse_functions(self.scene, events, "written as TOML")
        tables: list[tuple[str, dict[str, Any]]] = [
            ("", {"name": self.name, "gravity": self.scene.gravity}),
            *(("[[link]]\n", link.particulars()) for link in self.scene.links),
            *(("[[effect]]\n", {"kind": x.kind, **x.particulars()}) for x in self.scene.effects),
            *(("[[event]]\n", {"kind": x.kind, **x.particulars()}) for x in events),
            ("[start]\n", {"q": self.q0, "qd": self.qd0}),
            ("[run]\n", {"t_start": t_start, "t_end": t_end, **options}),
        ]
        return "\n".join(
            header + "".join(f"{key} = {_toml(key, x)}\n" for key, x in table.items())
            for header, table in tables
        )

    def _values(self) -> dict[str, Any]:
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return values | {"options": dict(self.options)}

    def __repr__(self) -> str:
        return f"Case({', '.join(f'{name}={x!r}' for name, x in self._values().items())})"

    def __hash__(self) -> int:
        return hash(tuple((self._values() | {"options": frozenset(self.options.items())}).values()))

    def __reduce__(self) -> tuple[object, ...]:
        # A read-only mapping does not pickle, so the case is made anew.
        return partial(type(self), **self._values()), ()


def refuse_functions(scene: Scene, events: Iterable[Event], done: str, remedy: str = "") -> None:
    """Raise a TypeError for an effect or an event that is a function: it cannot be ``done``."""
    for one in (*scene.effects, *events):
        if isinstance(one, OfFunction):
            raise one.cannot_be(done, remedy)


def _plain(value: Any) -> Any:
    """Return NumPy's numbers and arrays as Python's own, lists as tuples."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        return value
    if {*map(type, value)} <= {float, int}:  # as of a million times
        return tuple(value)
    return tuple(map(_plain, value))


def _toml(key: str, value: Any) -> str:
    if isinstance(value, Part):
        pairs = (f"{name} = {_toml(name, x)}" for name, x in value.particulars().items())
        return f"{{{', '.join(pairs)}}}"
    if isinstance(value, tuple):
        return f"[{', '.join(_toml(key, x) for x in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for the surrogate pairs that ensure_ascii would make.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    raise TypeError(f"{key} = {value!r}: cannot be written as TOML; leave it out of the case")


def case_of(solution: Solution) -> Case:
    """Return what was asked for when a solution was computed."""
    asked = {key: _plain(value) for key, value in solution._run.arguments.items()}
    start = {key: asked.pop(key) for key in ("q0", "qd0")}
    t_span = (asked.pop("t_start"), asked.pop("t_end"))
    asked["events"] = tuple(solution.events_asked_for())
    asked["sensitivities"] = solution.sensitivity_names or None
    options = {key: value for key, value in asked.items() if value != RUN_DEFAULTS[key]}
    return Case(scene=solution.scene, **start, t_span=t_span, name=solution.name, options=options)
