"""The runner of each program: a scene in, a motion out."""

from __future__ import annotations

import math
import signal
import subprocess
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from contenders.conversation import find_executable, words

from hard_cases.outcome import NoReturn, Outcome

Array = npt.NDArray[np.float64]
G = 9.807
UPRIGHT, HANGING = -np.pi / 2, np.pi / 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Times (k,) and states (k, 2n): angles from +x towards +y, y down, and rates.

    `at` gives states (m, 2n) at times (m,); `events` are the times that the program found; `words`
    are what it said, and `success` whether it says to have finished.
    """

    t: Array
    y: Array
    at: Callable[[Any], Array]
    words: str
    success: bool = True
    events: Sequence[float] | Array = ()
    raw: Any = None


class Scene:
    """A hard case as data: uniform rods, what acts on them, the start, the span, what is measured.

    `start` has angles, `speeds` rates; without gravity only changes of angle matter. The programs
    run the scene as below, unless a case has its own way; `judged` makes an outcome of a motion.
    """

    links = 1
    mass, length = 3.0, 1.0  # of each; one such rod has the moment of inertia 1 about its end
    gravity = 0.0
    start: tuple[float, ...] = (0.0,)
    speeds: tuple[float, ...] = (0.0,)
    span: tuple[float, float] = (0.0, 1.0)
    joint = ""  # attributes of MuJoCo's joints
    hanging = True  # whether MuJoCo's angles are 0 where all rods hang, or where they stand

    # What acts, for each program.

    def effects(self, fx: Any) -> list[Any]:
        return []

    def rates(self, t: float, y: Array) -> Any:
        raise NotImplementedError

    def torque(self, t: float) -> float:
        """Return MuJoCo's torque in the first joint."""
        return 0.0

    def couple(self, data: Any) -> Any:
        """Return MuJoCo's passive couples."""
        return 0.0

    def judged(self, motion: Motion) -> Outcome:
        raise NotImplementedError

    def reference(self) -> dict[str, list[float]]:
        return {}

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers that the texts quote."""
        return {}

    # The programs.

    def pendcore(self, **how: Any) -> Outcome:
        return self.judged(self.by_pendcore(**how))

    def by_pendcore(self, **how: Any) -> Motion:
        import pendcore as pc

        links = [pc.Link(mass=self.mass, length=self.length)] * self.links
        effects = self.effects(pc.effects)
        how = {"q0": self.start, "qd0": self.speeds, "t_span": self.span, **how}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a negative coefficient
            scene = pc.Scene(links=links, gravity=self.gravity, effects=effects)
            sol = pc.simulate(scene, on_failure="ignore", **how)
        steps = f"{sol.stats.accepted} steps"
        words = steps if sol.success else f"status `{sol.status}`: {steps}"
        events = [event.t for event in sol.events[0]] if how.get("events") else []
        return Motion(
            t=sol.t, y=sol.y.T, at=lambda t: sol(t).T, words=words, success=sol.success,
            events=events, raw=sol,
        )  # fmt: skip

    def scipy(self, **how: Any) -> Outcome:
        return self.judged(self.by_scipy(**how))

    def by_scipy(self, start: Sequence[float] | None = None, **how: Any) -> Motion:
        """Solve the rates, from another start where these have other coordinates."""
        from scipy.integrate import solve_ivp

        start = start or [*self.start, *self.speeds]
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sol = solve_ivp(self.rates, self.span, start, **how)
        return Motion(
            t=sol.t, y=sol.y.T, at=lambda t: sol.sol(t).T, words=f"{sol.t.size - 1} steps",
            success=sol.success, events=sol.t_events[0] if how.get("events") else (), raw=sol,
        )  # fmt: skip

    def mujoco(self, **how: Any) -> Outcome:
        return self.judged(self.by_mujoco(**how))

    def by_mujoco(
        self, dt: float, integrator: str = "implicitfast", *, watched: bool = False,
        each: int = 1, fitted: bool = False, seconds: float | None = None,
        qpos: Any = None, **joint: Any,
    ) -> Motion:  # fmt: skip
        """Step through the span, or some seconds of it, and keep every so many states.

        `qpos` are the joints' angles at the start to the last bit; `raw` has what became of them.
        `fitted` makes the step a part of the span. With `watched` the user has disabled MuJoCo's
        restart from the start, and looks for warnings after each step; others see them at the end.
        """
        import mujoco

        seconds = seconds or self.span[1] - self.span[0]
        steps = round(seconds / dt)
        model = self.model(seconds / steps if fitted else dt, integrator, **joint)
        data = mujoco.MjData(model)
        data.time = self.span[0]
        data.qpos[:] = self.joints(self.start) if qpos is None else qpos
        data.qvel[:] = self.joints(self.speeds, rates=True)
        if type(self).torque is not Scene.torque:
            mujoco.set_mjcb_control(lambda _, d: d.ctrl.fill(self.torque(d.time)))
        if type(self).couple is not Scene.couple:
            mujoco.set_mjcb_passive(lambda _, d: d.qfrc_passive.__iadd__(self.couple(d)))
        if watched:
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET

        def warning() -> str:
            found = [k for k, one in enumerate(data.warning) if one.number]
            return f"warning `{mujoco.mjtWarning(found[0]).name}`" if found else ""

        rows = [np.array([data.time, *data.qpos, *data.qvel])]
        with np.errstate(all="ignore"):
            for _ in range(steps // each):
                mujoco.mj_step(model, data, each)
                if watched and warning():
                    break
                rows.append(np.array([data.time, *data.qpos, *data.qvel]))
        mujoco.set_mjcb_control(None)
        mujoco.set_mjcb_passive(None)
        warned = warning()
        t, *columns = np.transpose(rows)
        y = self.angles(np.array(columns))
        return Motion(
            t=t, y=y.T, at=lambda s: np.array([np.interp(s, t, column) for column in y]).T,
            words=warned or f"{steps} steps", success=not warned, raw=columns,
        )  # fmt: skip

    def model(self, dt: float, integrator: str, **joint: Any) -> Any:
        attributes = " ".join([self.joint, *(f'{key}="{value}"' for key, value in joint.items())])
        return mujoco_rods(
            dt=dt, links=self.links, mass=self.mass, gravity=self.gravity, joint=attributes,
            integrator=integrator, hanging=self.hanging,
        )  # fmt: skip

    def joints(self, of_links: Sequence[float], *, rates: bool = False) -> Array:
        """Return MuJoCo's angles (or rates) of joints, which turn the other way under gravity."""
        if not self.gravity:
            return np.array(of_links)
        if not self.hanging:
            return np.diff(np.array(of_links) - (0.0 if rates else UPRIGHT), prepend=0.0)
        return np.diff((0.0 if rates else HANGING) - np.array(of_links), prepend=0.0)

    def angles(self, of_joints: Array) -> Array:
        """Return states (2n, k) from MuJoCo's angles and rates of joints."""
        q, qd = np.split(of_joints, 2)
        if not self.gravity:
            return of_joints
        q, qd = np.cumsum(q, axis=0), np.cumsum(qd, axis=0)
        return np.vstack([HANGING - q, -qd] if self.hanging else [UPRIGHT + q, qd])

    def odeint(self, **how: Any) -> Outcome:
        raise NotImplementedError


