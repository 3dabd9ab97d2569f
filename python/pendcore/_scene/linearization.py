"""The motion close to a state as a linear system: what `Scene.linearize` returns."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from pendcore import _core
from pendcore._messages.arguments import (
    Floats,
    listed_names,
    positive,
    suggestion,
    whole_number,
)

_TORQUE = re.compile(r"torque\[(\d+)\]")
_START = re.compile(r"qd?0?\[\d+\]")


@dataclass(slots=True, eq=False, repr=False)
class Linearization:
    """The motion close to a state ``x_0 = (q, qd)``, as a linear system.

        dx/dt = drift + A (x - x_0) + B u        y - y_0 = C (x - x_0) + D u

    Attributes
    ----------
    A : ndarray, (2n, 2n)
        Exact to rounding, as `Scene.jacobian` is.
    B : ndarray, (2n, k)
        A column for each input.
    C : ndarray, (m, 2n)
        A row for each output.
    D : ndarray, (m, k)
    drift : ndarray, (2n,)
        dx/dt at the state without input: zero at an equilibrium.
    outputs_there : ndarray, (m,)
        ``y_0``.
    x : ndarray, (2n,)
        The state ``x_0``: angles, rad, and rates, rad/s.
    inputs, outputs : tuple of str
        Names: ``"torque[1]"``, ``"q[2]"``.
    dt : float or None
        The step, s, of a system in discrete time (`discretize`), whose ``A`` and ``B`` lead from
        one time to the next: ``x' - x_0 = drift + A (x - x_0) + B u``.

    Examples
    --------
    >>> pc.Scene.textbook().linearize([-np.pi / 2, -np.pi / 2], inputs=[1], outputs=["x[2]"])
    <Linearization, continuous time: inputs torque[1]; outputs x[2]>
    """

    A: Floats
    B: Floats
    C: Floats
    D: Floats
    drift: Floats
    outputs_there: Floats
    x: Floats
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dt: float | None = None

    def __repr__(self) -> str:
        time = "continuous time" if self.dt is None else f"steps of {self.dt:g} s"
        named = f"inputs {', '.join(self.inputs) or 'none'}; outputs {', '.join(self.outputs)}"
        return f"<Linearization, {time}: {named}>"

    def discretize(self, dt: float) -> Linearization:
        """Return the system that leads from one time to the next, with inputs held in between.

        It is the exact solution of the linear system, by the exponential of its matrix, and not a
        step of some method.

        Parameters
        ----------
        dt : float
            The time, s, from one to the next; > 0.

        Raises
        ------
        ValueError
            If ``dt`` is out of its range, or if the system is discrete.

        Notes
        -----
        Source: Van Loan, IEEE Trans. Automatic Control 23 (1978) 395; the exponential is Eigen's.

        Examples
        --------
        >>> upright = pc.Scene.textbook().linearize([-np.pi / 2, -np.pi / 2], inputs=[1])
        >>> every_10_ms = upright.discretize(0.01)
        >>> every_10_ms.B[:, 0].round(6)
        array([ 8.6000e-05, -1.2900e-04,  1.7160e-02, -2.5749e-02])
        """
        step = positive("dt", dt, "s")
        if not np.isfinite(step):
            raise ValueError(f"dt = {dt}: must be finite (s)")
        if self.dt is not None:
            raise ValueError(f"dt = {dt}: the system is discrete, with a step of {self.dt} s")
        n, k = self.B.shape
        both = np.zeros((n + k + 1, n + k + 1))
        both[:n] = np.hstack([self.A, self.B, self.drift[:, np.newaxis]])
        led = _core.matrix_exponential(both * step)
        if not np.all(np.isfinite(led)):
            raise ValueError(f"dt = {dt}: in this time the system grows beyond all numbers")
        A, B, drift = np.split(led[:n], [n, n + k], axis=1)
        return replace(self, A=A, B=B, drift=drift[:, 0], dt=step)

    def to_control(self) -> Any:
        """Return the system as a ``control.StateSpace`` of python-control, with the names.

        It has no place for the `drift`, so a state that moves is refused.

        Raises
        ------
        ImportError
            If python-control is not installed.
        ValueError
            If the state is no equilibrium.
        """
        import control

        still = 1e-9 * max(1.0, float(np.abs(self.A).max()))
        if np.any(np.abs(self.drift) > still * (1.0 if self.dt is None else self.dt)):
            raise ValueError(
                f"drift = {self.drift}: the state moves, and python-control's systems rest at 0: "
                "give the torques that hold it (linearize(..., torques=scene.trim(...))), or take "
                "an equilibrium, as scene.explain(q=...) finds them"
            )
        n = self.x.size // 2
        states = [f"{kind}[{i}]" for kind in ("q", "qd") for i in range(1, n + 1)]
        names = {"inputs": list(self.inputs), "outputs": list(self.outputs), "states": states}
        time = {} if self.dt is None else {"dt": self.dt}
        return control.ss(self.A, self.B, self.C, self.D, **time, **names)


def different_names(argument: str, given: object) -> tuple[Any, ...]:
    """Return what a list of names holds, in which none stands twice."""
    example = "torque[1]" if argument == "inputs" else "qd[1]"
    names = listed_names(argument, given, example, object)
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{argument}: {name!r} stands twice")
    return names


def known_inputs(inputs: Iterable[int | str]) -> tuple[tuple[int | str, ...], tuple[str, ...]]:
    """Return inputs as the core takes them, a torque by its joint, and their names."""
    given = tuple(inputs) if isinstance(inputs, list | tuple) else different_names("inputs", inputs)
    for one in given:
        if type(one) is not int and type(one) is not str:  # a cache takes True and 1.0 for 1
            return _known_inputs.__wrapped__(given)
    return _known_inputs(given)


@lru_cache
def _known_inputs(inputs: tuple[int | str, ...]) -> tuple[tuple[int | str, ...], tuple[str, ...]]:
    given: list[int | str] = []
    for one in inputs:
        place = _TORQUE.fullmatch(one) if isinstance(one, str) else None
        if place is not None:
            given.append(whole_number("inputs", int(place[1])))
        elif isinstance(one, str):
            given.append(_no_start(str(one)))
        else:
            given.append(_joint(one))
    names = (one if isinstance(one, str) else f"torque[{one}]" for one in given)
    return tuple(given), different_names("inputs", names)


def _no_start(name: str) -> str:
    """Return a name as it is; refuse that of a start, which is no input."""
    if not _START.fullmatch(name):
        return name
    raise ValueError(
        f"inputs: {name!r}: a start is no input: it stands in the state (q, qd), by which A is; "
        "inputs are torque[j], pivot.x, pivot.y and the names of scene.parameters()"
    )


def _joint(one: Any) -> int:
    try:
        return whole_number("inputs", one)
    except TypeError:
        raise TypeError(
            f'inputs = {one!r}: must be a joint, as a whole number, or a name, such as "torque[1]"'
        ) from None


def driven_joints(
    inputs: Iterable[int | str], n: int, effects: Iterable[Any]
) -> tuple[int | str, ...]:
    """Return the joints that inputs drive; refuse inputs that are no torques that turn a joint."""
    given = different_names("inputs", inputs)
    known = [f"torque[{j}]" for j in range(1, n + 1)]
    for one in given:
        if isinstance(one, str) and not _TORQUE.fullmatch(one):
            wanted = f"must be a joint, 1 to {n}, or its torque, such as {known[0]!r}"
            raise ValueError(f"inputs: {one!r}: {wanted}{suggestion(one, known)}")
    joints, _ = known_inputs(given)
    for effect in effects:
        if effect.kind == "lock" and effect.joint in joints:
            raise ValueError(
                f"inputs: torque in joint {effect.joint}: a Lock holds this joint, which no torque "
                "turns: choose another joint, or a scene without this Lock"
            )
    return joints


@lru_cache
def state_as_output(n: int, inputs: int) -> tuple[Floats, Floats, tuple[str, ...]]:
    """Return C, D and the names where the outputs are the state."""
    C, D = np.eye(2 * n), np.zeros((2 * n, inputs))
    C.flags.writeable = D.flags.writeable = False
    return C, D, tuple(f"{kind}[{i}]" for kind in ("q", "qd") for i in range(1, n + 1))
