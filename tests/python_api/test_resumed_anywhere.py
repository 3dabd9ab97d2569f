"""Wherever and however often a run is stopped, it goes on as if it never had, in every bit.

Stops come at times, after steps, and from functions that raise; between two legs a run may have
been pickled, saved, or carried to another processor.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from fuzz.choices import FromSeed
from fuzz.drawn_run import Drawn, drawn
from pendcore import _core
from pendcore import effects as fx

METHODS = {method["name"]: method for method in _core.methods()}
INSTRUCTION_SETS = ["baseline", "x86-64-v3", "x86-64-v4"]
INSTRUCTION_SETS = INSTRUCTION_SETS[: INSTRUCTION_SETS.index(_core.instruction_set()) + 1]
OF_THE_LEG = {"max_steps", "time_limit"}
"""The options of a run that each leg is given anew."""
LINKS = [pc.Link(mass=1.0, length=0.6)]


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


def in_legs(case, choices, attempts):
    """Run up to three legs until a time or for some attempts, and then to the end."""
    start, end = case.t_span
    shares = sorted(choices.real(0, 1) for _ in range(choices.integer(0, 3)))
    sol = None
    for t_end in [*(start + share * (end - start) for share in shares), end]:
        capped = t_end != end and choices.one_of((True, False))
        how = {"max_steps": choices.integer(1, max(attempts, 1)) if capped else 10**6}
        if sol is None:
            first = Drawn(case.scene, case.q0, case.qd0, (start, t_end), case.options)
            sol = first.simulate(**how)
        else:
            sol = sol.resume(t_end, **how)
        sol = carried(sol, choices.one_of(("", "pickle", "file")))
    return sol


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_legs_end_in_the_bits_of_one_run():
    """Scenes, methods and options are any that end well; sampled runs have tests of their own."""
    compared, kinds = 0, set()
    for i in range(250):
        choices = FromSeed(f"legs/{i}")
        try:
            case = drawn(choices)
            for name in ("events", "t_eval", "time_limit"):
                case.options.pop(name, None)
            store = choices.one_of(("dense", "steps", "end"))
            case.options |= {"store": store, "max_steps": 10_000}
            whole = None if has_function(case.scene) else case.simulate()
        except ValueError:  # what was drawn does not agree
            continue
        if whole and whole.success:
            legs = in_legs(case, choices, whole.stats.accepted + whole.stats.rejected)
            assert differences(whole, legs) == [], f"legs/{i}: {case}"
            compared += 1
            kinds |= {effect.kind for effect in case.scene.effects}
    assert compared > 100
    assert kinds >= {*fx.kinds()} - {"user", "compiled_user"}


RUBBED = pc.Scene(
    links=LINKS * 2,
    effects=[
        fx.DryJointFriction(1, coulomb=0.1),
        fx.Motor(2, pd=fx.PD(kp=20.0, kd=2.0, reference=1.0), limit=0.4),
        fx.Motor(1, table=fx.Table(t=[-1, 0.2, 0.6, 9], torque=[0.5, -0.5, 1.0, 1.0])),
    ],
)


FREE = RUBBED.replace(effects=[])
# For each the scene, how it is run, and its end; the step that is cut at the end of the free runs
# is rejected.
LEGS = [
    *[
        (RUBBED, {"rtol": rtol, "ledger": ledger, "compensated": ledger}, 1.0)
        for rtol in (1e-3, 1e-8)
        for ledger in (False, True)
    ],
    (FREE, {"method": "dopri5", "first_step": 2.0}, 1.0),  # it would go beyond the end
    (FREE, {"method": "dopri5", "rtol": 1e-3}, 3.4),
    (FREE, {"method": "dopri5", "rtol": 1e-6}, 4.1),
    (FREE, {"method": "dop853", "rtol": 1e-3}, 2.3),
    (FREE, {"method": "dop853", "rtol": 1e-3}, 3.1),
]


@pytest.mark.parametrize(("scene", "how", "t_end"), LEGS)
def test_one_attempt_a_leg_is_the_same_run(scene, how, t_end):
    start, once = ([0.4, 1.0], [3.0, -2.0]), {"max_steps": 1, "on_failure": "ignore"}
    whole = pc.simulate(scene, (0, t_end), *start, **how)
    longer = pc.simulate(scene, (0, t_end + 1), *start, **how)
    assert whole.stats.limited_by_break > 2 or scene is FREE
    sol = pc.simulate(scene, (0, t_end), *start, **once, **how)
    legs = 1
    while sol.status == "max_steps":
        assert legs < 10_000
        if legs % 10 == 0 or scene is FREE:
            assert differences(longer, sol.resume(t_end + 1)) == []
        sol, legs = sol.resume(t_end, **once), legs + 1
    assert legs > 20 or scene is FREE
    assert scene is RUBBED or legs == whole.stats.accepted + whole.stats.rejected
    assert differences(whole, sol) == []


FAST = fx.Motor(1, sinusoid=fx.Sinusoid(amplitude=1e243, angular_frequency=1e154))


@pytest.mark.parametrize("store", ["steps", "dense"])
@pytest.mark.parametrize("steps", [1, 3, 7, 20])
@pytest.mark.parametrize(
    "effects",
    [[], [fx.Lock(1), FAST], [fx.DryJointFriction(2, coulomb=0.01)]],
    ids=["free", "fast motor on a locked joint", "friction"],
)
def test_to_go_on_to_where_a_run_stands_is_to_stay_there(effects, steps, store):
    """The time of the run has more digits than a double, and differs from `sol.t[-1]` by these."""
    scene = FREE.replace(effects=effects)
    start = ((1.0, 3.0), [1.0, 1.0], [0.0, 0.5])
    how = {"method": "dopri5", "store": store}
    whole = pc.simulate(scene, *start, **how)
    sol = pc.simulate(scene, *start, max_steps=steps, on_failure="ignore", **how)
    stays = sol.resume(sol.t[-1])
    assert stays.status == "finished"
    assert stays.t.tobytes() == sol.t.tobytes()
    assert stays.y.tobytes() == sol.y.tobytes()
    assert differences(whole, stays.resume(3.0)) == []


def test_a_run_whose_contact_had_no_solution_does_not_go_on():
    """A mass of 2e-308 leaves the torque that holds a joint without a finite value."""
    links = [
        pc.Link(mass=1.0, length=1.0),
        pc.Link(mass=0.5, length=4.950390459371252),
        pc.Link(mass=2.2250738585072014e-308, length=0.9054300677378225),
        pc.Link.point_mass(mass=0.5398889769668388, length=0.6640109902174399),
    ]
    effects = [fx.DryJointFriction(joint=1, coulomb=5.9951481635280395), fx.Lock(joint=4)]
    start = {
        "q0": [-1.0, -2.937960905417783, 1e-9, 0.0],
        "qd0": [0.5556183901582339, 0.0, 3.536705680691237, 3.536705680691237],
        "t_span": (-0.8563206000640616, 0.0),
        "on_failure": "ignore",
    }
    scene = pc.Scene(links=links, gravity=0.0, effects=effects)
    whole = pc.simulate(scene, **start)
    assert whole.status == "non_finite"
    stopped = pc.simulate(scene, **start, max_steps=whole.stats.accepted)
    assert stopped.status == "max_steps"
    resumed = stopped.resume(0.0, max_steps=300, on_failure="ignore")
    assert resumed.status == "non_finite"
    assert resumed._run.t_reached == whole._run.t_reached


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


@pytest.mark.few_cases
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
    for at in range(2, calls + 1, 1 + calls // 400):
        found = differences(whole, run(Raises(at)))
        # the evaluations of the step that was lost were made, and its matrices
        if found := [key for key in found if not key.endswith(("nfev", "njev", "nlu"))]:
            broken[at] = found
    assert broken == {}


STOPS = [fx.JointStop(1, (-0.3, 1.1), restitution=0.7), fx.JointStop(2, (-0.6, 0.9))]
BOUNCING = RUBBED.replace(effects=[*RUBBED.effects, *STOPS])
STIFF = BOUNCING.replace(effects=[*BOUNCING.effects, fx.ViscousJoint(2, damping=3e3)])
WATCHED = [
    pc.events.LinkAngle(2, 0.8),
    pc.events.RateZero(joint=1),
    pc.events.TipLine(point=(0.5, 0.9), normal=(1.0, 0.4)),
]


GOES_ON = """
import sys
from pathlib import Path
import pendcore as pc
for path in Path(sys.argv[1]).iterdir():
    pc.load(path).resume(1.0).save(path)