@dataclass(frozen=True, slots=True)
class Odeint:
    """A task of Boost.odeint's program: equations by name, parameters, method, start (q, qd)."""

    system: str
    parameters: Sequence[float]
    method: str
    atol: float
    rtol: float
    first_step: float
    start: Sequence[float]

    def ask(self, word: str, *numbers: float) -> dict[str, list[float]]:
        """Return the numbers of the answer by name."""
        task = f"{self.system} {listed(self.parameters)} {self.method}"
        settings = words([self.atol, self.rtol, self.first_step])
        return ask(f"{word} {task} {settings} {listed(self.start)} {words(numbers)}")

    def end(self, span: Sequence[float]) -> tuple[float, Array, str]:
        """Return the last time, the last state, and the steps in words."""
        told = self.ask("integrate", *span)
        return told["t"][0], np.array(told["y"]), f"{told['steps'][0]:.0f} steps"

    def states(self, times: Sequence[float] | Array) -> Array:
        told = self.ask("states", len(times), *times)
        return np.reshape(told["states"], (-1, len(self.start)))


def listed(numbers: Sequence[float]) -> str:
    return f"{len(numbers)} {words(numbers)}"


def ask(request: str) -> dict[str, list[float]]:
    """Ask Boost.odeint's program, and return the numbers of its answer by name."""
    path = find_executable("hard_cases_odeint", "HARD_CASES_ODEINT")
    done = subprocess.run([path], input=f"{request}\n", capture_output=True, text=True, check=False)
    if done.returncode in {-signal.SIGXCPU, -signal.SIGKILL}:
        raise NoReturn
    verdict, _, answer = done.stdout.strip().partition(" ")
    if verdict != "ok":
        raise RuntimeError(answer or f"ended with {done.returncode}")
    found = (one.split() for one in answer.split(";"))
    return {name: [float(number) for number in numbers] for name, *numbers in found}


