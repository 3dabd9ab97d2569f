"""The WebAssembly module, called from JavaScript, gives the bits, words and errors of Python."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from browser_cases import CASES, DAMPER, RODS, START, STARTS, scene_in_python

HERE = Path(__file__).parent
PACKAGE = HERE.parents[1] / "build/wasm/package"
AT = [0.1, 1.7, 3.9]
T_LONGER = 5.0

ASKED = "PENDCORE_TEST_JAVASCRIPT" in os.environ
pytestmark = [
    pytest.mark.outside_build,
    pytest.mark.skipif(not ASKED, reason="`make elsewhere MACHINES=wasm32` builds and tests it"),
]


def run_in_javascript(*cases: dict[str, Any], flags: Sequence[str] = ()) -> list[dict[str, Any]]:
    done = subprocess.run(
        ["node", *flags, HERE / "javascript.mjs", PACKAGE],
        input=json.dumps(cases), text=True, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


def case_of(effects: Sequence[Any] = (), start: Any = START, **options: Any) -> dict[str, Any]:
    links = [pc.Link(**rod) for rod in RODS]
    scene = {"links": [asdict(link) for link in links], "effects": effects}
    return {"scene": scene, "start": start, "options": options, "at": AT}


def digest(*arrays: Any) -> str:
    return hashlib.sha256(
        b"".join(np.asarray(x, dtype=float).tobytes() for x in arrays)
    ).hexdigest()


def kept_rows(solution: pc.Solution) -> Any:
    """Angles, rates and the entries of the ledger, a row for each time."""
    return np.column_stack([solution._run.states, *solution._run.ledger.values()])


@pytest.fixture(scope="module", params=["instruction", "emulated"])
def outcomes(request: pytest.FixtureRequest) -> dict[str, dict[str, Any]]:
    flags = ["--experimental-wasm-relaxed-simd"] if request.param == "instruction" else []
    cases = [
        case_of(effects, STARTS.get(name, START), **options) | {"t_longer": T_LONGER}
        for name, (effects, options) in CASES.items()
    ]
    return dict(zip(CASES, run_in_javascript(*cases, flags=flags), strict=True))


@pytest.mark.parametrize("name", CASES)
def test_a_run_has_the_bits_of_python(name: str, outcomes: dict[str, dict[str, Any]]) -> None:
    effects, options = CASES[name]
    scene, found = scene_in_python(effects), outcomes[name]
    q0, qd0 = (STARTS.get(name, START)[of] for of in ("q0", "qd0"))
    sol = pc.simulate(scene, (0.0, 4.0), q0, qd0, on_failure="ignore", **options)
    longer = sol.resume(T_LONGER)
    assert (found["status"], found["message"]) == (sol.status, sol.message)
    assert found["accepted"] == sol.stats.accepted
    assert found["run"] == digest(sol.t, kept_rows(sol))
    assert found["longer"] == digest(longer.t, kept_rows(longer))
    if not sol._run.ledger:
        assert found["at"] == digest(sol(AT).T)
    t, q, qd = np.array([0.0]), np.array([q0]), np.array([qd0])
    start = scene._compiled
    assert found["state"] == digest(
        start.accelerations(t, q, qd), start.reactions(t, q, qd), *start.energy(t, q, qd),
        start.positions(t, q),
    )  # fmt: skip


def test_the_hash_of_a_run_is_the_recorded_one() -> None:
    case = case_of(start={"q0": [0.25 * np.pi, np.pi / 3], "t_end": 60}, method="dopri5")
    case["scene"] = {"links": [{"mass": 1, "length": 1, "center": 0.5, "inertia": 1 / 12}] * 2}
    (found,) = run_in_javascript(case)
    recorded = (HERE.parent / "cpp/trajectory_hash.txt").read_text()
    assert recorded.startswith(f"textbook {found['hash']}\n")


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
    good = case_of()
    bad = dict(good)
    for name, value in changed.items():
        bad[name] = {**good[name], **value} if isinstance(value, dict) else value
    refused, after, before = run_in_javascript(bad, good, good)
    assert message in refused["error"]
    assert after == before
    assert after["status"] == "finished"
