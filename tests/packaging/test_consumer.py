"""A C++ project outside this one, of docs/how_to/cpp.md, uses what the wheel installed."""

from __future__ import annotations

import re
import subprocess
from importlib.metadata import entry_points, version
from pathlib import Path

import cmake
import numpy as np
import pendcore as pc
import pytest

PAGE = (Path(__file__).parents[2] / "docs/how_to/cpp.md").read_text()
NAMES = ["end_angles", "forces", "events"]
CMAKE = Path(cmake.CMAKE_BIN_DIR) / "cmake"
INSTALLED = Path(pc.__file__).parent


def on_page(language):
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def run(*command):
    done = subprocess.run(command, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_entry_point_names_the_package_that_cmake_searches():
    (entry,) = entry_points(group="cmake.root", name="pendcore")
    root = Path(entry.load().__file__).parent
    assert (root / "lib/cmake/pendcore/pendcoreConfig.cmake").is_file()


@pytest.mark.outside_build
@pytest.mark.parametrize("flags", ["", "-O3 -march=native -ffast-math"])
def test_the_pages_project_gets_the_bits_of_python_whatever_its_flags(flags, tmp_path):
    expected = {} if flags else {"forces": forces, "events": events}
    for name, program in zip(NAMES, on_page("cpp"), strict=True):
        (tmp_path / f"{name}.cpp").write_text(program)
    (lines,) = on_page("cmake")
    lines = lines.replace("(pendcore ", "(pendcore 0.1 ")
    lines += 'message(STATUS "pendcore ${pendcore_VERSION}")\n'
    for name in expected:  # "two more lines like those above"
        lines += re.sub(
            "end_angles", name, "".join(re.findall(r"^(?:add|target)_.*\n", PAGE, re.M))
        )
    (tmp_path / "CMakeLists.txt").write_text(lines)
    # Neither the system nor Python says where Eigen is: it lies beside the package.
    where = [
        f"-Dpendcore_ROOT={INSTALLED}",
        "-DCMAKE_IGNORE_PATH=/usr/share/eigen3/cmake",
        "-DCMAKE_DISABLE_FIND_PACKAGE_Python=ON",
    ]
    build = tmp_path / "build"
    told = run(CMAKE, "-S", tmp_path, "-B", build, *where, f"-DCMAKE_CXX_FLAGS={flags}")
    assert f"pendcore {version('pendcore')}" in told
    assert "cmeel.prefix" in told
    run(CMAKE, "--build", build)

    printed = run(build / "end_angles")
    solution = pc.simulate(pc.Scene.textbook(), (0, 5), [np.pi / 4, np.pi / 3])
    assert [float.fromhex(word) for word in printed.split()] == list(solution.q[-1])
    assert f"build/end_angles   # {printed.strip()}, the bits of Python" in PAGE
    for name, in_python in expected.items():
        python = in_python()
        assert run(build / name) == python
        assert python in on_page("text")


def forces():
    """Return what forces.cpp prints, by the same run in Python."""
    rod = pc.Link(mass=1.0, length=1.0)
    effects = [pc.effects.ViscousJoint(1, 0.1), pc.effects.Motor(2, constant=0.5)]
    scene = pc.Scene(links=[rod, rod], gravity=9.81, effects=effects)
    how = {"method": "dop853", "rtol": 1e-10, "atol": 1e-12, "ledger": True}
    sol = pc.simulate(scene, (0, 5), [0.8, 1.0], t_eval=[0.0, 2.5, 5.0], **how)
    energy = sol.energy()
    rows = zip(sol.t, sol.accelerations(), sol.reactions()[:, 0], energy.total,
               energy.ledger.motor, strict=True)  # fmt: skip
    return "".join(
        f"{t:.1f} s: qdd {a:7.4f} {b:7.4f}, F_01 {x:8.4f} {y:8.4f}, "
        f"T + V {total:9.5f} J, motor {motor:8.5f} J\n"
        for t, (a, b), (x, y), total, motor in rows
    )


def events():
    """Return what events.cpp prints, by the same run in Python."""
    turn = pc.events.RateZero(link=1)
    passage = pc.events.TipLine(point=(0.0, 0.0), normal=(1.0, 0.0), direction=-1, terminal=3)
    watched = {turn: "first link turns", passage: "tip passes"}
    sol = pc.simulate(pc.Scene.textbook(), (0, 10), [0.8, 1.0], rtol=1e-10, events=[*watched])
    found = [
        f"{one.t:.6f} s: the {told} at q {one.q[0]:.6f} {one.q[1]:.6f}\n"
        for told, some in zip(watched.values(), sol.events, strict=True)
        for one in some
    ]
    return "".join(sorted(found)) + sol.message + "\n"


def test_the_library_shares_no_solver_of_eigen_with_a_program():
    """Both may bring one, for other instruction sets, and the linker keeps one of each name."""
    library = (INSTALLED / "lib/libpendcore.a").read_bytes()
    assert b"14pendcore_eigen11EigenSolver" in library
    assert b"5Eigen11EigenSolver" not in library
