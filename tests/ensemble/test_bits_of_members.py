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
from members_and_runs import ALL, chain

SCENES = {
    "textbook": pc.Scene.textbook(),
    "stiff": chain(2).replace(effects=[pc.effects.ViscousJoint(joint=2, damping=200.0)]),
    **{
        f"{n}, {name}": chain(n, name)
        for n, names in {
            1: ["bare", "one wave", "a table that holds"],
            2: [name for name in ALL if name != "a function"],
            3: ["bare", "waves and damping", "rotors and damping", "all rows of joints"],
            4: ["a rotor between links", "a spring and the cube of a rate"],
            5: ["bare", "a function"],
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
    n = len(scene.links)
    locked = any(isinstance(effect, pc.effects.Lock) for effect in scene.effects)
    q0 = pc.sampling.uniform(-0.9, 0.9, (MEMBERS, n), seed=1)
    qd0 = 0.0 if locked else pc.sampling.uniform(-2.0, 2.0, (MEMBERS, n), seed=2)
    if locked:
        q0 = np.repeat(q0[:, :1], n, axis=1)
    return q0, qd0, {"t_span": (0.1, 1.1), "method": method, "rtol": 1e-6, "on_failure": "ignore"}


def digest(*arrays):
    return hashlib.sha256(b"".join(np.ascontiguousarray(x).tobytes() for x in arrays)).hexdigest()


def bits(scene, method, **of_the_whole):
    """Return a hash of what an ensemble finds."""
    q0, qd0, how = asked(scene, method)
    found = pc.ensemble(scene, q0=q0, qd0=qd0, **how, **of_the_whole)
    return digest(found.codes, found.t, found.q, found.qd)


def one_by_one(scene, method):
    """Return the hash of the runs of `pc.simulate`."""
    q0, qd0, how = asked(scene, method)
    rates = np.broadcast_to(qd0, q0.shape)
    runs = [
        pc.simulate(scene, q0=angles, qd0=rate, store="end", **how)
        for angles, rate in zip(q0, rates, strict=True)
    ]
    codes = np.array([pc._core.member_statuses.index(run.status) for run in runs], np.uint8)
    return digest(
        codes, *(np.array([getattr(run, x)[-1] for run in runs]) for x in ("t", "q", "qd"))
    )


def allowed(scene, method):
    """Whether the scene can be run by the method: not all effects have Taylor series."""
    try:
        one_by_one(scene, method)
    except ValueError:
        return False
    return True


@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("name", SCENES)
def test_threads_and_chunks_change_no_bit(name, method, tmp_path):
    scene = SCENES[name]
    if not allowed(scene, method):
        pytest.skip("not all effects have Taylor series")
    expected = one_by_one(scene, method)
    for workers in (1, 2, 5):
        assert bits(scene, method, workers=workers) == expected
    if name not in KEPT:
        return
    with ThreadPoolExecutor(2) as pool:
        for chunk in (1, 7, 1000):
            assert bits(scene, method, executor=pool, chunk=chunk) == expected
    pytest.importorskip("zarr", exc_type=ImportError)
    store = {"store": tmp_path / "it.zarr", "chunk": 4}
    bits(scene, method, **store, time_limit=1e-9)  # stopped at once
    assert bits(scene, method, **store) == expected


PRINT = """
import sys
import test_bits_of_members as t
for name in t.KEPT:
    for method in t.ADAPTIVE:
        if t.allowed(t.SCENES[name], method):
            print(name, method, t.bits(t.SCENES[name], method, workers=int(sys.argv[1])))
"""


@pytest.mark.unsanitized
def test_lanes_of_every_width_and_processes_change_no_bit():
    def printed(instruction_set, workers):
        return subprocess.run(
            [sys.executable, "-c", PRINT, str(workers)], cwd=Path(__file__).parent, check=True,
            env=os.environ | {
                "PENDCORE_INSTRUCTION_SET": instruction_set,
                "PYTHONPATH": os.pathsep.join(sys.path),
            },
            capture_output=True, text=True,
        ).stdout  # fmt: skip

    reference = printed("baseline", 2)  # one by one
    assert len(reference.splitlines()) > 100
    for instruction_set in ("x86-64-v3", "x86-64-v4"):
        for workers in (1, 5):
            assert printed(instruction_set, workers) == reference
    with ProcessPoolExecutor(2) as pool:
        for name in ("textbook", "2, one wave", "2, a stop", "3, waves and damping"):
            found = bits(SCENES[name], ADAPTIVE[0], executor=pool, chunk=3)
            assert f"{name} {ADAPTIVE[0]} {found}" in reference


@pytest.mark.unsanitized
def test_a_cluster_changes_no_bit(cluster):
    for name in KEPT:
        found = bits(SCENES[name], "dop853", executor=cluster, chunk=7)
        assert found == one_by_one(SCENES[name], "dop853")
