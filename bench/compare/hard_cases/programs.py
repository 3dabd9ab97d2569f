"""The runner of each program: a scene in, a motion out."""

from __future__ import annotations

import importlib.util
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from cases import Array
from contenders.programs import find_executable

from hard_cases.outcome import Outcome

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
    hanging = True  # whether MuJoCo's angles are 0 where all rods hang, or where they stand
    translated: tuple[str, ...] = ()  # kinds of effects that MuJoCo takes as pendcore does
    settings: dict[str, dict[str, Any]] = {}  # noqa: RUF012  further ones of each program's runner

    # What acts, for each program.

    def effects(self, fx: Any) -> list[Any]:
        return []

    def rates(self, t: float, y: Array) -> Any:
        raise NotImplementedError

    def derivatives(self, t: float, y: Array) -> tuple[Any, Any]:
        """Return the rates' Jacobian, and their derivative by t, by differences."""

        def slope(move: Array, late: float, step: float) -> Array:
            ahead, behind = (self.rates(t + s * late, y + s * move) for s in (1, -1))
            return (np.array(ahead) - behind) / (2 * step)

        steps = 1e-6 * np.maximum(1e-3, np.abs(y))
        by_state = [slope(move, 0.0, move.sum()) for move in np.diag(steps)]
        return np.transpose(by_state), slope(0.0 * y, 1e-6, 1e-6)

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
            return own(**how)
        runner = getattr(self, f"by_{program}")
        return self.outcome(partial(runner, **self.settings.get(program, {}), **how))

    def outcome(self, run: Callable[[], Motion]) -> Outcome:
        return self.judged(run())

    def by_pendcore(self, **how: Any) -> Motion:
        import pendcore as pc

        links = [pc.Link(mass=self.mass, length=self.length)] * self.links
        effects = self.effects(pc.effects)
        start = self.zero + self.sign * np.array(self.start)
        speeds = self.sign * np.array(self.speeds)
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
        constant: float | None = None,
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
        spec = self.model()
        spec.option.timestep = seconds / steps if fitted else dt
        spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
        for joint in spec.joints if constant is not None else ():
            joint.solimp_friction[:3] = [0.9999, 0.9999, 0.001]
            joint.solref_friction = [constant, 1]
        model = spec.compile()
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

    def model(self) -> Any:
        """Make MuJoCo's model, with a motor in the first joint."""
        import mujoco_models
        import pendcore as pc

        down = np.array([0.0, 0.0, -1.0 if self.hanging else 1.0])
        rods = [self.mass] * self.links, [self.length] * self.links
        spec = mujoco_models.chain(*rods, self.gravity, down)
        spec.option.iterations, spec.option.tolerance = 200, 0
        mujoco_models.add_motor(spec, 1)
        for effect in self.effects(pc.effects):
            if effect.kind in self.translated:
                mujoco_models.add_effect(spec, effect, self.length * down)
        return spec

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

    def odeint_of(self, atol: float, rtol: float, first_step: float) -> tuple[Any, Any]:
        boost = odeint()
        return boost.System(self.rates, self.derivatives), boost.Settings(atol, rtol, first_step)

    def by_odeint(self, method: str, times: Any = None, **how: Any) -> Motion:
        """Integrate through the span, or ask for states at times."""
        (system, settings), start = self.odeint_of(**how), [*self.start, *self.speeds]
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if times is None:
                t, y, steps = odeint().integrate(method, system, start, *self.span, settings)
                y = np.array([y])
                return Motion(t=np.array([t]), y=y, at=lambda _: y, words=f"{steps} steps")
            y = np.array(odeint().at_times(method, system, start, times, settings))

        def at(t: Any) -> Array:
            return np.array([np.interp(t, times, column) for column in y.T]).T

        return Motion(t=np.asarray(times), y=y, at=at, words="")

    def steps_of_odeint(
        self, longest: float = 0.0, y: Any = None, t: float = 0.0, method: str = "", **how: Any
    ) -> Any:
        """Begin dopri5 with dense output; no step is longer than the longest, unless that is 0."""
        system, settings = self.odeint_of(**how)
        start = [*self.start, *self.speeds] if y is None else y
        return odeint().Dense(system, start, t, settings, longest)


@cache
def odeint() -> Any:
    """Load the module of Boost.odeint."""
    name = "hard_cases_odeint"
    found = importlib.util.spec_from_file_location(name, find_executable(f"{name}.so"))
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def crossing(at: Callable[[float], Any], low: float, high: float, value: Any) -> float:
    """Bisect between two times for that at which the sign of `value` of the state changes."""
    first = value(at(low)) > 0
    for _ in range(80):
        middle = 0.5 * (low + high)
        if (value(at(middle)) > 0) == first:
            low = middle
        else:
            high = middle
    return high
