"""Hard cases of dry friction: a rod that is held, stick and slip of one rod, and of two joints."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache, cached_property
from typing import Any

import numpy as np
from cases import Array
from dense_chain import DenseChain, joints
from hybrid_chain import HybridChain
from mpmath import mp, mpf
from stick_slip import DIGITS, Hum, slides

from hard_cases.outcome import Outcome
from hard_cases.programs import HANGING, Motion, Scene
from hard_cases.rods import G, two_rods


class RubbedRod(Scene):
    """One rod under a torque and friction with a sign that is smoothed over a rate."""

    friction, smoothed = 0.0, 1.0
    translated = ("dry_joint_friction",)

    def torques(self, t: Any, q: Any) -> tuple[Any, Any, Any]:
        """Return the torque, and its derivatives by t and q."""
        raise NotImplementedError

    def rates(self, t: float, y: Array) -> list[float]:
        return [y[1], self.torques(t, y[0])[0] - self.friction * np.tanh(y[1] / self.smoothed)]

    def derivatives(self, t: float, y: Array) -> tuple[Any, Any]:
        _, by_t, by_q = self.torques(t, y[0])
        slope = -self.friction / self.smoothed * (1 - np.tanh(y[1] / self.smoothed) ** 2)
        return [[0.0, 1.0], [by_q, slope]], [0.0, by_t]


class HeldRod(RubbedRod):
    """A rod that friction holds at 30 degrees for a million seconds."""

    gravity, start, span = 9.81, (np.pi / 6,), (0.0, 1e6)
    weight = 1.5 * 9.81
    friction = float(2 * weight * np.cos(start[0]))
    smoothed = 1e-6
    traced = np.geomspace(1e-2, span[1], 161)  # s, for the figure

    def effects(self, fx: Any) -> list[Any]:
        return [fx.DryJointFriction(joint=1, coulomb=self.friction)]

    def torques(self, t: Any, q: Any) -> tuple[Any, Any, Any]:
        return self.weight * np.cos(q), 0.0, -self.weight * np.sin(q)

    def moved(self, by: float, more: str = "", traced: Any = ()) -> Outcome:
        """Judge how far the rod has moved at the end; `traced` has its way at the traced times."""
        words = f"moves by {abs(by):.1e} rad" if by else "moves by exactly nothing"
        trace = {"moved": [abs(float(x)) for x in traced]} if len(traced) else {}
        return Outcome(error=abs(by), said=words + more, trace=trace)

    def judged(self, motion: Motion) -> Outcome:
        traced = motion.at(self.traced)[:, 0] - self.start[0]
        return self.moved(motion.y[-1, 0] - self.start[0], traced=traced)

    def pendcore(self, **how: Any) -> Outcome:
        motion = self.by_pendcore(**how)
        found = self.judged(motion)
        return replace(found, said=f"{found.said}; status `{motion.raw.status}`")

    def scipy(self, *, flag: bool = False, **how: Any) -> Outcome:
        """Use a flag of the user's own: the rod rests if friction can hold it at no rate."""
        if flag:
            held = abs(self.weight * np.cos(self.start[0])) <= self.friction
            return self.moved(0.0) if held else Outcome(said="slides")
        return self.judged(self.by_scipy(**how, dense_output=True))

    def mujoco(self, dt: float, constant: float | None = None) -> Outcome:
        """Run ten seconds, and go on at the last rate."""
        seconds = 10.0
        motion = self.by_mujoco(dt, seconds=seconds, constant=constant)
        rate = float(motion.y[-1, 1])
        traced = motion.at(self.traced)[:, 0] - self.start[0]
        traced += rate * np.maximum(self.traced - seconds, 0)
        more = f" (its rate after {seconds:.0f} s, times 1e6 s)"
        return self.moved(rate * self.span[1], more, traced)

    def odeint(self, **how: Any) -> Outcome:
        return self.moved(self.by_odeint(**how).y[-1, 0] - self.start[0])

    def reference(self) -> dict[str, list[float]]:
        return {"t": self.traced.tolist()}


