"""The core's use of the processor's registers does not disturb the rest of the program.

An MMX register that is used and not cleared makes a NaN of every long double, and of what LAPACK
computes with them; only some kernels of some instruction sets would do that, so all are called.
"""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.outside_build

PROGRAM = """
import numpy as np, pendcore as pc
fx = pc.effects
sinusoid = fx.Sinusoid(1.0, 0.2)
effects = [
    fx.ViscousJoint(1, 0.1, 0.1, 0.1), fx.RodDrag(1, 1.0, 0.1), fx.TorsionalSpring(1, 1.0),
    fx.Motor(1, sinusoid=sinusoid), fx.Motor(1, pd=fx.PD(1.0, 1.0, 0.0)), fx.RotorInertia(1, 1.0),
    fx.Payload(1.0), fx.Lock(1), fx.DrivenPivot(x=sinusoid), fx.DryJointFriction(1, 0.1),
]
rod = pc.Link(mass=1.0, length=1.0)
for n in (1, 2, 3, 7):
    for acting in ([], effects, *([effect] for effect in effects)):
        scene = pc.Scene(links=[rod] * n, effects=acting)
        start = np.linspace(0.5, 1.0, n)
        pc.simulate(scene, (0, 0.1), start, ledger=True)
        scene.accelerations(0.0, start, start)
        thirds = [np.longdouble(1) / 3 for _ in range(9)]  # as many as x87 has registers, and one
        assert np.isfinite(thirds).all(), (n, acting)
"""


@pytest.mark.parametrize("instruction_set", ["baseline", "x86-64-v3", "x86-64-v4"])
def test_long_doubles_stay_numbers(instruction_set: str) -> None:
    environment = os.environ | {"PENDCORE_INSTRUCTION_SET": instruction_set}
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
