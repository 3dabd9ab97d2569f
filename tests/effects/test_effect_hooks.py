"""An effect that has other hooks than it names does not compile; the message says which."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
HEADER = (ROOT / "cpp/include/pendcore/effects/hooks.hpp").read_text()
HOOKS = re.findall(r"^  bool (\w+) = false;", HEADER, re.MULTILINE)
# It has every hook, and nothing else of an effect.
EFFECT = """
namespace pendcore::NAMESPACE {

struct Everything {
  int joint = 0;
  static constexpr Hooks hooks{ALL};

  template <class Row>
  struct Law {
    template <class At, class Loads>
    void add(const At& at, Loads& loads) const { loads.couple(at.phid()); }
    template <class At>
    typename At::Value dissipation(const At& at) const { return at.phid() * at.phid(); }
  };
  template <class Row>
  void put(Law<Row>&, int, const LinkConstants&) const {}
  template <class Row>
  void put_mode(Law<Row>&, int, int) const {}
  std::optional<Couple> couple(int) const { return {}; }
  double group() const { return 0.0; }
  bool has_wind() const { return true; }
  bool has_modes() const { return true; }
  int mode_at(double, double, double, bool) const { return 0; }
  std::vector<Guard> guards(int) const { return {}; }
  int next_mode(int, std::size_t) const { return 0; }
  double next_time(double, bool) const { return never; }
  double first_time() const { return -never; }
  double last_time() const { return never; }
  std::optional<Sinusoid> wave() const { return {}; }
  double holding_torque() const { return 0.0; }
  Everything compiled() const { return *this; }
  double potential(double) const { return 0.0; }
  void check(const std::string&) const {}
  std::vector<std::string> warnings() const { return {}; }
};

static_assert(hooks_are_named<std::variant<ViscousJoint, Everything>>);

}  // namespace pendcore::NAMESPACE
""".replace("ALL", ", ".join(f".{hook} = true" for hook in HOOKS))

MISSPELT = {
    "couple": ["couple"],
    "law": ["Law", "add", "put"],
    "group": ["group"],
    "wind": ["has_wind", "dissipation"],
    "modes": ["has_modes", "mode_at", "guards", "next_mode", "put_mode"],
    "next_time": ["next_time"],
    "span": ["first_time", "last_time"],
    "wave": ["wave"],
    "holding_torque": ["holding_torque"],
    "compiled": ["compiled"],
    "potential": ["potential"],
    "check": ["check"],
    "warnings": ["warnings"],
}
OTHERWISE_WRONG = [
    ("couple", "int joint", "int joynt"),
    ("next_time", "next_time(double, bool) const", "next_time(double, bool)"),
    ("potential", "double potential", "float potential"),
    ("modes", "next_mode(int, std::size_t)", "next_mode(int)"),
    ("couple", "std::optional<Couple> couple", "Couple couple"),
    ("next_time", ".next_time = true, ", ""),
    ("warnings", ", .warnings = true", ""),
    ("hooks", "static constexpr Hooks hooks", "static constexpr Hooks hoooks"),
]
CASES = [
    *(
        (hook, rf"\b{name}([<(]|\b {{)", rf"{name}_\1")
        for hook, names in MISSPELT.items()
        for name in names
    ),
    *((hook, re.escape(right), wrong) for hook, right, wrong in OTHERWISE_WRONG),
]


def compile_effects(tmp_path: Path, *effects: str) -> subprocess.CompletedProcess[str]:
    """Compile effects, each in a namespace of its own, to the end or the first error of each."""
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("g++ is missing")
    spaces = [text.replace("NAMESPACE", f"number_{i}") for i, text in enumerate(effects)]
    path = tmp_path / "effects.cpp"
    path.write_text('#include "pendcore/effects/registry.hpp"\n' + "".join(spaces))
    command = [compiler, "-std=c++20", "-fsyntax-only", f"-I{ROOT / 'cpp/include'}", str(path)]
    plain = os.environ | {"LC_ALL": "C"}
    return subprocess.run(command, capture_output=True, text=True, env=plain)


@pytest.mark.unsanitized
def test_an_effect_with_every_hook_compiles(tmp_path: Path) -> None:
    done = compile_effects(tmp_path, EFFECT)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def messages(tmp_path_factory: pytest.TempPathFactory) -> dict[int, str]:
    """What the compiler says of each of the cases."""
    effects = []
    for _, right, wrong in CASES:
        text, found = re.subn(right, wrong, EFFECT)
        assert found, right
        effects.append(text)
    done = compile_effects(tmp_path_factory.mktemp("hooks"), *effects)
    beginning = r"In instantiation of 'struct pendcore::CheckedHooks<pendcore::number_(\d+)::"
    of_each = re.split(beginning, done.stderr)
    return dict(zip(map(int, of_each[1::2]), of_each[2::2], strict=True))


@pytest.mark.unsanitized
@pytest.mark.parametrize("number", range(len(CASES)), ids=[f"{a}: {c}" for a, _, c in CASES])
def test_a_hook_that_is_not_as_it_is_named_does_not_compile(
    number: int, messages: dict[int, str]
) -> None:
    hook = CASES[number][0]
    expected = f"hook {hook}: " if hook in HOOKS else f"{hook}: an effect has"
    assert f"error: static assertion failed: {expected}" in messages[number]


@pytest.mark.unsanitized
def test_a_hook_that_is_misspelt_in_the_list_does_not_compile(tmp_path: Path) -> None:
    done = compile_effects(tmp_path, EFFECT.replace(".next_time", ".next_tiem"))
    assert done.returncode != 0
    assert "no non-static data member named 'next_tiem'" in done.stderr


def test_every_hook_is_tried_and_explained() -> None:
    assert list(MISSPELT) == HOOKS
    contract = HEADER.split("#pragma once")[0]
    page = (ROOT / "docs/how_to/add_an_effect.md").read_text()
    for hook in HOOKS:
        assert re.search(rf"^///     {hook} ", contract, re.MULTILINE), hook
        assert f"`.{hook}`" in page, hook
