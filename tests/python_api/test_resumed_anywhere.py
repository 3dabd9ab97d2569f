"""Wherever and however often a run is stopped, it goes on as if it never had, in every bit.

Scenes hold every kind of effect, stops come at times, after steps, and from functions that raise;
between two legs a run may have been pickled, saved, or carried to another processor.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from carried import carried as method_for
from hypothesis import given, settings
from hypothesis import strategies as st
from pendcore import _core
from pendcore import effects as fx

T = 2.5
METHODS = {method["name"]: method for method in _core.methods()}
INSTRUCTION_SETS = ["baseline", "x86-64-v3", "x86-64-v4"]
INSTRUCTION_SETS = INSTRUCTION_SETS[: INSTRUCTION_SETS.index(_core.instruction_set()) + 1]
OF_THE_LEG = {"max_steps", "time_limit"}
"""The options of a run that each leg is given anew."""
LINKS = [pc.Link(mass=1.0, length=0.6)]
CONTROLLER = fx.PD(kp=20.0, kd=2.0, reference=1.0)


def damp(t, q, qd):
    return -0.01 * qd


def effects_of(n):
    """An effect of any kind, of a size that lets the chain move."""
    joints, some = st.integers(1, n), st.floats(0.01, 0.5)
    sinusoids = st.builds(fx.Sinusoid, st.floats(0.05, 3), st.floats(0.5, 12))
    knots = st.lists(st.floats(0.05, T - 0.05), min_size=1, max_size=4, unique=True).map(
        lambda inner: [-1.0, *sorted(inner), T + 1]
    )
    tables = knots.map(lambda t: fx.Table(t, [0.5 * (-1) ** i for i in range(len(t))]))
    splines = knots.map(
        lambda t: fx.Spline(t, [0.1 * (-1) ** i for i in range(len(t))], [0.0] * len(t))
    )
    restitutions = st.sampled_from([0.0, 0.5, 1.0])
    kinds = {
        "viscous_joint": st.builds(fx.ViscousJoint, joints, some, damping2=some),
        "dry_joint_friction": st.builds(fx.DryJointFriction, joints, coulomb=some),
        "rod_drag": st.builds(fx.RodDrag, joints, some, some, wind=st.just((2.0, -1.0))),
        "torsional_spring": st.builds(fx.TorsionalSpring, joints, stiffness=some),
        "motor": st.one_of(
            st.builds(fx.Motor, joints, sinusoid=sinusoids, limit=some),
            st.builds(fx.Motor, joints, table=tables),
            st.builds(fx.Motor, joints, constant=some),
            st.builds(fx.Motor, joints, pd=st.just(CONTROLLER), limit=some),
        ),
        "rotor_inertia": st.builds(fx.RotorInertia, joints, armature=some),
        "payload": st.builds(fx.Payload, mass=some),
        "lock": st.builds(fx.Lock, joints),
        "driven_pivot": st.one_of(
            st.builds(fx.DrivenPivot, x=sinusoids), st.builds(fx.DrivenPivot, spline=splines)
        ),
        "joint_stop": st.builds(
            fx.JointStop, joints, range=st.just((-0.4, 3.0)), restitution=restitutions
        ),
        "user": st.just(fx.User(damp)),
    }
    assert {*kinds} >= {*fx.kinds()} - {"compiled_user"}
    return st.sampled_from(sorted(kinds)).flatmap(lambda kind: kinds[kind])


@st.composite
def scenes(draw):
    n = draw(st.integers(1, 3))
    drawn = draw(st.lists(effects_of(n), max_size=4))
    locked = [effect.joint for effect in drawn if effect.kind == "lock"]
    chosen = [e for e in drawn if e.kind != "lock" or locked.count(e.joint) == 1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(links=LINKS * n, effects=chosen)


@st.composite
def ways(draw):
    """How the run is made."""
    method = draw(st.sampled_from(sorted(METHODS)))
    fixed = METHODS[method]["error_order"] == 0 or draw(st.booleans())
    how = {
        "method": method,
        "store": draw(st.sampled_from(["dense", "steps", "end", "times"])),
        "ledger": draw(st.booleans()),
        "compensated": METHODS[method]["compensates"] and draw(st.booleans()),
    }
    if fixed:
        return how | {"step": draw(st.sampled_from([0.003, 0.01, 1 / 64]))}
    how["rtol"] = draw(st.sampled_from([1e-4, 1e-9]))
    if draw(st.booleans()):
        how["max_step"] = draw(st.sampled_from([0.05, 1 / 32]))
    return how


GRID = np.linspace(0, T, 26)


def has_function(scene):
    """Whether a function acts, so that its runs stay in their process."""
    return any(effect.kind == "user" for effect in scene.effects)


def state(sol):
    """All that a run keeps; if it cannot be pickled, all that can be seen of it."""
    if not has_function(sol.scene):
        return sol._run.__getstate__()
    run = sol._run
    seen = {"t": run.t, "states": run.states, "y_reached": run.y_reached, "status": run.status}
    if sol.store == "dense":
        t0, t1 = run.arguments["t_start"], run.t_reached
        seen["dense"] = sol(t0 + (t1 - t0) * np.linspace(0, 1, 50))
    return seen | run.statistics | run.ledger | run.arguments


def carried(sol, how):
    """Give back the same run, after what a user may do with it."""
    if has_function(sol.scene):
        return sol
    if how == "pickle":
        return pickle.loads(pickle.dumps(sol))
    if how == "file":
        with tempfile.TemporaryDirectory() as folder:
            sol.save(Path(folder) / "run.npz")
            return pc.load(Path(folder) / "run.npz")
    return sol


def same(a, b):
    """Whether two entries are the same, in every bit."""
    if isinstance(a, np.ndarray):
        return a.tobytes() == b.tobytes()
    return a == b or (a != a and b != b)  # not given is NaN


def differences(one, other):
    """Name what is not the same, of all that a run keeps."""
    a, b = state(one), state(other)
    return [key for key in a if key not in OF_THE_LEG and not same(a[key], b[key])]


def in_legs(scene, start, legs, sign, **how):
    """Run each leg until a time or for a number of steps, and then to the end."""
    done, sol = -1.0, None
    for t_end, max_steps, between in [*sorted(legs, key=lambda leg: leg[0]), (T, None, "")]:
        new = GRID[(done < GRID) & (t_end >= GRID)]
        cap = {} if max_steps is None else {"max_steps": max_steps}
        times = {"t_eval": sign * new} if how["store"] == "times" and len(new) else {}
        if sol is None:
            sol = pc.simulate(scene, (0, sign * t_end), *start, **how, **cap, **times)
        else:
            sol = sol.resume(sign * t_end, **cap, **times)
        done, sol = t_end, carried(sol, between)
    return sol


ENDS = st.one_of(st.floats(0.0, T), st.sampled_from([*GRID]))
CAPS = st.one_of(st.none(), st.integers(1, 200))
LEGS = st.lists(st.tuples(ENDS, CAPS, st.sampled_from(["", "pickle", "file"])), max_size=4)


ANGLES, RATES = st.floats(0.2, 2.9), st.sampled_from([0.0, 2.0, -5.0])


@settings(max_examples=150)
@given(scenes(), ways(), LEGS, ANGLES, RATES, st.booleans())
def test_legs_end_in_the_bits_of_one_run(scene, how, legs, angle, rate, backward):
    n = len(scene.links)
    locked = {effect.joint for effect in scene.effects if effect.kind == "lock"}
    rates = [rate] * n if 1 not in locked else [0.0] * n
    one_way = {"dry_joint_friction", "joint_stop"}
    sign = -1.0 if backward and not one_way & {e.kind for e in scene.effects} else 1.0
    start = ([angle] * n, rates)
    how["method"] = method_for(how["method"], scene)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)  # tables and legs end early
        whole = in_legs(scene, start, [], sign, **how)
        broken = in_legs(scene, start, legs, sign, **how)
    found = differences(whole, broken)
    if not whole.success:  # it tried again, in vain, and that was counted
        found = [key for key in found if not key.endswith(("nfev", "njev", "nlu", "rejected"))]
    assert found == []


RUBBED = pc.Scene(
    links=LINKS * 2,
    effects=[
        fx.DryJointFriction(1, coulomb=0.1),
        fx.Motor(2, pd=CONTROLLER, limit=0.4),
        fx.Motor(1, table=fx.Table(t=[-1, 0.2, 0.6, 9], torque=[0.5, -0.5, 1.0, 1.0])),
    ],
)


@pytest.mark.parametrize("t_end", [4.0, -2.0])
@pytest.mark.parametrize("cut", [0.3, 0.9, 0.99])
def test_a_ledger_does_not_go_on_without_the_spline_that_moves_the_pivot(cut, t_end):
    """All joints are locked, so that the drive's power alone knows that the spline has ended."""
    spline = fx.Spline(t=[-1.0, 1.0, 3.5], x=[0.1, -0.1, 0.1], y=[0.0] * 3)
    scene = pc.Scene(links=LINKS, effects=[fx.DrivenPivot(spline=spline), fx.Lock(1)])
    with pytest.warns(pc.PendcoreWarning, match="its spline goes from"):
        whole = pc.simulate(scene, q0=1.0, t_span=(0, t_end), ledger=True, on_failure="ignore")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        begun = pc.simulate(scene, q0=1.0, t_span=(0, cut * t_end), ledger=True)
    assert (whole.status, whole.t[-1]) == ("non_finite", 3.5 if t_end > 0 else -1.0)
    assert np.isfinite(whole.energy().ledger.residual).all()
    assert differences(whole, begun.resume(t_end, on_failure="ignore")) == []


