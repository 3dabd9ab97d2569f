"""A saved solution is a plain npz; other files and damaged ones are refused by name."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core

SCENE = pc.Scene(
    links=[pc.Link(mass=1, length=0.8), pc.Link(mass=2, length=0.5, center=0.3, inertia=0.02)]
)


def empty_run() -> _core.Run:
    return _core.Run.__new__(_core.Run)


class Rebuilt:
    """Pickles as a run of any state."""

    def __init__(self, state: dict[str, object]) -> None:
        self.state = state

    def __reduce__(self) -> tuple[object, ...]:
        return empty_run, (), self.state


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 3))


def test_a_file_is_written_under_the_name_asked_for(sol, tmp_path):
    sol.save(str(tmp_path / "run"))
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_a_file_can_be_read_without_pendcore(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as file:
        entries = dict(file)
    assert all(entry.dtype.kind != "O" for entry in entries.values())
    for name in ("t", "q", "qd", "y"):
        assert np.array_equal(entries[name], getattr(sol, name))
    assert pc.read_case(str(entries["case"])) == sol.case()
    assert json.loads(str(entries["statistics"])) == sol.stats._asdict()
    assert str(entries["version"]) == pc.__version__


def test_a_file_that_is_no_solution_is_named(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    whole = (tmp_path / "run.npz").read_bytes()
    with np.load(tmp_path / "run.npz") as file:
        entries = dict(file)
    np.savez(tmp_path / "other.npz", t=[1, 2])
    np.savez(tmp_path / "no case.npz", **{**entries, "case": "README.md"})
    np.savez(tmp_path / "status.npz", **{**entries, "run.status": 5})
    np.savez(tmp_path / "sizes.npz", **{**entries, "run.states": np.zeros(4)})
    rod = pc.Case(scene=pc.Scene(links=SCENE.links[:1]), q0=0, t_span=(0, 1))
    np.savez(tmp_path / "links.npz", **{**entries, "case": rod.to_toml()})
    for name, other in {
        "gravity": sol.case().to_toml().replace("9.807", "9.8"),
        "start": sol.case().to_toml().replace("-0.4", "-0.5"),
    }.items():
        np.savez(tmp_path / f"{name}.npz", **{**entries, "case": other})
    (tmp_path / "text.npz").write_text("t = 1\n")
    (tmp_path / "empty.npz").write_bytes(b"")
    (tmp_path / "half.npz").write_bytes(whole[: len(whole) // 2])
    np.save(tmp_path / "array.npz.npy", np.zeros(3))
    for path in set(tmp_path.iterdir()) - {tmp_path / "run.npz"}:
        with pytest.raises(
            ValueError, match=rf"{path.name}: is not a solution that pendcore saved"
        ):
            pc.load(path)
    for name in ("links", "gravity", "start"):
        with pytest.raises(ValueError, match=r"\(its case is not that of its run\)"):
            pc.load(tmp_path / f"{name}.npz")
    for name in ("text.npz", "array.npz.npy", "half.npz"):
        with pytest.raises(ValueError, match=r"\(it is no npz file, or was cut short\)"):
            pc.load(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        pc.load(tmp_path / "nothing.npz")


FUNCTIONS = {
    "an address": ["compiled_user", {"address": 12345, "data": 0}],
    "a name": ["user", "print"],
    "a number": ["user", 12345],
    "a dictionary": ["user", {"function": "print"}],
}


@pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS.keys())
def test_a_function_never_comes_from_a_file(
    sol: pc.Solution, function: list[object], tmp_path: Path
) -> None:
    """An address that a file chose would be called; a saved run has none."""
    hostile = json.dumps([function])
    state = sol._run.__getstate__() | {"effects": hostile}
    with pytest.raises(ValueError, match=function[0]):
        empty_run().__setstate__(state)
    with pytest.raises(ValueError, match=function[0]):
        pickle.loads(pickle.dumps(Rebuilt(state)))
    sol.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        np.savez(tmp_path / "hostile.npz", **{**file, "run.effects": hostile})
    with pytest.raises(ValueError, match=rf"hostile.npz: is not .*{function[0]}"):
        pc.load(tmp_path / "hostile.npz")


def test_what_else_is_in_a_file_is_left_alone(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        np.savez(tmp_path / "more.npz", **{**file, "my.run.of": np.array([None])})
    assert np.array_equal(pc.load(tmp_path / "more.npz").y, sol.y)


def test_a_warning_about_the_scene_is_not_given_again(tmp_path):
    with pytest.warns(pc.PendcoreWarning):
        scene = pc.Scene(links=[pc.Link(mass=1, length=1, inertia=5)])
    run = pc.simulate(scene, q0=0, qd0=0, t_span=(0, 1))
    run.save(tmp_path / "run.npz")
    assert pc.load(tmp_path / "run.npz").scene == pickle.loads(pickle.dumps(run)).scene == scene


def test_a_solution_may_be_saved_under_any_name(tmp_path):
    sol = pc.Case.textbook().simulate()
    sol.save(tmp_path / "run.toml")
    assert np.array_equal(pc.load(tmp_path / "run.toml").q, sol.q)
