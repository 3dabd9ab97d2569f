"""A member has the bits of `pc.simulate`, whatever computes it: twenty scenes by every method.

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

E = pc.effects
RODS = [pc.Link(mass=1.0, length=0.8), pc.Link(mass=0.6, length=1.1)]
WAVE = E.Sinusoid(3.0, 6.0, 0.4)


def chain(n):
    return [pc.Link(mass=1.0 + 0.1 * i, length=1.0 - 0.1 * i) for i in range(n)]


SCENES = {
    "textbook": pc.Scene.textbook(),
    **{
        name: pc.Scene(links=RODS, effects=effects)
        for name, effects in {
            "payload": [E.Payload(mass=0.3)],
            "rotors": [E.RotorInertia(joint=1, armature=0.1), E.RotorInertia(joint=2, armature=1)],
            "damping": [E.ViscousJoint(joint=1, damping=0.1)],
            "cubic damping": [E.ViscousJoint(joint=2, damping=0.1, damping3=0.02)],
            "spring": [E.TorsionalSpring(joint=2, stiffness=5.0, rest_angle=0.1)],
            "motor": [E.Motor(joint=1, sinusoid=WAVE)],
            "controller": [E.Motor(joint=2, pd=E.PD(kp=9.0, kd=1.0, reference=0.5))],
            "motor at its limit": [E.Motor(joint=1, sinusoid=WAVE, limit=2.0)],
            "pivot": [E.DrivenPivot(y=E.Sinusoid(0.05, 20.0))],
            "friction": [E.DryJointFriction(joint=2, coulomb=0.2, static=0.3)],
            "stop": [E.JointStop(joint=2, range=(-1.9, 1.9), restitution=0.5)],
            "lock": [E.Lock(joint=2)],
            "stiff": [E.ViscousJoint(joint=2, damping=200.0)],
        }.items()
    },
    "one link": pc.Scene(links=chain(1)),
    "one link with a motor": pc.Scene(links=chain(1), effects=[E.Motor(joint=1, sinusoid=WAVE)]),
    "three links": pc.Scene(links=chain(3)),
    "three links with torques": pc.Scene(
        links=chain(3),
        effects=[E.Motor(joint=3, sinusoid=WAVE), E.ViscousJoint(joint=3, damping=0.1)],
    ),
    "three links with rotors": pc.Scene(
        links=chain(3), effects=[E.RotorInertia(joint=j, armature=0.1) for j in (1, 3)]
    ),
    "four links with a rotor": pc.Scene(
        links=chain(4),
        effects=[E.RotorInertia(joint=2, armature=0.1), E.ViscousJoint(joint=2, damping=0.1)],
    ),
    "four links": pc.Scene(links=chain(4), effects=[E.TorsionalSpring(joint=4, stiffness=3.0)]),
    "five links": pc.Scene(links=chain(5)),
    "eight links": pc.Scene(links=chain(8), effects=[E.RotorInertia(joint=3, armature=0.1)]),
    "drag": pc.Scene(
        links=chain(2), effects=[E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.1)]
    ),
}  # fmt: skip
ADAPTIVE = [one["name"] for one in pc._core.methods() if one["error_order"]]
MEMBERS = 11


def asked(scene, method):
    """Return starts and keywords of an ensemble."""
    n = len(scene.links)
    locked = any(isinstance(effect, E.Lock) for effect in scene.effects)
    q0 = pc.sampling.uniform(-0.9, 0.9, (MEMBERS, n), seed=1)
    qd0 = 0.0 if locked else pc.sampling.uniform(-2.0, 2.0, (MEMBERS, n), seed=2)
    if locked:
        q0 = np.repeat(q0[:, :1], n, axis=1)
    return q0, qd0, {"t_span": (0.1, 1.1), "method": method, "rtol": 1e-6, "on_failure": "ignore"}


def bits(found):
    """Return a hash of what an ensemble found."""
    arrays = (found.codes, found.t, found.q, found.qd)
    return hashlib.sha256(b"".join(np.ascontiguousarray(x).tobytes() for x in arrays)).hexdigest()


def one_by_one(scene, method):
    """Return the hash of the runs of `pc.simulate`."""
    q0, qd0, how = asked(scene, method)
    rates = np.broadcast_to(qd0, q0.shape)
    runs = [
        pc.simulate(scene, q0=angles, qd0=rate, store="end", **how)
        for angles, rate in zip(q0, rates, strict=True)
    ]
    codes = np.array([pc._core.member_statuses.index(run.status) for run in runs], np.uint8)
    ends = [np.array([getattr(run, name)[-1] for run in runs]) for name in ("t", "q", "qd")]
    return hashlib.sha256(b"".join(x.tobytes() for x in (codes, *ends))).hexdigest()


def ensemble(scene, method, **of_the_whole):
    q0, qd0, how = asked(scene, method)
    return pc.ensemble(scene, q0=q0, qd0=qd0, **how, **of_the_whole)


def allowed(scene, method):
    """Whether the scene can be run by the method: not all effects have Taylor series."""
    q0, qd0, how = asked(scene, method)
    try:
        pc.simulate(scene, q0=q0[0], qd0=np.broadcast_to(qd0, q0.shape)[0], **how)
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
        assert bits(ensemble(scene, method, workers=workers)) == expected
    with ThreadPoolExecutor(2) as pool:
        for chunk in (1, 7, 1000):
            assert bits(ensemble(scene, method, executor=pool, chunk=chunk)) == expected
    pytest.importorskip("zarr", exc_type=ImportError)
    store = tmp_path / "it.zarr"
    ensemble(scene, method, store=store, chunk=4, time_limit=1e-9)  # stopped at once
    assert bits(ensemble(scene, method, store=store, chunk=4)) == expected


PRINT = """
import test_bits_of_members as t
for name, scene in t.SCENES.items():
    for method in t.ADAPTIVE:
        if t.allowed(scene, method):
            print(name, method, t.bits(t.ensemble(scene, method, workers=2)))
"""


@pytest.mark.unsanitized
def test_lanes_of_every_width_and_processes_change_no_bit():
    def printed(instruction_set):
        return subprocess.run(
            [sys.executable, "-c", PRINT], cwd=Path(__file__).parent, check=True,
            env=os.environ | {"PENDCORE_INSTRUCTION_SET": instruction_set},
            capture_output=True, text=True,
        ).stdout  # fmt: skip

    reference = printed("baseline")  # one by one
    assert len(reference.splitlines()) > 100
    assert printed("x86-64-v3") == reference
    assert printed("x86-64-v4") == reference
    with ProcessPoolExecutor(2) as pool:
        for name in ("textbook", "motor", "stop", "three links with torques"):
            found = ensemble(SCENES[name], ADAPTIVE[0], executor=pool, chunk=3)
            assert f"{name} {ADAPTIVE[0]} {bits(found)}" in reference


@pytest.mark.unsanitized
def test_a_cluster_changes_no_bit(cluster):
    for scene in SCENES.values():
        found = ensemble(scene, "dop853", executor=cluster, chunk=7)
        assert bits(found) == one_by_one(scene, "dop853")