print(pc._core.instruction_set())
"""


def bounces(sol):
    return np.count_nonzero(np.diff(sol.t) == 0)


def crossings(sol):
    return sum(map(len, sol.events))


def test_other_processes_with_other_instructions_go_on_the_same(tmp_path):
    runs = {}
    for method, told in METHODS.items():
        for scene, cut in ((BOUNCING, 0.53), (STIFF, 0.2639)) if told["error_order"] else ():
            how = {"method": method, "rtol": 1e-6, "events": WATCHED, "ledger": True}
            how["compensated"] = told["compensates"]
            part, whole = (
                pc.simulate(scene, (0, t), [0.4, 0.9], [3.0, -2.0], **how) for t in (cut, 1.0)
            )
            assert whole.success
            for found in (bounces, crossings):
                assert 0 < found(part) < found(whole)
            runs[tmp_path / f"{method}, {len(scene.effects)} effects.npz"] = part, whole
    for instructions in INSTRUCTION_SETS:
        for path, (part, _) in runs.items():
            part.save(path)
        done = subprocess.run(
            [sys.executable, "-c", GOES_ON, tmp_path],
            env=os.environ | {"PENDCORE_INSTRUCTION_SET": instructions},
            text=True, capture_output=True, check=True,
        )  # fmt: skip
        assert done.stdout.strip() == instructions
        for path, (_, whole) in runs.items():
            assert differences(whole, pc.load(path)) == [], (path, instructions)


@pytest.mark.parametrize("method", ["auto", *METHODS])
def test_a_run_at_times_goes_on_where_it_was_cut_between_them(method):
    times = np.linspace(0, 1, 26)
    at, how = ([0.4, 1.0], [3.0, -2.0]), {"method": method, "ledger": True}
    how["step"] = 0.01 if method == "rk4" else None
    whole = pc.simulate(RUBBED, (0, 1), *at, t_eval=times, **how)
    how |= {"max_steps": 7, "on_failure": "ignore"}
    cut = pc.simulate(RUBBED, (0, 0.5), *at, t_eval=times[times <= 0.5], **how)
    assert cut.status == "max_steps"
    again = carried(cut, "file").resume(0.5).resume(1.0, times[times > 0.5])
    assert differences(whole, again) == []
