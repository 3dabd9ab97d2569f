"""A C++ project outside this one uses what the wheel installed."""

from __future__ import annotations

import re
import subprocess
from importlib.metadata import entry_points, version
from pathlib import Path

import cmake
import numpy as np
import pendcore as pc
import pytest

PROJECT = Path(__file__).parents[1] / "consumer"
PAGE = (PROJECT.parents[1] / "docs/how_to/cpp.md").read_text()
CMAKE = Path(cmake.CMAKE_BIN_DIR) / "cmake"


def run(*command: str | Path) -> str:
    done = subprocess.run(command, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_entry_point_names_the_package_that_cmake_searches() -> None:
    (entry,) = entry_points(group="cmake.root", name="pendcore")
    root = Path(entry.load().__file__).parent
    assert (root / "lib/cmake/pendcore/pendcoreConfig.cmake").is_file()


@pytest.mark.outside_build
@pytest.mark.parametrize("flags", ["", "-O3 -march=native -ffast-math"])
def test_an_outside_project_gets_the_bits_of_python_whatever_its_flags(
    flags: str, tmp_path: Path
) -> None:
    root = Path(pc.__file__).parent
    # Neither the system nor Python says where Eigen is: it lies beside the package.
    hidden = [
        "-DCMAKE_IGNORE_PATH=/usr/share/eigen3/cmake",
        "-DCMAKE_DISABLE_FIND_PACKAGE_Python=ON",
    ]
    where = [f"-Dpendcore_ROOT={root}", *hidden]
    configured = run(CMAKE, "-S", PROJECT, "-B", tmp_path, *where, f"-DCMAKE_CXX_FLAGS={flags}")
    assert f"pendcore {version('pendcore')}" in configured
    assert "cmeel.prefix" in configured
    run(CMAKE, "--build", tmp_path)

    printed = [float.fromhex(word) for word in run(tmp_path / "end_angles").split()]
    solution = pc.simulate(pc.Scene.textbook(), q0=[np.pi / 4, np.pi / 3], t_span=(0, 5))
    assert printed == list(solution.q[-1])
    assert run(tmp_path / "forces") == forces_of_python()
    assert run(tmp_path / "events") == events_of_python()


def test_the_library_shares_no_solver_of_eigen_with_a_program() -> None:
    """Both may bring one, for other instruction sets, and the linker keeps one of each name."""
    library = (Path(pc.__file__).parent / "lib/libpendcore.a").read_bytes()
    solver = b"11EigenSolver"
    assert b"14pendcore_eigen" + solver in library
    assert b"5Eigen" + solver not in library


def forces_of_python() -> str:
    """Return what forces.cpp prints, by the same run in Python."""
    rod = pc.Link(mass=1.0, length=1.0)
    effects = [
        pc.effects.ViscousJoint(joint=1, damping=0.1), pc.effects.Motor(joint=2, constant=0.5)
    ]  # fmt: skip
    scene = pc.Scene(links=[rod, rod], gravity=9.81, effects=effects)
    solution = pc.simulate(
        scene, q0=[0.8, 1.0], qd0=0, t_span=(0, 5), t_eval=[0.0, 2.5, 5.0],
        method="dop853", rtol=1e-10, atol=1e-12, ledger=True,
    )  # fmt: skip
    energy = solution.energy()
    rows = zip(
        solution.t, solution.accelerations(), solution.reactions(), energy.total,
        energy.ledger.motor, strict=True,
    )  # fmt: skip
    return "".join(
        f"{t:.1f} s: qdd {qdd[0]:8.4f} {qdd[1]:8.4f}, F_01 {forces[0, 0]:8.4f} "
        f"{forces[0, 1]:8.4f}, T + V {total:9.5f} J, motor {motor:8.5f} J\n"
        for t, qdd, forces, total, motor in rows
    )


def events_of_python() -> str:
    """Return what events.cpp prints, by the same run in Python."""
    turn = pc.events.RateZero(link=1)
    passage = pc.events.TipLine(point=(0.0, 0.0), normal=(1.0, 0.0), direction=-1, terminal=3)
    solution = pc.simulate(
        pc.Scene.textbook(),
        q0=[0.8, 1.0],
        qd0=0,
        t_span=(0, 10),
        rtol=1e-10,
        events=[turn, passage],
    )
    found = [
        (one.t, told, *one.q)
        for told, events in zip(("first link turns", "tip passes"), solution.events, strict=True)
        for one in events
    ]
    rows = [f"{t:.6f} s: the {told} at q {q1:.6f} {q2:.6f}" for t, told, q1, q2 in sorted(found)]
    return "\n".join([*rows, solution.message, ""])


def test_the_page_shows_this_project_and_what_it_prints() -> None:
    programs = [
        (PROJECT / f"{name}.cpp").read_text() for name in ("end_angles", "forces", "events")
    ]
    assert re.findall(r"```cpp\n(.*?)```", PAGE, re.DOTALL) == programs
    for printed in (forces_of_python(), events_of_python()):
        assert f"```text\n{printed}```" in PAGE
    lines = (PROJECT / "CMakeLists.txt").read_text().splitlines()
    for line in (line for line in lines if "end_angles" in line):
        assert f"\n{line}\n" in PAGE
    solution = pc.simulate(pc.Scene.textbook(), q0=[np.pi / 4, np.pi / 3], t_span=(0, 5))
    shown = re.search(r"build/end_angles +# (\S+) (\S+), the bits", PAGE)
    assert shown
    assert [float.fromhex(word) for word in shown.groups()] == list(solution.q[-1])
