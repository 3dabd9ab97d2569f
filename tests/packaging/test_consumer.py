"""A C++ project outside this one uses what the wheel installed."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.metadata import entry_points, version
from pathlib import Path

import cmake
import numpy as np
import pendcore as pc
import pytest

PROJECT = Path(__file__).parents[1] / "consumer"
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
    where = [f"-Dpendcore_ROOT={root}", f"-DPython_EXECUTABLE={sys.executable}"]
    configured = run(CMAKE, "-S", PROJECT, "-B", tmp_path, *where, f"-DCMAKE_CXX_FLAGS={flags}")
    assert f"pendcore {version('pendcore')}" in configured
    run(CMAKE, "--build", tmp_path)

    printed = [float.fromhex(word) for word in run(tmp_path / "end_angles").split()]
    solution = pc.simulate(pc.Scene.textbook(), q0=[np.pi / 4, np.pi / 3], t_span=(0, 5))
    assert printed == list(solution.q[-1])


def test_the_page_shows_this_project_and_what_it_prints() -> None:
    page = (PROJECT.parents[1] / "docs/how_to/cpp.md").read_text()
    assert f"```cpp\n{(PROJECT / 'end_angles.cpp').read_text()}```" in page
    for line in (PROJECT / "CMakeLists.txt").read_text().splitlines()[-2:]:
        assert f"\n{line}\n" in page
    solution = pc.simulate(pc.Scene.textbook(), q0=[np.pi / 4, np.pi / 3], t_span=(0, 5))
    shown = re.search(r"build/end_angles +# (\S+) (\S+), the bits", page)
    assert shown
    assert [float.fromhex(word) for word in shown.groups()] == list(solution.q[-1])
