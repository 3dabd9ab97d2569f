"""The code that is generated from a derivation computes what the core does, in every language."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import types
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
import sympy
from derived_scenes import SCENES, STATES, Floats, Known, known
from pendcore.cli import main
from pendcore.derive import Derivation
from pendcore.derive.code.octave import _exact, written_out
from pendcore.derive.code.statements import share
from symbolic_scenes import derivation

pytestmark = pytest.mark.unsanitized

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
EXAMPLES = Path(__file__).parents[2] / "examples"
START, TIMES = [np.pi / 4, np.pi / 3], (0.0, 5.0)
octave = pytest.mark.skipif(
    not shutil.which("octave-cli"),
    reason="Octave is not installed: sh setup/debian_packages.sh octave",
)
compiler = pytest.mark.skipif(not shutil.which("g++"), reason="there is no g++")
scenes = pytest.mark.parametrize("name", SCENES)


def derived(name: str) -> Derivation:
    return derivation(SCENES[name])


@cache
def asked(name: str) -> Known:
    return known(SCENES[name])


def module(name: str) -> types.ModuleType:
    made = types.ModuleType(name)
    exec(derived(name).to_python(), made.__dict__)
    return made


def assert_close(found: Floats, wanted: Floats) -> None:
    """Compare to 1e-13 of the largest number of a state."""
    found, wanted = np.reshape(found, (STATES, -1)), np.reshape(wanted, (STATES, -1))
    off = np.abs(found - wanted).max(axis=1) / np.abs(wanted).max(axis=1)
    assert off.max() < 1e-13


@pytest.mark.few_cases
@scenes
def test_python_says_what_the_core_does_of_one_state_and_of_many(name: str) -> None:
    made, core, n = module(name), asked(name), len(SCENES[name].links)
    q, qd = core.q.T, core.qd.T
    assert_close(made.accelerations(core.t, q, qd).T, core.qdd)
    many = made.reactions(core.t, q, qd)
    assert_close(np.moveaxis(many, -1, 0), core.forces)
    assert_close(np.transpose(made.energies(core.t, q, qd)), core.energies)
    rates = made.right_hand_side(core.t, np.concatenate([q, qd]))
    assert_close(rates.T, np.hstack([core.qd, core.qdd]))
    folded = made.reactions(core.t.reshape(3, -1), q.reshape(n, 3, -1), qd.reshape(n, 3, -1))
    assert np.array_equal(folded, many.reshape(n, 2, 3, -1))
    one = made.reactions(core.t[3], core.q[3], core.qd[3])
    np.testing.assert_allclose(one, many[..., 3], rtol=0, atol=1e-13 * np.abs(one).max())


@pytest.mark.few_cases
@scenes
def test_powers_are_the_rate_of_the_energy(name: str) -> None:
    """The rate comes from small steps along the motion."""
    made, core = module(name), asked(name)
    q, qd, h = core.q.T, core.qd.T, 1e-5
    qdd = made.accelerations(core.t, q, qd)

    def total(k: float) -> Floats:
        return sum(made.energies(core.t + k * h, q + k * h * qd, qd + k * h * qdd))

    rate = (8 * (total(1) - total(-1)) - (total(2) - total(-2))) / (12 * h)
    power = sum(made.powers(core.t, q, qd).values()) if derived(name).powers else 0.0
    np.testing.assert_allclose(rate, power, rtol=0, atol=1e-8 * np.abs(core.energies).max())


def test_the_powers_are_named_by_kind_and_place() -> None:
    assert [*module("effects_2").powers(0.0, [0.3, 0.4], [1.0, 2.0])] == [
        "viscous_joint_1", "rod_drag_2", "rod_drag_2_2", "motor_1", "motor_2", "motor_1_2",
        "driven_pivot",
    ]  # fmt: skip
    assert not hasattr(module("textbook"), "powers")


def test_numbers_of_a_module_may_be_changed() -> None:
    made = module("textbook")
    made.L2, made.g = 0.6, 1.62
    links = [pc.Link(mass=1.0, length=1.0), pc.Link(mass=1.0, length=0.6)]
    wanted = pc.Scene(links=links, gravity=1.62).accelerations(0.0, START, [1.0, 2.0])
    np.testing.assert_allclose(made.accelerations(0.0, START, [1.0, 2.0]), wanted, rtol=1e-13)


def test_python_runs_in_scipy() -> None:
    integrate = pytest.importorskip("scipy.integrate")
    made, how = module("effects_2"), {"rtol": 1e-11, "atol": 1e-12, "method": "DOP853"}
    run = pc.simulate(SCENES["effects_2"], q0=START, qd0=0.0, t_span=TIMES, rtol=1e-12, atol=1e-13)
    for vectorized in (False, True):
        found = integrate.solve_ivp(
            made.right_hand_side, TIMES, [*START, 0.0, 0.0], vectorized=vectorized, **how
        )
        np.testing.assert_allclose(found.y[:, -1], run.y[:, -1], rtol=0, atol=1e-8)


MAIN = """
#include <cstdio>
#include <iostream>
{includes}
void show(double number) {{ std::printf("%.17g ", number); }}

