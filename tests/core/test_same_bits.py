"""The same scene gives the same bits: on any processor, from any build, whatever is stored."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import cmake
import pytest
from pendcore import _core

ROOT = Path(__file__).parents[2]
CMAKE = Path(cmake.CMAKE_BIN_DIR) / "cmake"
SETS = ["baseline", "x86-64-v3", "x86-64-v4"]

RECORDED = (ROOT / "tests/cpp/trajectory_hash.txt").read_text()
SCENES = """
import ctypes, ctypes.util, hashlib, numpy as np, pendcore as pc
from pendcore import _core
book = pc.Scene.textbook()
rod = pc.Scene(links=[pc.Link(mass=1.3, length=0.8)], gravity=9.80665)
floating = pc.Scene(links=book.links, gravity=0.0)
fx = pc.effects
bouncing = pc.Scene(links=[pc.Link(mass=1.0, length=0.7)] * 2, effects=[
    fx.JointStop(1, range=(-0.4, 1.9), restitution=0.7), fx.JointStop(2, range=(-0.5, 0.9)),
    fx.DryJointFriction(2, coulomb=0.1, static=0.2)])
stopped = pc.Scene(links=bouncing.links, effects=bouncing.effects[:2])
driven = pc.Scene(links=[rod.links[0]] * 5, effects=[
    fx.DrivenPivot(x=fx.Sinusoid(0.1, 7.0)), fx.RotorInertia(4, 0.1), fx.Lock(3),
    fx.ViscousJoint(2, 0.1, 0.2, 0.3), fx.Motor(1, sinusoid=fx.Sinusoid(2.0, 3.0))])
damped = pc.Scene(links=bouncing.links, effects=[fx.ViscousJoint(2, damping=1e5)])
events = [pc.events.LinkAngle(2, 1.5), pc.events.TipLine(point=(0.3, 0.9), normal=(1.0, 0.5))]
"""
# The runs have angles near and far, a chaotic start and denormal rates; everything that a run
# leaves behind is compared.
# A scene with a table and a spline is made here, after what a test does in between.
RUNS = """
tabled = pc.Scene(links=bouncing.links, effects=[
    fx.Motor(1, table=fx.Table((0.0, 0.3, 1.1, 4.0), (0.7, -2.3, 1.9, 0.1)), limit=1.7),
    fx.DrivenPivot(spline=fx.Spline((0.0, 0.7, 1.3, 4.0), (0, 0.1, 0.05, 0.2), (0, 0.03, 0.1, 0)))])
runs = [
    pc.simulate(tabled, (0, 3), [0.4, 0.8]),
    pc.simulate(book, (0, 60), [0.7853981633974483, 1.0471975511965976]),
    pc.simulate(book, (0, 30), [-1.4, -1.1], rtol=1e-12),
    pc.simulate(book, (5, 0), [3e8, -2e7], [30, -70]),
    pc.simulate(rod, (0, 30), -1.2, rtol=1e-6),
    pc.simulate(floating, (0, 1e159), [0.3, 0.9], [3e-160, -1e-160]),
    pc.simulate(floating, (0, 1e-3), [0.3, 0.9], [4e-310, -1e-310], atol=0),
    pc.simulate(book, (0, 30), [-1.4, -1.1], max_step=1e-2, compensated=True),
    *(pc.simulate(book, (0, 5), [0.8, 1.0], method=method["name"], step=0.01)
      for method in _core.methods()),
    *(pc.simulate(bouncing, (0, 4), [0.4, 0.8], [2, -3], events=events, method=method["name"])
      for method in _core.methods() if method["error_order"] and "taylor" not in method["name"]),
    pc.simulate(stopped, (0, 4), [0.4, 0.8], [2, -3], events=events, method="taylor"),
    *(pc.simulate(driven, (0, 4), 0.4, method="taylor", rtol=rtol) for rtol in (1e-3, 1e-13)),
    *(pc.simulate(damped, (0, 1), [0.8, 1.0], events=events, method=method, compensated=True)
      for method in ("radau5", "dopri5-radau5", "dop853-radau5", "taylor-radau5")),
]
print(_core.instruction_set())
for sol in runs:
    assert sol.success
    digest = hashlib.sha256()
    energy, dense = sol.energy(), sol._run.__getstate__()["dense_coefficients"]
    for part in (sol.t, sol.y, dense, sol.accelerations(), sol.reactions(), sol.positions(),
                 energy.kinetic, energy.potential):
        digest.update(np.ascontiguousarray(part).tobytes())
    for one in [one for found in sol.events or () for one in found]:
        digest.update(np.array([one.t, *one.y]).tobytes())
    print(sol.method, digest.hexdigest())
