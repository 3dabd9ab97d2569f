"""The runner of each program: a scene in, a motion out."""

from __future__ import annotations

import signal
import subprocess
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from contenders.conversation import find_executable, words

from hard_cases.outcome import NoReturn, Outcome
from hard_cases.rods import Array, mujoco_rods

UPRIGHT, HANGING = -np.pi / 2, np.pi / 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Times (k,) and states (k, 2n), angles and rates in the scene's coordinates.

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

    `start` has angles, `speeds` rates, in coordinates y with q = zero + sign y, where q runs from
    +x towards +y, y down. The programs run the scene as below, unless a case has its own way;
    `judged` makes an outcome of a motion.
    """

    zero, sign = 0.0, 1.0

    links = 1
    mass, length = 3.0, 1.0  # of each; one such rod has the moment of inertia 1 about its end
    gravity = 0.0
    start: tuple[float, ...] = (0.0,)
    speeds: tuple[float, ...] = (0.0,)
    span: tuple[float, float] = (0.0, 1.0)
    joint = ""  # attributes of MuJoCo's joints
    hanging = True  # whether MuJoCo's angles are 0 where all rods hang, or where they stand
    system: tuple[str, Sequence[float]] = ("", ())  # Boost.odeint's name of it, and parameters
    settings: dict[str, dict[str, Any]] = {}  # noqa: RUF012  further ones of each program's runner

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

    # The programs. A case that has its own way with one has a method of the program's name.

    def run(self, program: str, **how: Any) -> Outcome:
        own = getattr(self, program, None)
        if own:
            found: Outcome = own(**how)
            return found
        runner = getattr(self, f"by_{program}")
        return self.outcome(partial(runner, **self.settings.get(program, {}), **how))

    def outcome(self, run: Callable[[], Motion]) -> Outcome:
        return self.judged(run())

    def by_pendcore(self, **how: Any) -> Motion:
        import pendcore as pc

        links = [pc.Link(mass=self.mass, length=self.length)] * self.links
        effects = self.effects(pc.effects)
        start, speeds = (
            self.zero + self.sign * np.array(self.start),
            self.sign * np.array(self.speeds),
        )
        how = {"q0": start, "qd0": speeds, "t_span": self.span, **how}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a negative coefficient
            scene = pc.Scene(links=links, gravity=self.gravity, effects=effects)
            sol = pc.simulate(scene, on_failure="ignore", **how)
        steps = f"{sol.stats.accepted} steps"
        words = steps if sol.success else f"status `{sol.status}`: {steps}"
        events = [event.t for event in sol.events[0]] if how.get("events") else []

        def own(states: Array) -> Array:
            q, qd = np.split(states, 2)
            return self.sign * np.vstack([q - self.zero, qd]).T

        return Motion(
            t=sol.t, y=own(sol.y), at=lambda t: own(sol(t)), words=words, success=sol.success,
            events=events, raw=sol,
        )  # fmt: skip

    def by_scipy(self, **how: Any) -> Motion:
        from scipy.integrate import solve_ivp

        start = [*self.start, *self.speeds]
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sol = solve_ivp(self.rates, self.span, start, **how)
        return Motion(
            t=sol.t, y=sol.y.T, at=lambda t: sol.sol(t).T, words=f"{sol.t.size - 1} steps",
            success=sol.success, events=sol.t_events[0] if how.get("events") else (), raw=sol,
        )  # fmt: skip

    def by_mujoco(
        self, dt: float, integrator: str = "implicitfast", *, watched: bool = False,
        every: float = 0.0, fitted: bool = False, seconds: float | None = None,
        constant: float | None = None, **joint: Any,
    ) -> Motion:  # fmt: skip
        """Step through the span, or some seconds of it; keep all states, or one `every` so often.

        `fitted` makes the step a part of the span, and keeps its end alone. A time `constant`, s,
        makes friction as hard as it gets. With `watched` the user has disabled MuJoCo's
        restart from the start, and looks for warnings after each step; others see them at the end.
        """
        import mujoco

        seconds = seconds or self.span[1] - self.span[0]
        steps = round(seconds / dt)
        each = steps if fitted else max(1, round(every / dt))
        if constant is not None:
            joint |= {"solimpfriction": "0.9999 0.9999 0.001", "solreffriction": f"{constant} 1"}
        model = self.model(seconds / steps if fitted else dt, integrator, **joint)
        data = mujoco.MjData(model)
        data.time = self.span[0]
        zero, turn = self.mujocos_zero
        data.qpos[:] = np.diff(zero + turn * np.array(self.start), prepend=0.0)
        data.qvel[:] = np.diff(turn * np.array(self.speeds), prepend=0.0)
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
        phi, phid = (np.cumsum(half, axis=0) for half in np.split(np.array(columns), 2))
        y = turn * np.vstack([phi - zero, phid])
        return Motion(
            t=t, y=y.T, at=lambda s: np.array([np.interp(s, t, column) for column in y]).T,
            words=warned or f"{steps} steps", success=not warned,
        )  # fmt: skip

    def model(self, dt: float, integrator: str, **joint: Any) -> Any:
        attributes = " ".join([self.joint, *(f'{key}="{value}"' for key, value in joint.items())])
        return mujoco_rods(
            dt=dt, links=self.links, mass=self.mass, gravity=self.gravity, joint=attributes,
            integrator=integrator, hanging=self.hanging,
        )  # fmt: skip

    @property
    def mujocos_zero(self) -> tuple[float, float]:
        """Return z and s of MuJoCo's angles of links, z + s y; they turn the other way if hanging.

        Without gravity only changes of angle matter.
        """
        if not self.gravity:
            return 0.0, 1.0
        return (
            (HANGING - self.zero, -self.sign) if self.hanging else (self.zero - UPRIGHT, self.sign)
        )

    def task(self, method: str, atol: float, rtol: float, first_step: float) -> Odeint:
        start = (*self.start, *self.speeds)
        return Odeint(*self.system, method, atol, rtol, first_step, start)

    def by_odeint(self, times: Any = None, **how: Any) -> Motion:
        """Integrate through the span, or ask for states at times."""
        task = self.task(**how)
        if times is None:
            told = task.ask("integrate", *self.span)
            t, y, steps = np.array(told["t"]), np.array([told["y"]]), told["steps"][0]
            return Motion(t=t, y=y, at=lambda _: y, words=f"{steps:.0f} steps")
        y = np.reshape(task.ask("states", len(times), *times)["states"], (len(times), -1))

        def at(t: Any) -> Array:
            return np.array([np.interp(t, times, column) for column in y.T]).T

        return Motion(t=np.asarray(times), y=y, at=at, words="")


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