template <class Chain>
void tell(const char* name) {{
  const Chain chain;
  typename Chain::Angles q{{}}, qd{{}};
  std::string head;
  double t = 0.0;
  while (std::cin >> head && head == name) {{
    std::cin >> t;
    typename Chain::State y{{}};
    for (std::size_t i = 0; i < 2 * Chain::links; ++i) std::cin >> y[i];
    for (std::size_t i = 0; i < Chain::links; ++i) q[i] = y[i], qd[i] = y[Chain::links + i];
    typename Chain::State dydt{{}};
    chain(y, dydt, t);
    for (double number : dydt) show(number);
    for (const auto& force : chain.reactions(t, q, qd)) show(force.x), show(force.y);
    const auto energy = chain.energy(t, q, qd);
    show(energy.kinetic), show(energy.potential);
    std::printf("\\n");
  }}
}}

int main() {{
{calls}
}}
"""


@pytest.fixture(scope="module")
def looked_at(request: pytest.FixtureRequest) -> list[str]:
    """The scenes that some test looks at."""
    run = [item.nodeid for item in request.session.items]
    return [name for name in SCENES if any(one.endswith(f"[{name}]") for one in run)]


@pytest.fixture(scope="module")
def told_by_cpp(
    looked_at: list[str], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Floats]:
    """Return dy/dt, forces and energies: all headers in one program, no warning allowed."""
    folder = tmp_path_factory.mktemp("headers")
    for name in looked_at:
        (folder / f"{name}.hpp").write_text(derived(name).to_cpp("Chain", name))
    (folder / "main.cpp").write_text(
        MAIN.format(
            includes="\n".join(f'#include "{name}.hpp"' for name in looked_at),
            calls="\n".join(f'  tell<{name}::Chain>("{name}");' for name in looked_at),
        )
    )
    command = ["g++", "-std=c++17", "-O1", *WARNINGS, "main.cpp", "-o", "main"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = []
    for name in looked_at:
        core = asked(name)
        for row in np.column_stack([core.t, core.q, core.qd]):
            lines.append(" ".join([name, *map(repr, row.tolist())]))
        lines.append("end")
    said = subprocess.run(
        [folder / "main"], input="\n".join(lines), capture_output=True, text=True, check=True
    ).stdout
    rows = iter(said.splitlines())
    return {
        name: np.array([next(rows).split() for _ in range(STATES)], float) for name in looked_at
    }


@pytest.mark.few_cases
@compiler
@pytest.mark.outside_build
@scenes
def test_cpp_compiles_without_a_warning_and_says_what_the_core_does(
    name: str, told_by_cpp: dict[str, Floats]
) -> None:
    core, told, n = asked(name), told_by_cpp[name], len(SCENES[name].links)
    assert_close(told[:, : 2 * n], np.hstack([core.qd, core.qdd]))
    assert_close(told[:, 2 * n : 4 * n], core.forces)
    assert_close(told[:, 4 * n :], core.energies)


def in_octave(script: str, folder: Path) -> list[list[float]]:
    """Run a script in a folder; return the numbers that it prints, by lines."""
    (folder / "script.m").write_text("warning('off', 'all');\n" + script)
    done = subprocess.run(
        ["octave-cli", "--quiet", "--no-init-file", "script.m"],
        cwd=folder, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return [[float(word) for word in line.split()] for line in done.stdout.splitlines()]


def woven(q: Floats, qd: Floats) -> Floats:
    """Return the state in the textbook's order, q1, q1', q2, q2', ..."""
    return np.stack([q, qd], axis=-1).reshape(*np.shape(q)[:-1], -1)