def two_rods(
    payload: float = 0.0, damping: float = 0.0, *, from_hanging: bool = False, of: Any = math
) -> Callable[[float, Array], list[float]]:
    """Rates of two rods of 1 kg and 1 m with a mass at the tip and a damper in joint 2.

    The determinant is free of terms that cancel. Python's floats are quicker than NumPy's, which
    know infinities.
    """
    cos, sin, p, a = of.cos, of.sin, payload, 0.5 + payload

    def rates(_: float, y: Any) -> list[float]:
        q1, q2, w1, w2 = y.tolist() if of is math else y
        c, s = cos(q1 - q2), sin(q1 - q2)
        g1, g2 = (-sin(q1), -sin(q2)) if from_hanging else (cos(q1), cos(q2))
        couple = -damping * (w2 - w1)
        r1 = (1.5 + p) * G * g1 - a * s * w2 * w2 - couple
        r2 = a * G * g2 + a * s * w1 * w1 + couple
        determinant = 7 / 36 + 2 * p / 3 + (a * s) * (a * s)
        a1 = ((1 / 3 + p) * r1 - a * c * r2) / determinant
        return [w1, w2, a1, ((4 / 3 + p) * r2 - a * c * r1) / determinant]

    return rates


ROD = """<mujoco>
 <option timestep="{dt}" gravity="0 0 {down}" integrator="{integrator}" iterations="200"
         tolerance="0"/>
 <worldbody>
  <body>
   <joint name="joint" type="hinge" axis="0 1 0" {joint}/>
   <inertial pos="0 0 {side}0.5" mass="{mass}" diaginertia="{inertia} {inertia} {thin}"/>
   {tip}
  </body>
 </worldbody>
 <actuator><motor joint="joint"/></actuator>
</mujoco>"""

SECOND = """<body pos="0 0 {side}1">
    <joint name="second" type="hinge" axis="0 1 0" {joint}/>
    <inertial pos="0 0 {side}0.5" mass="{mass}" diaginertia="{inertia} {inertia} {thin}"/>
    {load}
   </body>"""

LOAD = """<body pos="0 0 {side}1"><inertial pos="0 0 0" mass="{payload}"
     diaginertia="1e-9 1e-9 1e-9"/></body>"""


def mujoco_rods(
    *, dt: float, links: int, mass: float, gravity: float, joint: str, integrator: str,
    hanging: bool = True, payload: float = 0.0,
) -> Any:  # fmt: skip
    """Compile one or two uniform rods of 1 m, with a point mass at the tip of the second."""
    import mujoco

    known = {
        "dt": repr(dt), "down": -gravity, "integrator": integrator, "joint": joint, "mass": mass,
        "inertia": mass / 12, "thin": 1e-4, "side": "-" if hanging else "", "payload": payload,
    }  # fmt: skip
    known["load"] = LOAD.format(**known) if payload else ""
    tip = SECOND.format(**known) if links == 2 else ""
    return mujoco.MjModel.from_xml_string(ROD.format(tip=tip, **known))
