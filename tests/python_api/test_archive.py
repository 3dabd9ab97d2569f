"""A saved solution is a plain npz; other files, damaged and hostile ones are refused by name."""

from __future__ import annotations

import io
import json
import tracemalloc
import zipfile

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core

SCENE = pc.Scene(
    links=[pc.Link(mass=1, length=0.8), pc.Link(mass=2, length=0.5, center=0.3, inertia=0.02)]
)
HUGE = 100_000_000


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 3))


@pytest.fixture(scope="module")
def saved(sol, tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "run.npz"
    sol.save(path)
    return path


@pytest.fixture(scope="module")
def entries(saved):
    with np.load(saved, allow_pickle=False) as file:
        return dict(file)


# The last three are as long as the system takes.
NAMES = ["run", "run.toml", "run.npz", *(f"{x}.npz" for x in ("a" * 246, "é" * 123, "摆" * 82))]


@pytest.mark.parametrize("name", NAMES, ids=range(6))
def test_a_file_is_written_under_the_name_asked_for(sol, name, tmp_path):
    sol.save(str(tmp_path / name))
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert np.array_equal(pc.load(tmp_path / name).y, sol.y)


def test_a_file_can_be_read_without_pendcore(sol, entries):
    assert all(entry.dtype.kind != "O" for entry in entries.values())
    for name in ("t", "q", "qd", "y"):
        assert np.array_equal(entries[name], getattr(sol, name))
    assert pc.read_case(str(entries["case"])) == sol.case()
    assert json.loads(str(entries["statistics"])) == sol.stats._asdict()
    assert str(entries["version"]) == pc.__version__


def test_an_archive_of_another_make_with_other_entries_is_read_for_what_it_holds(
    sol, saved, entries, tmp_path
):
    turned = {name: np.array(values, order="F") for name, values in entries.items()}
    np.savez_compressed(tmp_path / "a.npz", **turned, **{"my.run.of": np.array([None])})
    np.savez(tmp_path / "numpy.npz", **entries)
    assert (tmp_path / "numpy.npz").stat().st_size == saved.stat().st_size
    assert (tmp_path / "a.npz").stat().st_size < saved.stat().st_size
    assert np.array_equal(pc.load(tmp_path / "a.npz").y, sol.y)


def test_arrays_of_members_are_read_in_their_order_and_may_be_changed(tmp_path):
    starts = pc.sampling.uniform(-1, 1, (3, 2, 2), seed=1)
    found = pc.ensemble(pc.Scene.textbook(), q0=starts, t_span=(0, 1))
    found.save(tmp_path / "all.npz")
    with np.load(tmp_path / "all.npz") as file:
        turned = {name: np.array(values, order="F") for name, values in file.items()}
    np.savez(tmp_path / "turned.npz", **turned)
    again = pc.load(tmp_path / "turned.npz")
    assert np.array_equal(again.q, found.q)
    again.q[0] = 0.0


def bytes_of(write, *given, **named):
    file = io.BytesIO()
    write(file, *given, **named)
    return file.getvalue()


NO_NPZ = r"\(it is no npz file, or was cut short\)"
NOT_ITS_CASE = r"\(its case is not that of its run\)"
ROD = pc.Case(scene=pc.Scene(links=SCENE.links[:1]), q0=0, t_span=(0, 1)).to_toml()
NO_SOLUTION = {
    "a text": (lambda whole: b"t = 1\n", NO_NPZ),
    "an array": (lambda whole: bytes_of(np.save, np.zeros(3)), NO_NPZ),
    "arrays": (lambda whole: bytes_of(np.savez, t=[1, 2]), ""),
    "half of it": (lambda whole: whole[: len(whole) // 2], NO_NPZ),
    "nothing": (lambda whole: b"", ""),
    "no case": ({"case": "README.md"}, ""),
    "no status": ({"run.status": 5}, ""),
    "states of another size": ({"run.states": np.zeros(4)}, ""),
    "other links": ({"case": ROD}, NOT_ITS_CASE),
    "another gravity": (("9.807", "9.8"), NOT_ITS_CASE),
    "another start": (("-0.4", "-0.5"), NOT_ITS_CASE),
}


@pytest.mark.parametrize("what", NO_SOLUTION)
def test_a_file_that_is_no_solution_is_named(sol, saved, entries, what, tmp_path):
    change, why = NO_SOLUTION[what]
    path = tmp_path / "a.npz"
    if callable(change):
        path.write_bytes(change(saved.read_bytes()))
    else:
        if isinstance(change, tuple):
            change = {"case": sol.case().to_toml().replace(*change)}
        np.savez(path, **{**entries, **change})
    with pytest.raises(ValueError, match=rf"a\.npz: is not a solution that pendcore saved.*{why}"):
        pc.load(path)
    with pytest.raises(FileNotFoundError):
        pc.load(tmp_path / "nothing.npz")


FUNCTIONS = {
    "an address": ["compiled_user", {"address": 12345, "data": 0}],
    "a name": ["user", "print"],
    "a number": ["user", 12345],
    "a dictionary": ["user", {"function": "print"}],
}


@pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS.keys())
def test_a_function_never_comes_from_a_file(sol, entries, function, tmp_path):
    """An address that a file chose would be called; a saved run has none."""
    hostile = json.dumps([function])
    state = sol._run.__getstate__() | {"effects": hostile}
    with pytest.raises(ValueError, match=function[0]):
        _core.Run.__new__(_core.Run).__setstate__(state)
    np.savez(tmp_path / "hostile.npz", **{**entries, "run.effects": hostile})
    with pytest.raises(ValueError, match=rf"hostile.npz: is not .*{function[0]}"):
        pc.load(tmp_path / "hostile.npz")


def head(shape, descr="<f8"):
    told = {"shape": shape, "fortran_order": False, "descr": descr}
    return bytes_of(np.lib.format.write_array_header_1_0, told)


SHAPES = [(HUGE // 8,), (10**15,), (2,), (), (-1,), (-1, -4), (2**62, 4)]
TOO_MUCH = r"unpacks to 10\d,\d+,\d+: at most 100"
# For each the entry, its content, the number of zeros after it, and what is said.
HOSTILE = {
    f"bomb: {name}": (name, head((HUGE // 8,)), HUGE, TOO_MUCH)
    for name in ("run.states", "case", "error.t", "run.of_nobody")
}
HOSTILE |= {
    f"shape: {shape}": ("run.states", head(shape), 32, r"run\.states: is not as long as its sha")
    for shape in SHAPES
}
HOSTILE |= {  # a pickle among them: it would run what it says
    f"type: {type}": (
        "run.states",
        head((1,), type),
        16,
        r"run\.states: is of type .*: numbers and",
    )
    for type in ("|O", "|V8", "<c16", "<M8[s]", "|S8")
}


@pytest.mark.parametrize("what", HOSTILE)
def test_a_hostile_entry_is_refused_before_it_is_unpacked(saved, what, tmp_path):
    name, content, zeros, words = HOSTILE[what]
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(saved) as whole, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
        for one in whole.namelist():
            if one != f"{name}.npy":
                made.writestr(one, whole.read(one))
        with made.open(f"{name}.npy", "w", force_zip64=True) as entry:
            entry.write(content)
            for begin in range(0, zeros, 1_000_000):
                entry.write(bytes(min(1_000_000, zeros - begin)))
    assert path.stat().st_size < HUGE / 200
    tracemalloc.start()
    with pytest.raises(ValueError, match=rf"a\.npz: is not .*{words}"):
        pc.load(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < HUGE / 10