class StickSlip(RubbedRod):
    """A rod under a constant torque and a hum, which moves in a staircase of slides and rests."""

    bias, amplitude, frequency, friction, stairs = 0.4, 0.5, 2.0, 0.7, 20
    turn = 2 * np.pi / frequency
    span = (0.0, stairs * turn)  # it ends within a rest
    smoothed = 1e-4

    def torques(self, t: Any, q: Any) -> tuple[Any, Any, Any]:
        growing = self.amplitude * self.frequency * np.cos(self.frequency * t)
        return self.torque(t), growing, 0.0

    def torque(self, t: Any) -> Any:
        return self.bias + self.amplitude * np.sin(self.frequency * t)

    def effects(self, fx: Any) -> list[Any]:
        hum = fx.Sinusoid(amplitude=self.amplitude, angular_frequency=self.frequency)
        motors = [fx.Motor(joint=1, sinusoid=hum), fx.Motor(joint=1, constant=self.bias)]
        return [*motors, fx.DryJointFriction(joint=1, coulomb=self.friction)]

    @cache  # noqa: B019
    def reference(self) -> dict[str, list[float]]:
        numbers = (self.bias, self.amplitude, self.frequency, self.friction)
        names = ("bias", "amplitude", "frequency", "friction")
        with mp.workdps(DIGITS):
            hum = Hum(**{name: mpf(x) for name, x in zip(names, numbers, strict=True)})
            found = list(slides(hum, mpf(self.span[1])))
            end = float(found[-1].angle_at(found[-1].end))
            return {"end": [end], "rest": [float(found[1].end), float(found[2].begin)]}

    @property
    def resting(self) -> float:
        return float(np.mean(self.reference()["rest"]))

    def judge(self, end: float, at_rest: float) -> Outcome:
        """Judge the angle at the end, and the rate in the middle of a rest."""
        creep = f"creeps at {abs(at_rest):.0e} rad/s in its rests" if at_rest else "rests exactly"
        return Outcome(error=abs(end - self.reference()["end"][0]), said=creep)

    def judged(self, motion: Motion) -> Outcome:
        return self.judge(motion.y[-1, 0], float(motion.at([self.resting])[0, 1]))

    def scipy(self, *, loop: bool = False, **how: Any) -> Outcome:
        return self.by_events() if loop else self.judged(self.by_scipy(**how, dense_output=True))

    def by_events(self) -> Outcome:
        """Use two modes, a loop, an event for each way out; max_step keeps steps within a rest."""
        from scipy.integrate import solve_ivp

        def event(function: Callable[[float, Array], float], direction: int = 0) -> Any:
            return type("Event", (), {"__call__": lambda _, t, y: function(t, y), "terminal": True,
                                      "direction": direction})()  # fmt: skip

        torque, friction = self.torque, self.friction
        leaves = event(lambda t, _: friction - abs(torque(t)), -1)
        how = {"rtol": 1e-11, "atol": 1e-13, "dense_output": True, "max_step": self.turn / 20}
        t, y, sliding, pieces = 0.0, np.zeros(2), 0.0, []
        while t < self.span[1]:
            side = sliding
            stops = event(lambda _, y, side=side: side * y[1], -1)
            rates = (lambda t, y, side=side: [y[1], torque(t) - side * friction]) if side else (
                lambda t, y: [0.0, 0.0]
            )  # fmt: skip
            end = self.span[1]
            sol = solve_ivp(rates, (t, end), y, events=[stops if side else leaves], **how)
            pieces.append(sol)
            if sol.t[-1] <= t:
                raise RuntimeError(f"stuck in its loop at t = {t:.3f}")
            t, y = sol.t[-1], np.array([sol.y[0, -1], 0.0])
            sliding = 0.0 if side and abs(torque(t)) <= friction else np.sign(torque(t))
        piece = next(sol for sol in pieces if self.resting <= sol.t[-1])
        return self.judge(pieces[-1].y[0, -1], piece.sol(self.resting)[1])

    def odeint(self, **how: Any) -> Outcome:
        return self.judged(self.by_odeint(times=[self.resting, self.span[1]], **how))


