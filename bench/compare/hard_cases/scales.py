"""Hard cases of unlike scales: a stiff damper, a heavy payload, a chain that cracks."""

from __future__ import annotations

from functools import cache, cached_property
from math import cos, sin
from typing import Any

import numpy as np
from cases import Array
from dense_chain import DenseChain
from hybrid_chain import extrapolated_step
from mpmath import mp, mpf, sqrt

from hard_cases.outcome import Outcome
from hard_cases.programs import HANGING, Motion, Scene
from hard_cases.rods import G, two_rods


class KnownEnd(Scene):
    """A scene whose positions at the end are compared with the true ones of `reference`."""

    def positions(self, q: Array) -> Array:
        return q

    def reference(self) -> dict[str, list[float]]:
        return {"q": self.end()}

    def end(self) -> list[float]:
        raise NotImplementedError

    def judge(self, q: Any, words: str) -> Outcome:
        error = float(np.abs(self.positions(np.asarray(q)) - self.end()).max())
        if not np.isfinite(error):
            return Outcome(said=f"not a number; {words}", right=False)
        return Outcome(error=error, said=words)

    def judged(self, motion: Motion) -> Outcome:
        return self.judge(motion.y[-1, : self.links], motion.words)


class StiffDamper(KnownEnd):
    """The textbook's two rods with a joint that is damped at a rate of a million per second."""

    links, mass, gravity = 2, 1.0, G
    start, speeds, span = (np.pi / 4, np.pi / 3), (0.0, 0.0), (0.0, 5.0)
    translated = ("viscous_joint",)
    damping = 1e5  # N m s at joint 2; over its moment of inertia, about 0.08, it is 1e6 a second

    def effects(self, fx: Any) -> list[Any]:
        return [fx.ViscousJoint(joint=2, damping=self.damping)]

    @cached_property
    def rates(self) -> Any:  # type: ignore[override]
        return two_rods(of=np, torques=lambda t, w1, w2: (0.0, -self.damping * (w2 - w1)))

    @cache  # noqa: B019
    def end(self) -> list[float]:
        """Solve by SciPy's Radau at its tightest; other methods would take five million steps."""
        found = self.by_scipy(method="Radau", rtol=1e-12, atol=1e-14)
        return [float(x) for x in found.y[-1, :2]]

    def pendcore(self, **how: Any) -> Outcome:
        motion = self.by_pendcore(**how, store="end")
        stiff = bool(motion.raw.stats.stiff)
        words = f"{motion.raw.stats.accepted} steps{', says `stiff`' if stiff else ''}"
        if motion.success:
            return self.judge(motion.y[-1, :2], words)
        said = f"status `{motion.raw.status}` at t = {motion.t[-1]:.3g} s: {words}"
        return Outcome(said=said, right=stiff)

    def scipy(self, **how: Any) -> Outcome:
        motion = self.by_scipy(**how)
        more = "" if motion.success else f', "{motion.raw.message}"'
        return self.judge(motion.y[-1, :2], motion.words + more)

    def mujoco(self, dt: float, integrator: str) -> Outcome:
        steps = round(self.span[1] / dt)
        found = self.by_mujoco(dt, integrator, every=self.span[1])
        return self.judge(found.y[-1, :2], f"{steps} steps")


class Payload(KnownEnd):
    """The textbook's two rods with a million times their mass at the tip.

    The slow and the fast mode belong to the equations linearised about hanging, M q'' = -K q with
    M = [[4/3 + p, 1/2 + p], [1/2 + p, 1/3 + p]] and K = g diag(3/2 + p, 1/2 + p). They hold for
    angles between the rods far below p^(-1/2), 1e-3 rad, so the answer at the end is integrated.
    """

    links, mass, gravity, speeds = 2, 1.0, G, (0.0, 0.0)
    zero, translated = HANGING, ("payload",)
    ratio, amplitude = 1e6, 1e-4
    steps = 40_000  # of the reference; half as many move the end by 3e-10 rad
    rates = staticmethod(two_rods(ratio, from_hanging=True))  # type: ignore[assignment]

    def __init__(self) -> None:
        (slow, of_slow), (fast, of_fast) = self.modes()
        self.span = (0.0, float(2 * mp.pi / slow))
        self.start = tuple(self.amplitude * float(x) for x in (2, of_slow + of_fast))
        self.faster = float(fast / slow)

    @property
    def numbers(self) -> dict[str, float]:
        return {"amplitude": self.amplitude, "faster": self.faster}

    def modes(self) -> tuple[tuple[Any, Any], ...]:
        """Return the frequency of each mode, and its ratio of angles, second rod to first."""
        with mp.workdps(40):
            p, g = mpf(self.ratio), mpf(G)
            m11, m12, m22 = p + mpf(4) / 3, p + mpf(1) / 2, p + mpf(1) / 3
            k1, k2 = g * (p + mpf(3) / 2), g * (p + mpf(1) / 2)
            a, b, c = m11 * m22 - m12**2, -(m11 * k2 + m22 * k1), k1 * k2
            root = sqrt(b**2 - 4 * a * c)
            squares = 2 * c / (-b + root), (-b + root) / (2 * a)
            return tuple((sqrt(s), (k1 - s * m11) / (s * m12)) for s in squares)

    def hamilton(self, _: float, y: Array) -> Array:
        """Hamilton's equations, in angles from hanging and momenta p = M q'."""
        q1, q2, p1, p2 = y.tolist()
        a, c, s = 0.5 + self.ratio, cos(q1 - q2), sin(q1 - q2)
        m11, m22 = 4 / 3 + self.ratio, 1 / 3 + self.ratio
        determinant = 7 / 36 + 2 * self.ratio / 3 + (a * s) ** 2
        w1 = (m22 * p1 - a * c * p2) / determinant
        w2 = (m11 * p2 - a * c * p1) / determinant
        turning, weight = a * s * w1 * w2, self.ratio * G
        f1, f2 = (weight + 1.5 * G) * sin(q1), (weight + 0.5 * G) * sin(q2)
        return np.array([w1, w2, -turning - f1, turning - f2])

    @cache  # noqa: B019
    def end(self) -> list[float]:
        y = np.array([*self.start, *self.speeds])
        for _ in range(self.steps):
            y = extrapolated_step(self.hamilton, 0.0, y, self.span[1] / self.steps)
        return y[:2].tolist()

    def effects(self, fx: Any) -> list[Any]:
        return [fx.Payload(mass=self.ratio)]

    def pendcore(self, **how: Any) -> Outcome:
        motion = self.by_pendcore(**how, store="end")
        if not motion.success:
            return Outcome(said=motion.words, right=False)
        return self.judged(motion)

    def mujoco(self, dt: float, integrator: str) -> Outcome:
        motion = self.by_mujoco(dt, integrator, fitted=True)
        if not motion.success:
            said = "diverges, starts again from hanging, with a line on stderr"
            return Outcome(said=said, right=False)
        return self.judged(motion)