@pytest.fixture(scope="module")
def told_by_octave(
    looked_at: list[str], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Floats]:
    """Return dx by the function file, by the file written out, and by the inline function."""
    folder = tmp_path_factory.mktemp("octave")
    script = ["1;"]
    for name in looked_at:
        core, made = asked(name), derived(name)
        (folder / f"{name}.m").write_text(made.to_octave(name))
        (folder / f"{name}_long.m").write_text(written_out(made, f"{name}_long"))
        states = np.column_stack([core.t, woven(core.q, core.qd)]).tolist()
        rows = "\n".join(" ".join(map(repr, row)) for row in states)
        script += [
            made.to_octave_inline("f"),
            f"for state = [{rows}]'",
            "  t = state(1); x = state(2:end);",
            f"  printf('%.17g ', {name}(t,x), {name}_long(t,x), f(t,x)); printf('\\n');",
            "end",
        ]
    rows = iter(in_octave("\n".join(script) + "\n", folder))
    return {name: np.array([next(rows) for _ in range(STATES)]) for name in looked_at}


@pytest.mark.few_cases
@octave
@pytest.mark.outside_build
@scenes
def test_octave_says_what_the_core_does(name: str, told_by_octave: dict[str, Floats]) -> None:
    core, told = asked(name), told_by_octave[name]
    wanted = woven(core.qd, core.qdd)
    for form in np.split(told, 3, axis=1):
        assert_close(form, wanted)


@octave
@pytest.mark.outside_build
def test_the_book_s_lines_give_the_book_s_figure(tmp_path: Path) -> None:
    """RR.m runs with ode45 as printed there, then at tolerances that let digits be compared."""
    (tmp_path / "RR.m").write_text(derived("textbook").to_octave())
    (tmp_path / "g.m").write_text(derived("textbook").to_octave_inline())
    said = in_octave(
        """
        t0 = 0; tf = 5; time = [0 tf];
        x0 = [pi/4 0 pi/3 0];
        [t,xs] = ode45(@RR, time, x0);
        printf('%.17g ', [t xs]'); printf('\\n');
        fine = odeset('RelTol', 1e-10, 'AbsTol', 1e-12);
        [t,xs] = ode45(@RR, time, x0, fine);
        printf('%.17g ', xs(end,:)); printf('\\n');
        g
        [t,xs] = ode45(@(t,x) g(t,x), time, x0, fine);
        printf('%.17g ', xs(end,:)); printf('\\n');
        """.replace("        g\n", "        run('g.m');\n"),
        tmp_path,
    )
    run = pc.simulate(pc.Scene.textbook(), q0=START, qd0=0.0, t_span=TIMES)
    drawn = np.reshape(said[0], (-1, 5))
    assert len(drawn) > 30
    off = np.degrees(drawn[:, 1::2] - np.array([run(t)[:2] for t in drawn[:, 0]]))
    assert np.abs(off).max() < 1.0  # in degrees; curves that span 180 have wider lines
    for end in said[1:]:
        np.testing.assert_allclose(end, woven(run.q[-1], run.qd[-1]), rtol=0, atol=1e-7)


@pytest.mark.few_cases
@scenes
def test_generated_code_says_what_wrote_it_and_fits_a_page(name: str) -> None:
    made = derived(name)
    forms = made.to_octave(), made.to_python(), made.to_cpp(), made.to_octave_inline()
    for text in forms:
        assert f"Written by pendcore {pc.__version__} (pendcore.derive, SymPy" in text
        words = text.replace("%", " ").replace("///", " ").split()
        assert repr(SCENES[name]) in " ".join(words)
        assert "y points DOWN" in text
    for text in forms[:3]:
        assert max(map(len, text.splitlines())) <= 100


@pytest.mark.parametrize("name", ["2RR", "R R", "R-R", "", "while", "_R", "end", "dx"])
def test_names_that_a_language_refuses_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="must be a name that Octave allows"):
        derived("textbook").to_octave(name)
    if name not in ("_R", "end", "dx"):
        for given in ({"name": name}, {"namespace": name}):
            with pytest.raises(ValueError, match=r"must be a name that C\+\+ allows"):
                derived("textbook").to_cpp(**given)