"""


def hash_of_runs(between: str = "", after: str = "", **environment: str) -> tuple[str, list[str]]:
    """Run them in a process of its own; return its instruction set and a hash of each run."""
    done = subprocess.run(
        [sys.executable, "-c", SCENES + between + RUNS + after],
        env=os.environ | environment, text=True, capture_output=True, check=True,
    )  # fmt: skip
    used, *hashes = done.stdout.splitlines()
    return used, [f"run {i}, {line}" for i, line in enumerate(hashes)]


def test_every_instruction_set_gives_the_same_bits():
    best = SETS.index(_core.instruction_set())
    found = [hash_of_runs(PENDCORE_INSTRUCTION_SET=name) for name in SETS[: best + 1]]
    assert [used for used, _ in found] == SETS[: best + 1]
    for _, hashes in found:
        assert hashes == found[0][1]


def test_a_library_that_flushes_denormals_to_zero_changes_no_bit(tmp_path):
    source, library = tmp_path / "fast.c", tmp_path / "fast.so"
    source.write_text("double half(double x) { return 0.5 * x; }\n")
    fast = ["-ffast-math", "-shared", "-fPIC"]
    subprocess.run(["g++", "-x", "c", *fast, source, "-o", library], check=True)
    load = f"""
half = ctypes.CDLL({str(library)!r}).half
half.restype, half.argtypes = ctypes.c_double, [ctypes.c_double]
assert half(1e-310) == 0.0, "the processor does not flush to zero"
"""
    still = "\nassert half(1e-310) == 0.0, 'what the run found was not put back'\n"
    assert hash_of_runs(load, still) == hash_of_runs()


def test_another_rounding_of_the_host_program_changes_no_bit():
    upward = """
libm = ctypes.CDLL(ctypes.util.find_library("m"))
assert libm.fesetround(0x800) == 0
"""
    still = "\nassert libm.fegetround() == 0x800, 'what the run found was not put back'\n"
    assert hash_of_runs(upward, still) == hash_of_runs()


@pytest.mark.parametrize("used", SETS)
def test_the_long_doubles_of_the_host_program_stay_numbers(used):
    """MMX registers are those of x87: a kernel that touches one leaves the x87 stack full.

    That makes a NaN of every long double, and of what LAPACK computes with them; only some kernels
    of some instruction sets would do that, so all are called.
    """
    script = """
import numpy as np, pendcore as pc
fx = pc.effects
wave = fx.Sinusoid(1.0, 3.0)
effects = [
    fx.Motor(1, sinusoid=wave), fx.ViscousJoint(1, 0.1, 0.1, 0.1), fx.RodDrag(1, 1.2, 0.05),
    fx.TorsionalSpring(1, 1.0), fx.Motor(1, pd=fx.PD(1.0, 1.0, 0.0)), fx.RotorInertia(1, 1.0),
    fx.Payload(1.0), fx.Lock(1), fx.DrivenPivot(x=wave), fx.DryJointFriction(1, 0.1)]
some = [effects[:k] for k in range(len(effects) + 1)] + [[one] for one in effects]
for n in (1, 2, 3, 7):
    start = np.linspace(0.5, 1.0, n)
    for acting in some:
        scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * n, effects=acting)
        for method in ("auto", "dopri5", "radau5"):
            pc.simulate(scene, (0, 0.1), start, method=method, ledger=True)
        scene.accelerations(0.0, start, start)
        thirds = [np.longdouble(1) / 3 for _ in range(9)]  # as many as x87 has registers, and one
        assert np.isfinite(thirds).all(), (n, acting)
"""
    environment = os.environ | {"PENDCORE_INSTRUCTION_SET": used}
    subprocess.run([sys.executable, "-W", "ignore", "-c", script], env=environment, check=True)


@pytest.mark.whole
@pytest.mark.outside_build
@pytest.mark.parametrize(
    ("flags", "options", "sets"),
    [
        # No other build shows the warnings of the baseline alone; one is wrong at -O1 (GCC 12).
        ("-O1 -Wno-maybe-uninitialized -DPENDCORE_BASELINE_ONLY",
         ["-DPENDCORE_WARNINGS_AS_ERRORS=ON"], SETS[:1]),
        ("-O3", [], SETS),
    ],
    ids=["O1, the baseline alone", "O3"],
)  # fmt: skip
def test_every_optimisation_gives_the_same_bits(flags, options, sets, tmp_path):
    """The same lines are compared by ctest in builds with -O2 and, under sanitizers, with -Og."""
    always = ["-DPENDCORE_PYTHON=OFF", "-DPENDCORE_TESTS=ON", "-DCMAKE_BUILD_TYPE=None"]
    given = [*always, *options, f"-DCMAKE_CXX_FLAGS={flags}"]
    configure = [CMAKE, "-S", ROOT, "-B", tmp_path, *given]
    build = [CMAKE, "--build", tmp_path, "--target", "trajectory_hash", "-j", "2"]
    for command in (configure, build):
        subprocess.run(command, capture_output=True, text=True, check=True)
    for used in sets[: SETS.index(_core.instruction_set()) + 1]:
        printed = subprocess.run(
            [tmp_path / "tests/cpp/trajectory_hash"], text=True, capture_output=True, check=True,
            env=os.environ | {"PENDCORE_INSTRUCTION_SET": used},
        ).stdout  # fmt: skip
        assert printed == RECORDED, used


def test_a_misspelt_instruction_set_is_refused():
    with pytest.raises(subprocess.CalledProcessError) as failed:
        hash_of_runs(PENDCORE_INSTRUCTION_SET="avx2")
    assert "must be baseline, x86-64-v3 or x86-64-v4" in failed.value.stderr