class Raises:
    """A law that raises at one of its calls, once."""

    def __init__(self, at):
        self.left = at

    def __call__(self, t, q, qd):
        self.left -= 1
        if self.left == 0:
            raise LookupError("once")
        return -0.02 * qd


@pytest.mark.parametrize("ledger", [False, True])
def test_whichever_call_of_a_users_function_raises_the_run_goes_on_the_same(ledger, method):
    """Also at a switch, where the law that follows is being looked for."""

    def run(law):
        scene = RUBBED.replace(effects=[*RUBBED.effects, fx.User(law)])
        try:
            return pc.simulate(scene, q0=[0.4, 1.0], qd0=[3.0, -2.0], t_span=(0, 1.0), **how)
        except LookupError as stop:
            so_far = getattr(stop, "solution", None)
            return so_far.resume(1.0) if so_far else run(law)  # before there was a run

    how = {"method": method, "rtol": 1e-4, "ledger": ledger}
    never = Raises(0)
    whole = run(never)
    calls = -never.left
    assert calls > 200
    assert whole.stats.limited_by_break > 2
    broken = {}
    for at in range(2, calls + 1):
        found = differences(whole, run(Raises(at)))
        # the evaluations of the step that was lost were made, and its matrices
        if found := [key for key in found if not key.endswith(("nfev", "njev", "nlu"))]:
            broken[at] = found
    assert broken == {}


