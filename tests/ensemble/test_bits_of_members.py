"""A member has the bits of `pc.simulate`, whatever computes it: forty scenes by every method.

Lanes of one, four and eight are those of the instruction sets; with fewer members, fewer of them
are in use.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import ALL, assert_runs, chain, starts

SCENES = {
    "textbook": pc.Scene.textbook(),
    "stiff": chain(2).replace(effects=[pc.effects.ViscousJoint(joint=2, damping=200.0)]),
    **{
        f"{n}, {name}": chain(n, name)
        for n, names in {
            1: ["bare", "one wave", "a table that holds"],
            2: ALL,
            3: ["bare", "waves and damping", "rotors and damping", "all rows of joints"],
            4: ["a rotor between links", "a spring and the cube of a rate"],
            5: ["bare", "a function that jumps"],
            8: ["a rotor between links"],
        }.items()
        for name in names
    },
}
KEPT = [name for name in SCENES if "function" not in name]
"""Those that can be written down, and sent."""
ADAPTIVE = [one["name"] for one in pc._core.methods() if one["error_order"]]
MEMBERS = 11


def asked(scene, method):
    """Return starts and keywords of an ensemble."""
    n, how = len(scene.links), {"t_span": (0.1, 1.1), "rtol": 1e-6, "on_failure": "ignore"}
    q0 = pc.sampling.uniform(-0.9, 0.9, (MEMBERS, n), seed=1)
    if any(isinstance(effect, pc.effects.Lock) for effect in scene.effects):
        return {"q0": np.repeat(q0[:, :1], n, axis=1), "method": method, **how}
    qd0 = pc.sampling.uniform(-2.0, 2.0, (MEMBERS, n), seed=2)
    return {"q0": q0, "qd0": qd0, "method": method, **how}


def bits(found):
    """Return a hash of what an ensemble found."""
    arrays = (found.codes, found.t, found.q, found.qd)
    return hashlib.sha256(b"".join(np.ascontiguousarray(x).tobytes() for x in arrays)).hexdigest()


def of_single_runs(name, method):
    """Return the hash of the runs of `simulate`."""
    return bits(assert_runs(SCENES[name], **asked(SCENES[name], method)))


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("name", SCENES)
def test_threads_and_chunks_change_no_bit(name, method, tmp_path):
    expected = of_single_runs(name, method)

    def found(**of_the_whole):
        scene = SCENES[name]
        return bits(pc.ensemble(scene, **asked(scene, method), **of_the_whole))

    for workers in (2, 5):
        assert found(workers=workers) == expected
    if name not in KEPT:
        return
    with ThreadPoolExecutor(2) as pool:
        for chunk in (1, 7, 1000):
            assert found(executor=pool, chunk=chunk) == expected
    pytest.importorskip("zarr", exc_type=ImportError)
    store = {"store": tmp_path / "it.zarr", "chunk": 4}
    found(**store, time_limit=1e-9)  # stopped at once
    assert found(**store) == expected


@pytest.mark.parametrize("name", ["a function", "a function that jumps", "a compiled function"])
def test_members_under_functions_are_single_runs(name):
    for n in (1, 3):
        for method in ("dopri5", "radau5"):
            how = {"t_span": (0, 1), "method": method, "rtol": 1e-5}
            assert assert_runs(chain(n, name), starts(9, n, 2, 2.0), **how).success.all()


PRINT = """
import sys
import pendcore as pc
from test_bits_of_members import ADAPTIVE, KEPT, SCENES, asked, bits, starts
for name in KEPT:
    for method in ADAPTIVE:
        try:
            found = pc.ensemble(
                SCENES[name], **asked(SCENES[name], method), workers=int(sys.argv[1])
            )
        except ValueError:  # no Taylor series
            continue
        print(name, method, bits(found))
circle = starts(200, 2, 7, 3.1415926)
for method in ("dopri5", "dop853", "taylor"):
    for rtol in (1e-3, 1e-9):
        how = {"method": method, "rtol": rtol, "workers": int(sys.argv[1])}
        found = pc.ensemble(SCENES["textbook"], (0, 5), circle, 0.5, **how)
        print("the whole circle", method, rtol, bits(found))
"""


@pytest.mark.unsanitized
def test_lanes_of_every_width_and_processes_change_no_bit():
    def printed(instruction_set, workers):
        paths = os.pathsep.join(sys.path)
        return subprocess.run(
            [sys.executable, "-c", PRINT, str(workers)],
            cwd=Path(__file__).parent, check=True, capture_output=True, text=True,
            env=os.environ | {"PENDCORE_INSTRUCTION_SET": instruction_set, "PYTHONPATH": paths},
        ).stdout  # fmt: skip

    reference = printed("baseline", 2)  # one by one
    assert len(reference.splitlines()) > 100
    for instruction_set in ("x86-64-v3", "x86-64-v4"):
        for workers in (1, 5):
            assert printed(instruction_set, workers) == reference
    with ProcessPoolExecutor(2) as pool:
        for name in ("textbook", "2, one wave", "2, a stop", "3, waves and damping"):
            how = asked(SCENES[name], ADAPTIVE[0])
            found = bits(pc.ensemble(SCENES[name], **how, executor=pool, chunk=3))
            assert f"{name} {ADAPTIVE[0]} {found}" in reference


@pytest.mark.unsanitized
def test_a_cluster_changes_no_bit(cluster):
    for name in KEPT:
        how = asked(SCENES[name], "dop853")
        found = bits(pc.ensemble(SCENES[name], **how, executor=cluster, chunk=7))
        assert found == of_single_runs(name, "dop853")