class LetGo(KnownEnd):
    """A chain of 100 links that is let go from horizontal.

    The right answer comes from Newton's and Euler's equations of each link, with the forces in the
    joints as unknowns, which make a banded system. It is integrated in 12th order. None of the
    programs solves the equations in this form.
    """

    links, gravity = 100, 9.81
    mass = length = 1 / links
    start = speeds = (0.0,) * links
    settings = {"pendcore": {"store": "end"}}  # noqa: RUF012
    steps = 2000  # of the reference; 1000 move the tip by 3e-7 m, a 12th order makes it 1e-10 m

    def __init__(self) -> None:
        each = {
            "masses": np.full(self.links, self.mass),
            "lengths": np.full(self.links, self.length),
        }
        chain = DenseChain(**each, gravity=self.gravity)
        self.coupled, self.moments = chain.couplings, chain.moments

    def positions(self, q: Array) -> Array:
        """Return the position of the tip."""
        return self.length * np.array([np.sum(np.cos(q)), np.sum(np.sin(q))])

    def rates_by_forces(self, _: float, y: Array) -> Array:
        """Force F_i acts on link i at its upper end, and -F_{i+1} at its lower end.

        The joints stay together, so that the two ends that meet have equal accelerations.
        """
        from scipy.linalg import solveh_banded

        n, mass, length = self.links, self.mass, self.length
        q, qd = y[:n], y[n:]
        along = np.column_stack([np.cos(q), np.sin(q)])  # the y axis points down
        across = np.column_stack([-np.sin(q), np.cos(q)])
        spin = length / 2 * (qd**2)[:, None] * along
        inertia = mass * length**2 / 12
        turned = length**2 / (4 * inertia) * across[:, :, None] * across[:, None, :]
        same = np.eye(2) / mass + turned  # an end's acceleration by the force there,
        other = (turned - np.eye(2) / mass)[:-1]  # less that by the force at the other end
        same[1:] += same[:-1].copy()
        banded = np.zeros((4, 2 * n))
        banded[3, ::2], banded[3, 1::2] = same[:, 0, 0], same[:, 1, 1]
        banded[2, 1::2] = same[:, 0, 1]
        banded[1, 2::2], banded[0, 3::2] = other[:, 0, 0], other[:, 0, 1]
        banded[2, 2::2], banded[1, 3::2] = other[:, 1, 0], other[:, 1, 1]
        apart = -spin
        apart[1:] -= spin[:-1]
        apart[0] -= [0, self.gravity]
        forces = solveh_banded(banded, apart.ravel(), check_finite=False).reshape(n, 2)
        both = forces.copy()
        both[:-1] += forces[1:]
        return np.append(qd, -length / (2 * inertia) * np.sum(across * both, axis=1))

    @cache  # noqa: B019
    def end(self) -> list[float]:
        y = np.zeros(2 * self.links)
        for _ in range(self.steps):
            y = extrapolated_step(self.rates_by_forces, 0.0, y, self.span[1] / self.steps)
        return self.positions(y[: self.links]).tolist()

    def reference(self) -> dict[str, list[float]]:
        return {"tip": self.end()}

    def rates(self, t: float, y: Array) -> Array:
        """Use the dense mass matrix of the angles, M = A cos(q_i - q_j), and Cholesky's factors."""
        from scipy.linalg import cho_factor, cho_solve

        n = self.links
        c, s, squares = np.cos(y[:n]), np.sin(y[:n]), y[n:] ** 2
        matrix = self.coupled * (np.outer(c, c) + np.outer(s, s))
        forces = self.moments * self.gravity * c - s * (self.coupled @ (c * squares))
        forces += c * (self.coupled @ (s * squares))
        factor = cho_factor(matrix, overwrite_a=True, check_finite=False)
        return np.append(y[n:], cho_solve(factor, forces, check_finite=False))

    def model(self) -> Any:
        import mujoco_models

        rods = [self.mass] * self.links, [self.length] * self.links
        return mujoco_models.chain(*rods, self.gravity)

    mujocos_zero = (0.0, 1.0)  # type: ignore[assignment]

    def mujoco(self, dt: float, integrator: str) -> Outcome:
        motion = self.by_mujoco(dt, integrator, watched=True)
        if motion.success:
            return self.judge(motion.y[-1, : self.links], motion.words)
        after = f"{motion.t[-1]:.2g} s"
        said = f"diverges after {after}, starts again, with a line on stderr"
        return Outcome(said=said, right=False)
