"""The request that every member of an ensemble gets, and the arrays that answer it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import Floats
from pendcore._scene.scene import Scene
from pendcore.events import Event
from pendcore.reducers import FirstEvent, Reducer, Sensitivities

NOT_RUN: int = _core.member_statuses.index("not_run")
OPTIONS = {"method", "rtol", "atol", "events", "max_steps", "max_step"}
"""The options of `simulate` that every member is given."""


class Variable(NamedTuple):
    """An array of a result, whose first axes are those of the members."""

    name: str
    labels: dict[str, Any]
    """Its further axes, with the labels along each."""
    unit: str
    dtype: type = np.float64
    fill: Any = np.nan
    """What it has for a member that was not run."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The lengths of its further axes."""
        return tuple(len(one) for one in self.labels.values())

    @property
    def bytes_a_member(self) -> int:
        """The memory that a member takes."""
        return int(np.prod(self.shape, dtype=np.int64)) * np.dtype(self.dtype).itemsize

    def empty(self, shape: tuple[int, ...]) -> npt.NDArray[Any]:
        """Return the array for members of a shape that were not run."""
        return np.full((*shape, *self.shape), self.fill, self.dtype)


@dataclass(frozen=True, slots=True)
class Request:
    """The interval, the options and the results that every member is asked for."""

    t_span: tuple[float, float]
    """s."""
    t_eval: Floats | None
    """The times at which states are kept, s, (n_t,); None: at the end."""
    reducers: dict[str, Reducer]
    """By their names."""
    options: dict[str, Any]
    """Those in ``OPTIONS``."""

    @property
    def events(self) -> tuple[Event, ...]:
        """All events: those asked for, then those of the reducers."""
        own = (x.event for x in self.reducers.values() if isinstance(x, FirstEvent))
        return (*self.options["events"], *own)

    @property
    def sensitivity_names(self) -> tuple[str, ...]:
        """The names of all derivatives that are kept."""
        own = (x.names for x in self.reducers.values() if isinstance(x, Sensitivities))
        return tuple(next(own, ()))

    def event_number(self, name: str) -> int:
        """Return the number of a reducer's event among all events."""
        before = list(self.reducers.values())[: list(self.reducers).index(name)]
        return len(self.options["events"]) + sum(isinstance(x, FirstEvent) for x in before)

    def with_options(self, **options: Any) -> Request:
        """Return the same with some options replaced."""
        return replace(self, options=self.options | options)

    def of_simulate(self) -> dict[str, Any]:
        """Return the keywords with which `simulate` makes a member's run."""
        return self.options | {"events": self.events}

    def variables(self, n: int) -> list[Variable]:
        """Return the arrays of the result for n links."""
        links: dict[str, Any] = {"link": range(1, n + 1)}
        of_state = links if self.t_eval is None else {"time": self.t_eval, **links}
        return [
            Variable("status", {}, "", np.uint8, NOT_RUN),
            Variable("t_reached", {}, "s"),
            Variable("q", of_state, "rad"),
            Variable("qd", of_state, "rad/s"),
            *(Variable(name, x.labels(n), x.unit) for name, x in self.reducers.items()),
        ]

    def empty(self, shape: tuple[int, ...], n: int) -> dict[str, Any]:
        """Return these arrays for members of a shape that were not run."""
        return {one.name: one.empty(shape) for one in self.variables(n)}

    def check_reducers(self, scene: Scene) -> None:
        """Raise an error for what a reducer cannot be used with."""
        for name in ("rtol", "atol"):
            for one in self.reducers.values():
                if one.needs_one_tolerance and np.ndim(self.options[name]) > 0:
                    known = f"pc.reducers.{type(one).__name__}()"
                    raise TypeError(f"{name}: must be one number with {known}")
        if len({x for x in self.reducers.values() if isinstance(x, Sensitivities)}) > 1:
            raise ValueError("keep: has pc.reducers.Sensitivities twice: give one with all names")
        if self.sensitivity_names:  # of which the core knows those of the scene
            _core.Sensitivities(scene._compiled, [*self.sensitivity_names])