@pytest.mark.parametrize(
    "given", [{"name": "State"}, {"name": "energy"}, {"name": "m1"}, {"namespace": "std"}]
)
def test_a_header_is_not_called_as_what_is_in_it(given: dict[str, str]) -> None:
    with pytest.raises(ValueError, match="is taken"):
        derived("textbook").to_cpp(**given)


def test_what_is_shared_is_computed_once_before_it_is_needed() -> None:
    q1, q2, m, L, f, h = sympy.symbols("q1 q2 m L f h", real=True)
    once = L**2 * m
    found = share([f * sympy.sin(q1), f + once], [(f, once * sympy.cos(q1 - q2)), (h, q2 * f)])
    known = {q1, q2, m, L}
    for symbol, value in found.assignments:
        assert value.free_symbols <= known
        known.add(symbol)
    assert {str(symbol) for symbol in known} >= {"f", "sin_q1", "cos_q1_q2", "e0"}
    assert h not in known  # nothing uses it
    assert found.needs == {q1, q2, m, L}
    results = [*found.results]
    for assignment in reversed(found.assignments):
        results = [result.xreplace(dict([assignment])) for result in results]
    assert results == [once * sympy.cos(q1 - q2) * sympy.sin(q1), once * sympy.cos(q1 - q2) + once]


def test_the_example_s_header_is_what_is_written_now() -> None:
    """Only the versions that wrote it are compared; others may share other subexpressions."""
    kept = (EXAMPLES / "10_generated_header.hpp").read_text()
    case = pc.read_case(EXAMPLES / "10_generated_header.toml")
    written = derivation(case.scene).to_cpp()
    (line,) = (line for line in written.splitlines() if "Written by" in line)
    if line not in kept:
        pytest.skip(f"another version than this wrote it: {line}")
    assert written == kept


ENGINEER = (EXAMPLES.parent / "docs/tutorials/derive_engineer.md").read_text()


def blocks(language: str) -> list[str]:
    """Return the blocks of code on the engineer's page."""
    return re.findall(rf"```{language}\n(.*?)```", ENGINEER, re.DOTALL)


@pytest.fixture
def as_the_page_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the engineer's folder: the page's case file, and what the page's commands write."""
    (shown,) = blocks("toml")
    assert (EXAMPLES / "10_generated_header.toml").read_text().endswith(f"\n{shown}")
    (tmp_path / "arm.toml").write_text(shown)
    monkeypatch.chdir(tmp_path)
    commands = re.findall(r"^    pendcore (derive .*)$", ENGINEER, re.MULTILINE)
    assert len(commands) == 3
    for command in commands:
        assert main(command.split()) == 0
    return tmp_path


def test_the_engineer_s_lines_of_python_run(
    as_the_page_says: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("scipy")
    written = (as_the_page_says / "arm.hpp").read_text()
    monkeypatch.syspath_prepend(as_the_page_says)
    first, second = blocks("python")
    names: dict[str, Any] = {}
    exec(first, names)
    again = (as_the_page_says / "arm.hpp").read_text()
    assert again[again.index("struct Chain") :] == written[written.index("struct Chain") :]
    exec(second, names)
    run = pc.read_case(as_the_page_says / "arm.toml").simulate()
    np.testing.assert_allclose(names["force"][..., -1], run.reactions()[-1], rtol=0, atol=1e-3)
    np.testing.assert_allclose(names["kinetic"][-1], run.energy().kinetic[-1], rtol=1e-5)
    sys.modules.pop("arm")


@compiler
@pytest.mark.outside_build
def test_the_engineer_s_lines_of_cpp_compile_and_run(as_the_page_says: Path) -> None:
    (block,) = blocks("cpp")
    (as_the_page_says / "main.cpp").write_text(block)
    for command in (["g++", "-std=c++17", *WARNINGS, "main.cpp", "-o", "main"], ["./main"]):
        done = subprocess.run(command, cwd=as_the_page_says, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    rate, acceleration, *_ = map(float, done.stdout.split())
    assert rate == acceleration != 0.0


@pytest.mark.parametrize("x", [9.807, 0.1, 1e-100, 1e300, 1 / 3])
def test_a_number_in_a_file_is_the_same_double(x: float) -> None:
    assert float(eval(str(sympy.octave_code(_exact(x))))) == x
