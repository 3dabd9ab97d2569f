"""Dormand and Prince's method of order 5(4), written from its table, one step after the other.

Method: J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26. Step control, starting
step and continuous extension: those of the code dopri5 described by E. Hairer, S. P. Norsett and
G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. 1993, sections II.4 to II.6.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction as F

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
RightHandSide = Callable[[float, Array], Sequence[float] | Array]

C = [F(0), F(1, 5), F(3, 10), F(4, 5), F(8, 9), F(1), F(1)]
A = [
    [],
    [F(1, 5)],
    [F(3, 40), F(9, 40)],
    [F(44, 45), F(-56, 15), F(32, 9)],
    [F(19372, 6561), F(-25360, 2187), F(64448, 6561), F(-212, 729)],
    [F(9017, 3168), F(-355, 33), F(46732, 5247), F(49, 176), F(-5103, 18656)],
    [F(35, 384), F(0), F(500, 1113), F(125, 192), F(-2187, 6784), F(11, 84)],
]
# The seventh stage is evaluated at the new point: it is the first stage of the next step.
B = [*A[6], F(0)]
B_FOURTH_ORDER = [
    F(5179, 57600),
    F(0),
    F(7571, 16695),
    F(393, 640),
    F(-92097, 339200),
    F(187, 2100),
    F(1, 40),
]
# Weights of the stages in the last coefficient of the continuous extension.
D = [
    F(-12715105075, 11282082432),
    F(0),
    F(87487479700, 32700410799),
    F(-10690763975, 1880347072),
    F(701980252875, 199316789632),
    F(-1453857185, 822651844),
    F(69997945, 29380423),
]

SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR, BETA = 0.9, 0.2, 10.0, 0.04
EXPONENT = 0.2 - 0.75 * BETA

_A = [np.array([float(a) for a in row]) for row in A]
_ERROR = np.array([float(b - low) for b, low in zip(B, B_FOURTH_ORDER, strict=True)])
_D = np.array([float(d) for d in D])


class StepTooSmallError(ArithmeticError):
    """The error cannot be held with steps that still advance the time; ``run`` got this far."""

    def __init__(self, run: Run) -> None:
        super().__init__(f"step too small at t = {run.t[-1]}")
        self.run = run


@dataclass
class Run:
    """The accepted points, the steps between them, and the continuous extension."""

    t: list[float]
    y: list[Array]
    h: list[float] = field(default_factory=list)
    rejected: int = 0
    evaluations: int = 0
    extension: list[Array] = field(default_factory=list)

    @property
    def accepted(self) -> int:
        """Number of accepted steps."""
        return len(self.h)

    def __call__(self, t: float) -> Array:
        """Return the state at a time within the run."""
        direction = 1 if self.t[-1] >= self.t[0] else -1
        ends = [direction * end for end in self.t[1:-1]]
        step = int(np.searchsorted(ends, direction * t))
        theta = (t - self.t[step]) / self.h[step]
        r1, r2, r3, r4, r5 = self.extension[step]
        value: Array = r1 + theta * (r2 + (1 - theta) * (r3 + theta * (r4 + (1 - theta) * r5)))
        return value


def starting_step(
    f: RightHandSide, t: float, y: Array, k: Array, scale: Array, span: float
) -> float:
    """Guess the first step from the sizes of the state and of its first two derivatives."""
    direction = np.sign(span)
    slope, size = float(np.sum((k / scale) ** 2)), float(np.sum((y / scale) ** 2))
    small = slope <= 1e-10 or size <= 1e-10
    h = min(1e-6 if small else 0.01 * np.sqrt(size / slope), abs(span))
    ahead = np.asarray(f(t + direction * h, y + direction * h * k))
    curvature = float(np.sqrt(np.sum(((ahead - k) / scale) ** 2))) / h
    largest = max(curvature, np.sqrt(slope))
    wanted = max(1e-6, 1e-3 * h) if largest <= 1e-15 else (0.01 / largest) ** (1 / 5)
    return float(direction * min(100 * h, wanted, abs(span)))


def integrate(
    f: RightHandSide,
    y0: ArrayLike,
    t_span: tuple[float, float],
    *,
    rtol: float,
    atol: float,
    first_step: float | None = None,
) -> Run:
    """Integrate dy/dt = f(t, y) from the first to the second time of ``t_span``, either way.

    ``y0``, (n,), is the state at the first time; ``rtol`` and ``atol`` are tolerances of the error
    of a step; `starting_step` chooses the first step if it is not given. If a step shrinks to the
    rounding error of the time, that is a `StepTooSmallError`.
    """
    t, t_end = t_span
    direction = 1.0 if t_end >= t else -1.0
    y = np.array(y0, dtype=np.float64)
    k = np.asarray(f(t, y))
    run = Run([t], [y], evaluations=1)
    if first_step is None:
        h = starting_step(f, t, y, k, atol + rtol * np.abs(y), t_end - t)
        run.evaluations += 1
    else:
        h = direction * first_step
    previous_error, after_rejection = 1e-4, False

    while t != t_end:
        if 0.1 * abs(h) <= abs(t) * np.finfo(np.float64).eps:
            raise StepTooSmallError(run)
        last = (t + 1.01 * h - t_end) * direction > 0
        if last:
            h = t_end - t
        stages = np.empty((7, y.size))
        stages[0] = k
        for i in range(1, 7):
            y_new = y + h * (_A[i] @ stages[:i])
            stages[i] = f(t + float(C[i]) * h, y_new)
        run.evaluations += 6
        scale = atol + rtol * np.maximum(np.abs(y), np.abs(y_new))
        error = float(np.sqrt(np.mean((h * (_ERROR @ stages) / scale) ** 2)))

        grown = error**EXPONENT
        if error <= 1:
            factor = grown / previous_error**BETA / SAFETY
            h_next = h / max(1 / LARGEST_FACTOR, min(1 / SMALLEST_FACTOR, factor))
            if after_rejection:
                h_next = direction * min(abs(h_next), abs(h))
            previous_error, after_rejection = max(error, 1e-4), False
            change = y_new - y
            start_bend = h * stages[0] - change
            end_bend = change - h * stages[6] - start_bend
            run.extension.append(np.array([y, change, start_bend, end_bend, h * (_D @ stages)]))
            t, y, k = t_end if last else t + h, y_new, stages[6]
            run.t.append(t)
            run.y.append(y)
            run.h.append(h)
            h = h_next
        else:
            h /= min(1 / SMALLEST_FACTOR, grown / SAFETY)
            run.rejected += 1
            after_rejection = True
    return run
