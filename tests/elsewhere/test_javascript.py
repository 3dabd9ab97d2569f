"""The WebAssembly module, called from JavaScript, gives the bits, words and errors of Python."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx

HERE = Path(__file__).parent
PACKAGE = HERE.parents[1] / "build/elsewhere/wasm32/package"
RODS = [{"mass": 1.0, "length": 1.0}, {"mass": 0.6, "length": 0.7}]
STOP = {"kind": "joint_stop", "joint": 2, "range": [-0.5, 0.9], "restitution": 0.6}
FRICTION = {"kind": "dry_joint_friction", "joint": 2, "coulomb": 0.1, "static": 0.2}
DAMPER = {"kind": "viscous_joint", "joint": 1, "damping": 0.05, "damping2": 0.01}
SPRING = {"kind": "torsional_spring", "joint": 2, "stiffness": 3.0, "rest_angle": 0.2}
DRAG = {"kind": "rod_drag", "link": 2, "drag_coefficient": 1.2, "diameter": 0.03, "wind": [2, -1]}
WAVE = {"amplitude": 0.5, "angular_frequency": 3.0, "phase": 0.1}
MOTOR = {"kind": "motor", "joint": 2, "sinusoid": WAVE}
TABLE = {"kind": "motor", "joint": 1, "table": {"t": [0, 1, 5], "torque": [0, 2, -1]}}
PD = {"kind": "motor", "joint": 1, "pd": {"kp": 2.0, "kd": 0.3, "reference": 1.0}, "limit": 0.7}
DRIVE = {"kind": "driven_pivot", "y": {"amplitude": 0.05, "angular_frequency": 11.0}}
ROTOR = {"kind": "rotor_inertia", "joint": 2, "armature": 0.01}
LOAD = {"kind": "payload", "mass": 0.3}
LOCK = {"kind": "lock", "joint": 2}
STIFF = {"kind": "viscous_joint", "joint": 2, "damping": 1e4}
CASES: dict[str, tuple[list[dict[str, Any]], dict[str, Any]]] = {
    "bare, dopri5": ([], {"method": "dopri5"}),
    "bare, dop853": ([], {"method": "dop853", "rtol": 1e-12}),
    "bare, taylor": ([], {"method": "taylor", "rtol": 1e-13}),
    "bare, rk4": ([], {"method": "rk4", "step": 0.01}),
    "bare, radau5": ([], {"method": "radau5", "rtol": 1e-7}),
    "bare, of itself": ([], {}),
    "bare, compensated": ([], {"method": "taylor", "compensated": True}),
    "damper": ([DAMPER], {"method": "dopri5"}),
    "spring": ([SPRING], {"method": "taylor"}),
    "drag": ([DRAG], {"method": "dop853"}),
    "motor": ([MOTOR], {}),
    "table": ([TABLE], {"method": "dopri5"}),
    "pd": ([PD], {"method": "dop853"}),
    "drive": ([DRIVE], {}),
    "rotor and load": ([ROTOR, LOAD], {}),
    "lock": ([LOCK], {}),
    "stop": ([STOP], {"method": "dopri5"}),
    "friction": ([FRICTION], {"method": "radau5", "rtol": 1e-6}),
    "stiff": ([STIFF], {"method": "dopri5-radau5", "rtol": 1e-6}),
    "many, with a ledger": ([DAMPER, DRAG, MOTOR, FRICTION, STOP], {"ledger": True}),
    "coarse": ([DAMPER], {"rtol": 1e-3, "atol": [1e-4, 1e-4, 1e-3, 1e-3], "max_step": 0.1}),
}
START = {"q0": [0.4, 0.8], "qd0": [2.0, -3.0], "t0": 0.0, "t_end": 4.0}
STARTS = {"lock": {**START, "qd0": [2.0, 2.0]}}  # a locked joint is at rest
AT = [0.1, 1.7, 3.9]
T_LONGER = 5.0

pytestmark = [
    pytest.mark.outside_build,
    pytest.mark.skipif(
        "PENDCORE_TEST_JAVASCRIPT" not in os.environ,
        reason="`make elsewhere MACHINES=wasm32` builds the module and tests it",
    ),
]


def run_in_javascript(cases: list[dict[str, Any]], *flags: str) -> list[dict[str, Any]]:
    done = subprocess.run(
        ["node", *flags, HERE / "javascript.mjs", PACKAGE],
        input=json.dumps(cases), text=True, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


def scene_for_javascript(effects: list[dict[str, Any]]) -> dict[str, Any]:
    links = [pc.Link(**rod) for rod in RODS]
    return {
        "links": [
            {"mass": x.mass, "length": x.length, "center": x.center, "inertia": x.inertia}
            for x in links
        ],
        "effects": effects,
    }


def scene_in_python(effects: list[dict[str, Any]]) -> pc.Scene:
    classes = {one["kind"]: getattr(fx, one["name"]) for one in _core.effect_descriptors()
               if hasattr(fx, one["name"])}  # fmt: skip
    parts = {"sinusoid": fx.Sinusoid, "x": fx.Sinusoid, "y": fx.Sinusoid, "pd": fx.PD,
             "table": fx.Table}  # fmt: skip
    made = []
    for effect in effects:
        values = {
            name: parts[name](**value) if isinstance(value, dict) else value
            for name, value in effect.items()
            if name != "kind"
        }
        made.append(classes[effect["kind"]](**values))
    return pc.Scene(links=[pc.Link(**rod) for rod in RODS], effects=made)


def digest(*arrays: Any) -> str:
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array, dtype=float).tobytes())
    return found.hexdigest()


def kept_rows(solution: pc.Solution) -> Any:
    """Angles, rates and the entries of the ledger, a row for each time."""
    return np.column_stack([solution.run.states, *solution.run.ledger.values()])


@pytest.fixture(scope="module", params=["instruction", "emulated"])
def outcomes(request: pytest.FixtureRequest) -> dict[str, dict[str, Any]]:
    flags = ["--experimental-wasm-relaxed-simd"] if request.param == "instruction" else []
    cases = [
        {
            "scene": scene_for_javascript(effects),
            "start": STARTS.get(name, START),
            "options": options,
            "at": AT,
            "t_longer": T_LONGER,
        }
        for name, (effects, options) in CASES.items()
    ]
    return dict(zip(CASES, run_in_javascript(cases, *flags), strict=True))


@pytest.mark.parametrize("name", CASES)
def test_a_run_has_the_bits_of_python(name: str, outcomes: dict[str, dict[str, Any]]) -> None:
    effects, options = CASES[name]
    scene = scene_in_python(effects)
    q0, qd0 = (STARTS.get(name, START)[of] for of in ("q0", "qd0"))
    sol = pc.simulate(scene, q0, qd0, (0.0, 4.0), check=False, **options)
    found = outcomes[name]
    assert (found["status"], found["message"]) == (sol.status, sol.message)
    assert found["accepted"] == sol.stats.accepted
    assert found["run"] == digest(sol.t, kept_rows(sol))
    longer = sol.resume(T_LONGER)
    assert found["longer"] == digest(longer.t, kept_rows(longer))
    if not sol.run.ledger:
        assert found["at"] == digest(sol(AT).T)
    start = scene._compiled
    t, q, qd = np.array([0.0]), np.array([q0]), np.array([qd0])
    assert found["state"] == digest(
        start.accelerations(t, q, qd), start.reactions(t, q, qd), *start.energy(t, q, qd),
        start.positions(t, q),
    )  # fmt: skip


def test_the_hash_of_a_run_is_the_recorded_one() -> None:
    scene = {"links": [{"mass": 1, "length": 1, "center": 0.5, "inertia": 1 / 12}] * 2}
    start = {"q0": [0.25 * np.pi, np.pi / 3], "t_end": 60}
    case = {"scene": scene, "start": start, "options": {"method": "dopri5"}, "at": AT}
    (found,) = run_in_javascript([case])
    recorded = HERE.parent / "cpp/trajectory_hash.txt"
    assert recorded.read_text().splitlines()[0] == f"textbook {found['hash']}"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"scene": {"links": [{"mass": -1, "length": 1, "center": 0.5, "inertia": 1}]}},
         "link 1: mass = -1.0: must be finite and > 0 (kg)"),
        ({"scene": {"effects": [{"kind": "nonsense"}]}}, 'kind = "nonsense": there is no such'),
        ({"scene": {"effects": [{"kind": "payload", "weight": 1}]}}, "weight: there is no such"),
        ({"scene": {"effects": [dict(DAMPER, joint=3)]}}, "joint = 3: must be 1 to 2"),
        ({"scene": {"effects": [dict(DAMPER, joint=1.5)]}}, "joint = 1.5: must be a whole number"),
        ({"options": {"rtol": -1}}, "rtol = -1.0: must be finite and > 0"),
        ({"options": {"method": "euler"}}, 'method = "euler": must be one of'),
        ({"options": {"tol": 1}}, "option tol: there is no such name"),
        ({"at": [9.0]}, "t = 9.0: must be within the run"),
        ({"start": {"q0": [1.0]}}, "must have 2 angles and rates"),
        ({"start": {"q0": None}}, "q and qd: must be lists of 2 numbers each"),
        ({"start": {"qd0": [0.0, "x"]}}, "qd[1] = nan: must be finite (rad/s)"),
        ({"options": {"store": "dens"}}, 'store = "dens": must be "dense", "steps"'),
        ({"options": {"max_steps": 1.5}}, "max_steps = 1.5: must be a whole number"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_words_and_the_next_run_is_right(
    changed: dict[str, Any], message: str
) -> None:
    good: dict[str, Any] = {
        "scene": scene_for_javascript([]), "start": START, "options": {}, "at": AT,
    }  # fmt: skip
    bad = dict(good)
    for name, value in changed.items():
        bad[name] = {**good[name], **value} if isinstance(value, dict) else value
    refused, after, before = run_in_javascript([bad, good, good])
    assert message in refused["error"]
    assert after == before
    assert after["status"] == "finished"