def enough(fraction):
    raise LookupError


def stopped(way, **how):
    """Return a run that was stopped from outside, somewhere on its way."""
    if way == "Ctrl-C":
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    elif way == "progress":
        how["progress"] = enough
    else:
        how |= {"time_limit": 0.1, "on_failure": "ignore"}
    try:
        return pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 3000.0), **how)
    except (KeyboardInterrupt, LookupError) as stop:
        return stop.solution


@pytest.mark.parametrize("way", ["Ctrl-C", "progress", "time_limit"])
@pytest.mark.parametrize("compensated", [False, True])
def test_a_run_that_was_stopped_from_outside_goes_on_the_same(way, compensated):
    how = {"max_step": 1e-3, "store": "end", "compensated": compensated}
    begun = stopped(way, **how)
    assert begun.status != "finished"
    reached = float(begun.t[-1])
    assert 0 < reached < 3000
    whole = pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, reached + 1.0), **how)
    assert differences(whole, pickle.loads(pickle.dumps(begun)).resume(reached + 1.0)) == []


STOPS = [fx.JointStop(1, (-0.3, 1.1), restitution=0.7), fx.JointStop(2, (-0.6, 0.9))]
BOUNCING = RUBBED.replace(effects=[*RUBBED.effects, *STOPS])
STIFF = BOUNCING.replace(effects=[*BOUNCING.effects, fx.ViscousJoint(2, damping=3e3)])
WATCHED = [
    pc.events.LinkAngle(2, 0.8),
    pc.events.RateZero(joint=1),
    pc.events.TipLine(point=(0.5, 0.9), normal=(1.0, 0.4)),
]


@pytest.mark.parametrize(
    ("scene", "cut"), [(BOUNCING, 0.53), (STIFF, 0.2639)], ids=["bouncing", "stiff"]
)
@pytest.mark.parametrize("method", [name for name in METHODS if METHODS[name]["error_order"]])
def test_another_process_with_other_instructions_goes_on_the_same(method, scene, cut, tmp_path):
    how = {"method": method, "rtol": 1e-6, "events": WATCHED, "ledger": True}
    how["compensated"] = METHODS[method]["compensates"]
    whole, begun = (pc.simulate(scene, (0, t), [0.4, 0.9], [3.0, -2.0], **how) for t in (1.0, cut))
    assert whole.success
    bounces = [np.count_nonzero(np.diff(sol.t) == 0) for sol in (begun, whole)]
    assert 0 < bounces[0] < bounces[1]
    found = [sum(map(len, sol.events)) for sol in (begun, whole)]
    assert 0 < found[0] < found[1]
    begun.save(tmp_path / "begun.npz")
    program = (
        "import sys, pendcore as pc; from pendcore import _core\n"
        "pc.load(sys.argv[1]).resume(1.0).save(sys.argv[2]); print(_core.instruction_set())"
    )
    for instructions in INSTRUCTION_SETS:
        done = subprocess.run(
            [sys.executable, "-c", program, tmp_path / "begun.npz", tmp_path / "whole.npz"],
            env=os.environ | {"PENDCORE_INSTRUCTION_SET": instructions},
            text=True, capture_output=True, check=True,
        )  # fmt: skip
        assert done.stdout.strip() == instructions
        assert differences(whole, pc.load(tmp_path / "whole.npz")) == []