class TwoJoints(Scene):
    """Two rods with dry friction in both joints under a slow motor: they stick and slide in turn.

    The right answer is solved mode by mode in tests/models/hybrid_chain.py, which tries every
    pattern of stick and slip at each switch.
    """

    links, mass, gravity = 2, 1.0, G
    start, speeds, span = (HANGING, HANGING), (0.0, 0.0), (0.0, 9.0)
    friction = (5.0, 1.5)  # N m
    amplitude, frequency = 10.0, 1.0  # N m, rad/s; the motor in joint 1
    times = np.linspace(0, span[1], 361)[1:]
    chain = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=G)
    translated = ("dry_joint_friction",)
    settings = {"scipy": {"dense_output": True}, "odeint": {"times": times}}  # noqa: RUF012

    def motor(self, t: float) -> Array:
        return np.array([self.amplitude * np.sin(self.frequency * t), 0.0])

    def torque(self, t: float) -> float:
        return -float(self.motor(t)[0])

    def effects(self, fx: Any) -> list[Any]:
        hum = fx.Sinusoid(amplitude=self.amplitude, angular_frequency=self.frequency)
        rubs = [fx.DryJointFriction(joint=j, coulomb=self.friction[j - 1]) for j in (1, 2)]
        return [fx.Motor(joint=1, sinusoid=hum), *rubs]

    def torques(self, t: float, w1: float, w2: float) -> tuple[float, float]:
        """Return the torques in the joints; the sign of friction is smoothed over 1e-3 rad/s."""
        first, second = self.friction
        driven = self.amplitude * math.sin(self.frequency * t)
        return driven - first * math.tanh(w1 / 1e-3), -second * math.tanh((w2 - w1) / 1e-3)

    @cached_property
    def rates(self) -> Any:  # type: ignore[override]
        return two_rods(torques=self.torques)

    @cache  # noqa: B019
    def solved(self) -> tuple[Array, list[float], list[tuple[int, ...]]]:
        """Return states at the times, the times of the switches, and the modes from there on."""
        friction = np.array(self.friction)
        exact = HybridChain(chain=self.chain, friction=friction, torques=self.motor)
        states = exact.run(np.array(self.start), self.times, h=0.04)
        return states, [float(t) for t, _, _ in exact.switches], [m for _, _, m in exact.switches]

    def reference(self) -> dict[str, list[float]]:
        states, switches, modes = self.solved()
        phi = states[:, :2] @ joints(2).T
        known = {"t": self.times.tolist(), "phi_1": phi[:, 0].tolist(), "phi_2": phi[:, 1].tolist()}
        of_joints = {f"mode_{j + 1}": [float(mode[j]) for mode in modes] for j in range(2)}
        return {**known, "switches": switches, **of_joints}

    def judged(self, motion: Motion) -> Outcome:
        """Judge the states at the times, and the state in the middle of a time of no motion."""
        known, switches, modes = self.solved()
        resting = modes.index((0, 0))
        at_rest = motion.at([(switches[resting] + switches[resting + 1]) / 2])[0]
        creep = float(np.abs(at_rest[2:] @ joints(2).T).max())
        phi = motion.at(self.times)[:, :2] @ joints(2).T
        off = np.abs(phi - known[:, :2] @ joints(2).T).max(axis=1)
        said = f"creeps at {creep:.0e} rad/s where both joints rest" if creep else "rests exactly"
        trace = {"phi_1": phi[:, 0].tolist(), "phi_2": phi[:, 1].tolist(), "error": off.tolist()}
        return Outcome(error=float(off.max()), said=said, trace=trace)
