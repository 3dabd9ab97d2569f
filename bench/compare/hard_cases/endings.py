"""Hard cases that cannot go on: not a number, a rate without bounds, a time without steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from cases import Array

from hard_cases.outcome import Outcome
from hard_cases.programs import Motion, Scene
from hard_cases.rods import G, two_rods


class Ending(Scene):
    """A run is right if it ends near the edge with a finite state and says so."""

    speeds = (1.0,)
    edge, near = 0.5, 0.01  # s

    def judge(self, t: float, q: float, words: str, *, says: bool) -> Outcome:
        near = abs(t - self.edge) < self.near and np.isfinite(q)
        right = bool(says and near)
        return Outcome(error=abs(t - self.edge), said=words + self.last(t, q), right=right)

    def last(self, t: float, q: float) -> str:
        return f", last t = {t:.6g} s, q = {q:.6g} rad"

    def judged(self, motion: Motion) -> Outcome:
        raw = motion.raw
        words = f'{"success" if raw.success else "failure"}: "{raw.message}"'
        if isinstance(raw.status, str):  # pendcore's
            words = f"status `{raw.status}`"
        return self.judge(motion.t[-1], motion.y[-1, 0], words, says=not motion.success)

    def mujoco(self, dt: float, *, watched: bool = False) -> Outcome:
        """A user who is not watching asks for the time, and gets that of the start again."""
        motion = self.by_mujoco(dt, "RK4", watched=watched)
        t, q = float(motion.t[-1]), float(motion.y[-1, 0])
        if watched:
            words = "no warning" if motion.success else motion.words
            return self.judge(t, q, words, says=not motion.success)
        again = t < 0.99 * self.span[1]
        words = "starts again from the start, with a line on stderr" if again else "goes on"
        return self.judge(t, q, words, says=False)

    def odeint(self, **how: Any) -> Outcome:
        motion = self.by_odeint(**how)
        return self.judge(motion.t[-1], motion.y[-1, 0], "returns without a word", says=False)


class NotANumber(Ending):
    """A couple of the user's own that is no number beyond an angle, which is reached at 0.5 s."""

    span = (0.0, 2.0)

    def law(self, q: Any) -> Any:
        with np.errstate(invalid="ignore"):
            return 0.0 * np.sqrt(self.edge - q)

    def effects(self, fx: Any) -> list[Any]:
        return [fx.User(lambda t, q, qd: self.law(q))]

    def rates(self, t: float, y: Array) -> list[float]:
        return [y[1], float(self.law(y[0]))]

    def couple(self, data: Any) -> Any:
        return self.law(data.qpos)


class BlowUp(Ending):
    """Damping of the wrong sign, w' = w^3: the rate is infinite after a finite time."""

    near = 1e-3

    @property
    def numbers(self) -> dict[str, float]:
        return {"pole": self.edge}

    def last(self, t: float, q: float) -> str:
        return f", last t = {t:.9g} s"

    def effects(self, fx: Any) -> list[Any]:
        return [fx.ViscousJoint(joint=1, damping=0, damping3=-1.0)]

    def rates(self, t: float, y: Array) -> list[float]:
        return [y[1], y[1] ** 3]

    def couple(self, data: Any) -> Any:
        return data.qvel**3


class LateStart(Scene):
    """A start so late that a step does not change the time."""

    links, mass, gravity = 2, 1.0, G
    start, speeds = (0.3, 0.3), (0.0, 0.0)
    span = (1e17, 1e17 + 160)  # ten units in the last place
    rates = staticmethod(two_rods(of=np))  # type: ignore[assignment]

    def pendcore(self, **how: Any) -> Outcome:
        found = self.by_pendcore(**how).raw
        said = f'status `{found.status}`: "{found.message}"'
        return Outcome(said=said, right=found.status == "step_too_small")

    def judged(self, motion: Motion) -> Outcome:
        said = f'failure: "{motion.raw.message}"'
        if motion.success:
            ended = f"after {motion.words}, at q = {motion.y[-1, 0]:.3g} rad"
            said = f'success: "{motion.raw.message}" {ended}'
        return Outcome(said=said, right=not motion.success)

    def mujoco(self, dt: float, integrator: str) -> Outcome:
        motion = self.by_mujoco(dt, integrator, seconds=10.0)
        gone = motion.t[-1] - self.span[0]
        said = f"moves on for 10 s while its clock goes by {gone:g} s, no warning"
        return Outcome(said=said, right=False)

    def odeint(self, **how: Any) -> Outcome:
        motion = self.by_odeint(**how)
        ended = f"returns after {motion.words} at t0 + {motion.t[-1] - self.span[0]:g} s"
        said = f"{ended}, q = {motion.y[-1, 0]:.3g} rad, without a word"
        return Outcome(said=said, right=False)
