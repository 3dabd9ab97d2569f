"""Radau IIA of order 5 with its step control, one step after the other.

Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 2nd ed. 1996, IV.8:
starting values (8.5), the iteration and where it stops, error (8.20), predictive control (8.25).
As the core documents, and unlike their program, the Jacobian is that of each step's start. The
stages are solved as one system of three times the size, (1 - h A x J) dZ = h A F(Z) - Z; only the
norm of the increments is that of T^-1 dZ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.dormand_prince import RightHandSide, starting_step
from reference.radau_iia import coefficients

Array = NDArray[np.float64]
Jacobian = Callable[[float, Array], Array]

SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR, NOT_SOLVED = 0.9, 0.2, 8.0, 0.5
MOST_ITERATIONS, USUAL_ITERATIONS = 20, 7
EPS = float(np.finfo(np.float64).eps)

_EXACT = coefficients()
_C = np.array(_EXACT["c"], dtype=float)
_A = np.array(_EXACT["a"], dtype=float)
_T_INVERSE = np.array(_EXACT["t_inverse"], dtype=float)
_GAMMA = 1.0 / float(_EXACT["real"])
_ROOT = np.sqrt(6.0)
_E = _GAMMA / 3 * np.array([-13 - 7 * _ROOT, -13 + 7 * _ROOT, -1])  # of (8.20)
_POWERS = np.linalg.inv(_C[:, np.newaxis] ** [1, 2, 3])
"""From the stages to the powers of the polynomial through them, and 0 at 0."""


@dataclass
class Run:
    """The accepted points, the steps between them, the errors of these, and the counts."""

    t: list[float]
    y: list[Array]
    h: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    powers: list[Array] = field(default_factory=list)
    rejected: int = 0
    not_solved: int = 0
    filtered_twice: int = 0
    evaluations: int = 0


@dataclass
class _Method:
    """One problem, and what a step takes from the one before."""

    f: RightHandSide
    jacobian: Jacobian
    rtol: float
    atol: float
    newton_tolerance: float
    run: Run
    contraction: float = 1.0

    def rate(self, t: float, y: Array) -> Array:
        self.run.evaluations += 1
        return np.asarray(self.f(t, y), dtype=float)

    def norm(self, x: Array, y: Array, y_new: Array) -> float:
        scale = self.atol + self.rtol * np.maximum(np.abs(y), np.abs(y_new))
        return float(np.sqrt(np.mean((x / scale) ** 2)))

    def stages(self, t: float, y: Array, h: float, z: Array) -> tuple[Array, int, float] | None:
        """Iterate from Z: the stages, how often, and theta/(1 - theta); None if they diverge."""
        matrix = np.eye(3 * y.size) - h * np.kron(_A, self.jacobian(t, y))
        factor, before, ratio_before = max(self.contraction, EPS) ** 0.8, 0.0, 0.0
        for k in range(1, MOST_ITERATIONS + 1):
            rates = np.array([self.rate(t + c * h, y + z_c) for c, z_c in zip(_C, z, strict=True)])
            change = np.linalg.solve(matrix, (h * _A @ rates - z).ravel()).reshape(z.shape)
            z = z + change
            size = self.norm(_T_INVERSE @ change, y, y + z[2])
            if k > 1:
                ratio = size / before
                theta = ratio if k == 2 else float(np.sqrt(ratio * ratio_before))
                ratio_before = ratio
                if theta >= 0.99:
                    return (z, k, self.contraction) if size <= self.newton_tolerance else None
                factor = theta / (1 - theta)
                if factor * size * theta ** (MOST_ITERATIONS - k) > self.newton_tolerance:
                    return None
            before = max(size, EPS)
            if factor * size <= self.newton_tolerance:
                return z, k, factor
        return None

    def error(self, t: float, y: Array, k: Array, h: float, z: Array, careful: bool) -> float:
        """(8.20); in a first step, or one that is tried again, filtered twice if too large."""
        matrix = np.eye(y.size) - h * _GAMMA * self.jacobian(t, y)
        error = np.linalg.solve(matrix, h * _GAMMA * k + _E @ z)
        size = self.norm(error, y, y + z[2])
        if careful and size >= 1:
            self.run.filtered_twice += 1
            again = h * _GAMMA * self.rate(t, y + error) + _E @ z
            size = self.norm(np.linalg.solve(matrix, again), y, y + z[2])
        return size


def integrate(
    f: RightHandSide,
    jacobian: Jacobian,
    y0: ArrayLike,
    t_span: tuple[float, float],
    *,
    rtol: float,
    atol: float,
    first_step: float | None = None,
) -> Run:
    """Integrate dy/dt = f(t, y) from the first to the second time of ``t_span``.

    The tolerances are those of the step's own error. Its estimate is of lower order, and must stay
    below 0.1 rtol^(2/3), and atol in proportion. This program does not provide for tolerances at
    which the iteration meets rounding.
    """
    t, t_end = t_span
    direction = 1.0 if t_end >= t else -1.0
    y = np.array(y0, dtype=np.float64)
    run = Run([t], [y])
    of_estimate = 0.1 * rtol ** (2 / 3)
    method = _Method(
        f, jacobian, of_estimate, of_estimate * atol / rtol,
        max(10 * EPS / of_estimate, min(0.03, np.sqrt(of_estimate))), run,
    )  # fmt: skip
    k = method.rate(t, y)
    if first_step is None:
        h = starting_step(f, t, y, k, atol + rtol * np.abs(y), t_end - t)
        run.evaluations += 1
    else:
        h = direction * first_step
    error_before, retry = 1.0, False

    while t != t_end:
        last = (t + 1.01 * h - t_end) * direction >= 0
        if last:
            h = t_end - t
        z = np.zeros((3, y.size))
        if run.h:  # (8.5): the polynomial of the step before, continued
            x = 1 + _C * h / run.h[-1]
            z = (x[:, np.newaxis] ** [1, 2, 3] - 1) @ run.powers[-1]
        solved = method.stages(t, y, h, z)
        if solved is None:
            h, retry = NOT_SOLVED * h, True
            run.rejected += 1
            run.not_solved += 1
            continue
        z, iterations, contraction = solved
        error = method.error(t, y, k, h, z, retry or not run.h)
        if error > 1:
            h, retry = h * max(SMALLEST_FACTOR, SAFETY * error**-0.25), True
            run.rejected += 1
            continue
        safety = SAFETY * (1 + 2 * USUAL_ITERATIONS) / (iterations + 2 * USUAL_ITERATIONS)
        factor = safety * error**-0.25
        if run.h:  # (8.25)
            factor = min(factor, SAFETY * h / run.h[-1] * (error_before / error**2) ** 0.25)
        factor = min(max(SMALLEST_FACTOR, factor), 1.0 if retry else LARGEST_FACTOR)
        error_before, method.contraction, retry = max(error, 1e-2), contraction, False
        t, y = t_end if last else t + h, y + z[2]
        k = method.rate(t, y)
        run.t.append(t)
        run.y.append(y)
        run.h.append(h)
        run.errors.append(error)
        run.powers.append(_POWERS @ z)
        h *= factor
    return run
