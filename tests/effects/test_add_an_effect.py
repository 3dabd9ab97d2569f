"""What docs/how_to/add_an_effect.md has you write is an effect, and stands where it says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import cmake
import pendcore as pc
import pytest
from reference import effects
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import uniform_rod

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/how_to/add_an_effect.md").read_text()
STEPS, OTHER_LAWS = PAGE.split("## Other kinds of law")
HEADER, ROW_LAW, LIST, SOURCE, *LINES_OF_CPP = re.findall(r"```cpp\n(.*?)```", STEPS, re.DOTALL)
GIVEN = ROOT / "cpp/include/pendcore/effects"
EFFECTS = ROOT / "cpp/src/effects"
LAW, *LINES_OF_PYTHON = re.findall(r"```python\n(.*?)```", STEPS, re.DOTALL)
# With a peak of 0.3 N m at 2 rad/s: twice the peak times x/(1 + x^2) for x times that rate.
COUPLES = {-5.0: 0.6 * 2.5 / 7.25, 0.0: 0.0, 2.0: -0.3}
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(effect LANGUAGES CXX)
find_package(pendcore REQUIRED)
add_executable(effect effect.cpp magnetic_brake.cpp)
target_include_directories(effect BEFORE PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PRIVATE_HEADERS})
target_link_libraries(effect PRIVATE pendcore::pendcore)
"""
PROGRAM = """
#include <cstdio>
#include <pendcore/pendcore.hpp>
#include "dynamics/row.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/magnetic_brake.hpp"
using namespace pendcore;

template <class Row>
void print(const Effect& effect, double qd) {
  EddyLaw<Row> law;
  each_field(law, std::get<EddyLaw<double>>(*effect->law(0, {})),
             [](Row& all, double one) { set_lane(all, 0, one); });
  const RowAt<Row> at{.q = Constants<Row>::of(1.0), .qd = Constants<Row>::of(qd), .t = 0.0};
  RowLoads<Row> loads;
  law.add(at, loads);
  std::printf("%a\\n", lane(loads.couples, 0));
}

int main() {
  const Effect effect = MagneticBrake{.joint = 1, .peak = 0.3, .critical_rate = 2.0};
  for (const double qd : {-5.0, 0.0, 2.0}) {
    print<double>(effect, qd);
    print<Pair>(effect, qd);
  }
  try {
    Effect(MagneticBrake{.joint = 1, .peak = -1.0, .critical_rate = 1.0})->check("effect 1: ");
  } catch (const std::invalid_argument& refused) {
    std::puts(refused.what());
  }
}
"""


def test_its_law_in_the_reference_has_the_couple_of_an_eddy_current_brake() -> None:
    names = dict(vars(effects))
    exec(LAW, names)
    for rate, couple in COUPLES.items():
        loads, bodies = Loads(1), [uniform_rod(1.0, 1.0)]
        brake = names["MagneticBrake"](joint=1, peak=0.3, critical_rate=2.0)
        brake.act(Instant(bodies=bodies, gravity=0.0, q=[1.0], qd=[rate]), loads)
        assert float(loads.couples[0].value) == pytest.approx(couple, rel=1e-15)


def test_lines_like_those_to_add_stand_where_it_says() -> None:
    registry = (GIVEN.parent / "effects.hpp").read_text()
    laws = (ROOT / "tests/reference/effects.py").read_text()
    include, name = LINES_OF_CPP
    for line, text in (
        (include, registry),
        (f"{name.split()[0]} ", registry),
        (LINES_OF_PYTHON[0], laws),
    ):
        assert line.replace("magnetic_brake", "motor").replace("MagneticBrake", "Motor") in text
    names = ["joint", *re.findall(r"\.name = \"(\w+)\"", HEADER)]
    names.remove("MagneticBrake")
    assert re.findall(r"^    (\w+): ", LINES_OF_PYTHON[-1], re.MULTILINE) == names
    sentence = re.search(r'\.sentence = ("A .*?")', HEADER)[1]
    assert f'""{sentence}""' in LINES_OF_PYTHON[-1]


def test_the_parts_of_the_contract_that_it_names_are_there() -> None:
    elsewhere = {
        "BOOKED": "docs/generators/write_effects.py",
        "LOSSES": "tests/reference/rig.py",
        "SMOOTH": "tests/effects/test_ledger.py",
    }
    for name, file in elsewhere.items():
        assert name in (ROOT / file).read_text()
    headers = "".join(p.read_text() for folder in (GIVEN, EFFECTS) for p in folder.glob("*.hpp"))
    named = set(re.findall(r"`(\w+)[(`]", OTHER_LAWS))
    assert {"couple", "potential", "warnings", "next_mode"} <= named
    assert {x for x in named - {*elsewhere} if not re.search(rf"\b{x}\b", headers)} == set()
    for file in re.findall(r"`(\w+\.[hc]pp)`", OTHER_LAWS):
        assert any((folder / file).exists() for folder in (GIVEN, EFFECTS)), file


@pytest.mark.outside_build
def test_its_header_compiles_and_has_the_same_couple(tmp_path: Path) -> None:
    # Under another name: whoever has followed the page has one in the core.
    laws = (EFFECTS / "laws.hpp").read_text()
    assert LIST.replace(", EddyLaw<Row>", "") in laws or LIST in laws
    law = ROW_LAW.replace("EddyLaw", "LawOfThePage")
    laws = laws.replace("/// The list of laws.", f"{law}\n/// The list of laws.")
    laws = re.sub(r"(using LawOn = [^;]*)>;", r"\1, LawOfThePage<Row>>;", laws)
    for file, text in (
        ("effects/laws.hpp", laws),
        ("pendcore/effects/magnetic_brake.hpp", HEADER),
        ("magnetic_brake.cpp", SOURCE),
        ("effect.cpp", PROGRAM),
        ("CMakeLists.txt", PROJECT),
    ):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        renamed = text.replace("MagneticBrake", "BrakeOfThePage").replace("EddyLaw", "LawOfThePage")
        (tmp_path / file).write_text(text if text is laws else renamed)
    program = str(Path(cmake.CMAKE_BIN_DIR) / "cmake")
    where = [
        f"-Dpendcore_ROOT={Path(pc.__file__).parent}",
        f"-DPython_EXECUTABLE={sys.executable}",
        f"-DPRIVATE_HEADERS={ROOT / 'cpp/src'}",
    ]
    build = str(tmp_path / "build")
    for command in (
        [program, "-S", str(tmp_path), "-B", build, *where],
        [program, "--build", build],
        [f"{build}/effect"],
    ):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    *couples, refused = done.stdout.splitlines()
    expected = [couple for couple in COUPLES.values() for _ in ("double", "Pair")]
    assert [float.fromhex(word) for word in couples] == pytest.approx(expected, rel=1e-15)
    assert refused == "effect 1: peak = -1.0: must be finite and >= 0 (N m)"
