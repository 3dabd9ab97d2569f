"""Every example runs, and says what it promises; the C++ ones say the same as their twins."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path

import cmake
import matplotlib.pyplot as plt
import pendcore as pc
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
SAYS = {
    "01_textbook": ("q_1(5) = 1.083066", "q_2(5) = 0.538460"),
    "02_reactions": ("F_01 = [ 0.         -0.28571429]", "F_12 = [0.         0.07142857]"),
    "03_case_file": ("heavy hammer", "finished", "t_end = 20.0"),
    "04_measured_rigs": (
        "measured triple pendulum: within 0.0074 rad",
        "swing 2: within 0.0243 rad",
    ),
    "06_events": (
        "from 100 degrees: turns over at t = 6.543738 s",
        "link 2 at  20 degrees: 1876 points, up to 7.93 rad/s",
    ),
    "08_accuracy": (
        "asked 1.0e-08, achieved",
        "refused: error = 1e-16: not reached",
        "for 1e-08 of the length over 10 s take",
    ),
    "09_textbook_line_by_line": (
        "IA = m1*L1**2/3",
        "ddq1 = 10.811024, ddq2 = -8.308720 rad/s^2",
        "q1(5) = 1.083067, q2(5) = 0.538461 rad",
    ),
    "05_own_effect": ("q_1(30) = -89.6420 deg", "work of the water 12.308263 J"),
    "10_generated_header": (
        "q(5) = -6.5358320, -6.1258751 rad",
        "energy gained 20.272427 J, brought in by motor and damper 20.272427 J",
    ),
    "11_flip_map": (
        "3600 members (60, 60)",
        "1084 finished, 2516 event",
        "of the pixels are resolved",
    ),
    "07_stick_slip": (  # tests/models/hybrid_chain.py says the same
        "both joints rest from 5.543172 s to 6.047550 s",
        "phi_1 = 0.53079695, phi_2 = -0.47785263 rad",
    ),
}
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(example LANGUAGES CXX)
find_package(pendcore REQUIRED)
add_executable(example {source})
target_link_libraries(example PRIVATE pendcore::pendcore)
"""


def said_by(path, capsys):
    runpy.run_path(str(path), run_name="__main__")
    plt.close("all")
    return capsys.readouterr().out


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_says_what_it_promises(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    said = said_by(path, capsys)
    for promise in SAYS[path.stem]:
        assert promise in said


@pytest.mark.outside_build
@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.cpp")), ids=lambda path: path.name)
def test_a_cpp_example_says_the_same_as_its_python_twin(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("CMakeLists.txt").write_text(PROJECT.format(source=path))
    program = str(Path(cmake.CMAKE_BIN_DIR) / "cmake")
    package = Path(pc.__file__).parent
    where = [f"-Dpendcore_ROOT={package}", f"-DPython_EXECUTABLE={sys.executable}"]
    for command in (
        [program, "-B", "build", *where],
        [program, "--build", "build"],
        ["build/example"],
    ):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == said_by(path.with_suffix(".py"), capsys)
