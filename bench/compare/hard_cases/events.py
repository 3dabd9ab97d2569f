"""Hard cases of events: bounces that accumulate, two events in one step."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from cases import Array
from swings import period_of, time_to

from hard_cases.outcome import Outcome
from hard_cases.programs import HANGING, Motion, Scene, crossing


class Bounces(Scene):
    """A rod pressed against a stop, with bounces that accumulate and end."""

    pressing, restitution, capture = 2.0, 0.8, 1e-9
    start, span = (0.4,), (0.0, 8.0)
    first = float(np.sqrt(2 * pressing * start[0]))  # speed of the first impact
    t_last = first / pressing * (1 + 2 * restitution / (1 - restitution))
    apex = first * (1 + restitution) / pressing  # the top of the first bounce
    rise = (restitution * first) ** 2 / (2 * pressing)
    # s before t_last; the figure shows these times
    before = np.append(np.linspace(t_last, 1, 300, endpoint=False), np.geomspace(1, 1e-7, 700))
    traced = t_last - before

    @property
    def numbers(self) -> dict[str, float]:
        return {"t_last": self.t_last}

    def reference(self) -> dict[str, list[float]]:
        return {"before": self.before.tolist()}

    def effects(self, fx: Any) -> list[Any]:
        stop = fx.JointStop(joint=1, range=(0, np.inf), restitution=self.restitution)
        return [fx.Motor(joint=1, constant=-self.pressing), stop]

    def torque(self, t: float) -> float:
        return -self.pressing

    def rates(self, t: float, y: Array) -> list[float]:
        return [y[1], -self.pressing]

    def judge(self, end: float, t_last: float | None, more: str = "", traced: Any = ()) -> Outcome:
        """Judge where the rod is at the end (exactly 0), and when it came to rest.

        `traced` has the angles at the traced times.
        """
        trace = {"q": [float(q) for q in traced]} if len(traced) else {}
        if abs(end) > 1e-3:
            said = f"is at {end:.3g} rad at the end: off the stop"
            return Outcome(error=abs(end), said=said, trace=trace)
        if t_last is None:
            return Outcome(said=f"never at rest; {more}", right=False, trace=trace)
        said = f"at rest after {t_last:.9f} s{more}"
        return Outcome(error=abs(t_last - self.t_last), said=said, trace=trace)

    def pendcore(self, **how: Any) -> Outcome:
        motion = self.by_pendcore(**how)
        moving = np.flatnonzero(motion.y[:, 1])
        t_last = motion.t[moving[-1] + 1] if motion.raw.status == "at_rest" else None
        return self.judge(motion.y[-1, 0], t_last, traced=motion.at(self.traced)[:, 0])

    def scipy(self, *, guarded: bool = False) -> Outcome:
        """End each flight by an event and start the next; below the capture speed the rod rests.

        With `guarded`, no step is longer than a quarter of the flight, which the user then must
        know.
        """
        from scipy.integrate import solve_ivp

        def hits(_: float, y: list[float]) -> float:
            return y[0]

        hits.terminal, hits.direction = True, -1  # type: ignore[attr-defined]
        end = self.span[1]
        t, y, traced = 0.0, [self.start[0], 0.0], np.zeros(self.traced.size)
        while t < end:
            flight = 2 * y[1] / self.pressing if guarded and t > 0 else np.inf
            sol = solve_ivp(
                self.rates, (t, end), y, events=hits, rtol=1e-11, atol=1e-13,
                max_step=flight / 4, dense_output=True,
            )  # fmt: skip
            here = (t <= self.traced) & (sol.t[-1] >= self.traced)
            if here.any():
                traced[here] = sol.sol(self.traced[here])[0]
            t = sol.t[-1]
            if sol.status != 1:
                return self.judge(sol.y[0, -1], None, traced=traced)
            speed = -self.restitution * sol.y[1, -1]
            if abs(speed) < self.capture:
                return self.judge(0.0, t, traced=traced)
            y = [0.0, speed]
        return self.judge(y[0], None, traced=traced)

    def mujoco(self, dt: float, **how: Any) -> Outcome:
        """Model the stop as a stiff spring and damper that together give the restitution."""
        self.stiffness = (0.1 / dt) ** 2  # half a contact takes thirty steps
        motion = self.by_mujoco(dt, **how)
        q, qd = motion.y.T
        moving = np.flatnonzero(np.abs(qd) > 1e-3)
        last = float(motion.t[moving[-1]]) if len(moving) else 0.0
        flight = (1.05 * self.first / self.pressing < motion.t) & (motion.t < 1.05 * self.apex)
        rise = max(0.0, float(q[flight].max())) / self.rise - 1
        more = f" (as far as the rate is below 1e-3 rad/s); first rise {rise:+.1%}"
        return self.judge(float(q[-1]), last, more, motion.at(self.traced)[:, 0])

    def model(self) -> Any:
        spec, logarithm = super().model(), np.log(self.restitution)
        damping = -2 * logarithm / np.hypot(np.pi, logarithm) * np.sqrt(self.stiffness)
        joint = spec.joints[0]
        joint.limited, joint.range = True, [0.0, 1e3]
        joint.solimp_limit[:3] = [0.9999, 0.9999, 0.001]
        joint.solref_limit = [-self.stiffness, -damping]
        return spec

    def odeint(self, **how: Any) -> Outcome:
        t, y = 0.0, [*self.start, *self.speeds]
        while t < self.span[1]:
            flight = y[1] if y[1] > 0 else 1.0  # it takes 2 y[1]/2 s: begin within it
            steps = self.steps_of_odeint(**how, y=y, t=t, first_step=0.25 * flight)
            low, high = steps.step()
            while steps.at(high)[0] > 0 and high < self.span[1]:
                low, high = steps.step()
            if steps.at(high)[0] > 0:
                break
            # The start of a flight is on the stop.
            t = crossing(steps.at, low, high, lambda y: 1.0 if y[0] == 0 else y[0])
            speed = -self.restitution * steps.at(t)[1]
            if speed < self.capture:
                return self.judge(0.0, t)
            y = [0.0, speed]
        return self.judge(y[0], None)


class TwoRoots(Scene):
    """A swing that passes a mark 1.3 ms before and after it turns: two events in one step."""

    gravity, amplitude, swings = 9.81, 1.0, 50
    mark = 0.99999  # rad from the vertical
    shown = 25.0  # ms; the figure shows this much before and after a turn
    zero, sign, start = HANGING, -1.0, (-amplitude,)

    @property
    def numbers(self) -> dict[str, float]:
        return {"amplitude": self.amplitude, "mark": self.mark, "swings": self.swings}

    @cache  # noqa: B019
    def passages(self) -> tuple[list[float], float]:
        """Return the times of all passages, and the end.

        The first comes from rest at -amplitude; the others follow by the period.
        """
        whole = period_of(self.amplitude, self.gravity)
        first = time_to(-self.mark, self.amplitude, self.gravity)
        times = [float(t + whole * n) for n in range(self.swings) for t in (first, whole - first)]
        return times, float(whole * self.swings)

    @property
    def span(self) -> tuple[float, float]:  # type: ignore[override]
        return 0.0, self.passages()[1]

    def reference(self) -> dict[str, list[float]]:
        return {"amplitude": [self.amplitude], "mark": [self.mark], "gravity": [self.gravity]}

    def around_a_turn(self, times: Sequence[float] | Array) -> list[float]:
        """Return the times that the figure shows, as ms from the tenth turn on the mark's side."""
        first, second = self.passages()[0][18:20]
        ms = 1e3 * (np.asarray(times, dtype=float) - (first + second) / 2)
        return ms[np.abs(ms) < self.shown].tolist()  # type: ignore[no-any-return]

    def judge(self, times: Sequence[float] | Array, steps: Sequence[float] | Array) -> Outcome:
        """Judge the times of the passages that were found; the steps are for the figure."""
        known, found = np.array(self.passages()[0]), np.sort(np.asarray(times, dtype=float))
        trace = {"found": self.around_a_turn(found), "steps": self.around_a_turn(steps)}
        words = f"{found.size} of {known.size} passages found"
        if found.size != known.size:
            return Outcome(said=words, right=False, trace=trace)
        off = float(np.abs(found - known).max())
        return Outcome(error=off, said=f"{words}, to {off:.0e} s", trace=trace)

    def judged(self, motion: Motion) -> Outcome:
        return self.judge(motion.events, motion.t)

    def pendcore(self, **how: Any) -> Outcome:
        import pendcore as pc

        mark = pc.events.JointAngle(joint=1, value=HANGING - self.mark)
        return self.judged(self.by_pendcore(events=[mark], **how))

    def rates(self, t: float, y: Array) -> list[float]:
        return [y[1], -1.5 * self.gravity * np.sin(y[0])]  # from the vertical

    def scipy(self, **how: Any) -> Outcome:
        return self.judged(self.by_scipy(events=lambda _, y: y[0] - self.mark, **how))

    def mujoco(self, dt: float, **how: Any) -> Outcome:
        """Compare the signs of successive steps, and interpolate."""
        motion = self.by_mujoco(dt, **how)
        past = motion.y[:, 0] - self.mark
        after = np.flatnonzero(past[:-1] * past[1:] < 0) + 1
        times = motion.t[after] - dt * past[after] / (past[after] - past[after - 1])
        return self.judge(times, motion.t)

    def odeint(self, longest: float = 1e9, **how: Any) -> Outcome:
        steps = self.steps_of_odeint(longest, **how)

        def past(y: Sequence[float]) -> float:
            return y[0] - self.mark

        found, before, high = [], -1.0, 0.0
        while high < self.span[1]:
            low, high = steps.step()
            now = past(steps.at(high))
            if before * now < 0:
                found.append(crossing(steps.at, low, high, past))
            before = now
        return self.judge(found, ())
