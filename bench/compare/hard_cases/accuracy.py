"""Hard cases of accuracy: a long run, a shaken pivot, a fall from upright, a separatrix."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, pi, sin
from typing import Any

import numpy as np
from cases import Array
from swings import period_of, time_of_fall
from trajectory_error import energy

from hard_cases.outcome import Outcome
from hard_cases.programs import HANGING, UPRIGHT, Motion, Scene, crossing
from hard_cases.rods import G, two_rods


class Drift(Scene):
    """The energy of the textbook's case over 2000 s."""

    links, mass, gravity = 2, 1.0, G
    start, speeds, span = (np.pi / 4, np.pi / 3), (0.0, 0.0), (0.0, 2000.0)
    times = np.linspace(0, span[1], 201)
    rates = staticmethod(two_rods())  # type: ignore[assignment]
    settings = {"pendcore": {"t_eval": times}, "mujoco": {"every": times[1]}}  # noqa: RUF012

    def judge(self, states: Any, words: str) -> Outcome:
        """Judge the largest drift at the times, as a share of the energy at the start."""
        q, qd = np.split(np.vstack([(*self.start, *self.speeds), states]), 2, axis=1)
        found = energy(q, qd, np.ones(2), np.ones(2), G)
        return Outcome(error=float(np.abs(found / found[0] - 1).max()), said=words)

    def judged(self, motion: Motion) -> Outcome:
        return self.judge(motion.y, motion.words)

    def scipy(self, **how: Any) -> Outcome:
        motion = self.by_scipy(**how, t_eval=self.times)
        return self.judge(motion.y, f"{motion.raw.nfev} evaluations")

    def odeint(self, **how: Any) -> Outcome:
        return self.judge(self.by_odeint(times=self.times, **how).y, "integrate_times")


class ShakenPivot(Scene):
    """A rod upright on a pivot that shakes up and down, and the frequency at which it stands.

    theta'' = (3/2L) (g - eps w^2 cos wt) sin theta. With tau = wt/2 small swings obey Mathieu's
    equation, theta'' + (a - 2 q cos 2 tau) theta = 0, with a = -6 g/(L w^2) and q = -3 eps/L. The
    border is where a is the lowest characteristic value a_0(q), the least eigenvalue of an infinite
    tridiagonal matrix.
    """

    mass, gravity, hanging = 1.0, G, False
    eps = 0.2  # m; the rod has 1 m
    small = 1e-5  # rad from upright; the nonlinear part is its square, relatively
    zero, start = UPRIGHT, (small,)
    settings = {"pendcore": {"store": "end"}}  # noqa: RUF012

    @property
    def border(self) -> float:
        size = np.arange(30)
        beside = np.full(29, 3 * self.eps)
        beside[0] *= np.sqrt(2)
        matrix = np.diag(4.0 * size**2) + np.diag(beside, 1) + np.diag(beside, -1)
        return float(np.sqrt(-6 * G / np.linalg.eigvalsh(matrix)[0]))

    @property
    def numbers(self) -> dict[str, float]:
        return {"border": self.border}

    def reference(self) -> dict[str, list[float]]:
        return {"w": [self.border]}

    def outcome(self, run: Callable[[], Motion]) -> Outcome:
        """Seek the frequency at which a small angle is the same again after a period of the drive.

        The equation is even in time. Therefore the trace of the map over a period is twice the
        ratio of the two angles, and the trace is 2 at the border.
        """
        from scipy.optimize import brentq

        def grown(w: float) -> float:
            self.w, self.span = w, (0.0, 2 * pi / w)
            return float(run().y[-1, 0]) / self.small - 1

        w = brentq(grown, 0.9 * self.border, 1.1 * self.border, xtol=1e-13)
        return Outcome(error=abs(w / self.border - 1), said=f"stands from {w:.10f} rad/s on")

    def effects(self, fx: Any) -> list[Any]:
        shaking = fx.Sinusoid(amplitude=self.eps, angular_frequency=self.w, phase=pi / 2)
        return [fx.DrivenPivot(y=shaking)]

    def rates(self, t: float, y: Array) -> tuple[float, float]:
        return y[1], 1.5 * (G - self.eps * self.w**2 * cos(self.w * t)) * sin(y[0])

    def couple(self, data: Any) -> Any:
        """Return the torque of the pivot's acceleration, in the frame of the pivot."""
        return -0.5 * self.eps * self.w**2 * cos(self.w * data.time) * sin(data.qpos[0])

    def mujoco(self, steps: int) -> Outcome:
        return self.outcome(lambda: self.by_mujoco(self.span[1] / steps, "RK4", fitted=True))


class Upright(Scene):
    """Two rods that stand a billionth of a radian off upright, and the time of their fall."""

    links, mass, gravity, hanging = 2, 1.0, G, False
    start, speeds, span = (UPRIGHT + 1e-9,) * 2, (0.0, 0.0), (0.0, 6.0)
    rates = staticmethod(two_rods())  # type: ignore[assignment]
    settings = {"scipy": {"dense_output": True}}  # noqa: RUF012

    @cache  # noqa: B019
    def fall_time(self) -> float:
        """Return when link 1 or 2 is 1 rad off, from the exact double start."""
        return time_of_fall(2, self.start[0], G)

    def reference(self) -> dict[str, list[float]]:
        return {"t": [self.fall_time()]}

    def judge(self, t: float) -> Outcome:
        return Outcome(error=abs(t - self.fall_time()), said=f"{t:.9f} s")

    def judged(self, motion: Motion) -> Outcome:
        """Find when the distance is first 1 rad, bisected between two of the times."""

        def state(t: float) -> Array:
            return motion.at(np.array([t]))[0]

        after = next(k for k, t in enumerate(motion.t) if self.off(state(t)) > 0)
        return self.judge(crossing(state, motion.t[after - 1], motion.t[after], self.off))

    def off(self, y: Any) -> float:
        """Return how far beyond 1 rad from upright the farther link is."""
        return float(np.abs(np.array(y[:2]) - UPRIGHT).max()) - 1

    def mujoco(self, dt: float, integrator: str) -> Outcome:
        motion = self.by_mujoco(dt, integrator)
        off = np.abs(motion.y[:, :2] - UPRIGHT).max(axis=1)
        if not (off > 1).any():
            return Outcome(said="does not fall", right=False)
        k = int(np.argmax(off > 1))
        return self.judge(float(motion.t[k] - dt * (off[k] - 1) / (off[k] - off[k - 1])))

    def odeint(self, **how: Any) -> Outcome:
        steps = self.steps_of_odeint(**how)
        low, high = steps.step()
        while self.off(steps.at(high)) < 0 and high < self.span[1]:
            low, high = steps.step()
        return self.judge(crossing(steps.at, low, high, self.off))


class Separatrix(Scene):
    """A swing next to the separatrix: modulus 0.999999, 0.16 degrees short of upright."""

    mass, gravity = 1.0, G
    amplitude = float(2 * np.arcsin(0.999999))
    zero, sign, start = HANGING, -1.0, (amplitude,)
    settings = {"mujoco": {"fitted": True}}  # noqa: RUF012
    span = (0.0, float(period_of(amplitude, G)))

    @property
    def numbers(self) -> dict[str, float]:
        return {"period": self.span[1]}

    def judged(self, motion: Motion) -> Outcome:
        """Judge how far the rod is from its start after a period."""
        off = float(abs(motion.y[-1, 0] - self.amplitude))
        return Outcome(error=off, said=f"{off:.1e} rad off after a period")

    def rates(self, t: float, y: Array) -> list[float]:
        return [y[1], -1.5 * G * np.sin(y[0])]
