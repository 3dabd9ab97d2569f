"""Stores from anywhere: no code of theirs runs, and what is damaged is told in one sentence."""

from __future__ import annotations

import copy
import json
import os
import pickle
import re
import shutil

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main
from stored_ensembles import make

pytest.importorskip("zarr", exc_type=ImportError)
NO_STORE = r"a\.zarr': is no store of an ensemble"


class RunsCode:
    """Makes a file where it is unpickled."""

    def __init__(self, mark):
        self.mark = str(mark)

    def __reduce__(self):
        return os.mkdir, (self.mark,)


@pytest.fixture
def unpickling(monkeypatch):
    """Let numcodecs unpickle, as it did by itself until 0.16.3."""
    pickles = pytest.importorskip("numcodecs.pickles")
    monkeypatch.setattr(pickles, "ALLOW_UNSAFE_PICKLE_DECODE", True, raising=False)


V2_ARRAY = {
    "zarr_format": 2, "shape": [1], "chunks": [1], "dtype": "|O", "compressor": None,
    "fill_value": "", "order": "C", "dimension_separator": ".",
    "filters": [{"id": "vlen-utf8"}, {"id": "pickle", "protocol": 5}],
}  # fmt: skip


def write(path, told):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(told))


def hide_code(array, mark):
    """Write an array of Zarr 2 that makes a file when it is read."""
    write(array / ".zattrs", {})
    write(array / ".zarray", V2_ARRAY)
    (array / "0").write_bytes(pickle.dumps(RunsCode(mark)))


@pytest.mark.usefixtures("unpickling")
def test_no_code_runs_from_a_group_of_zarr_2(tmp_path):
    import zarr

    path, mark = tmp_path / "a.zarr", tmp_path / "code ran"
    write(path / ".zgroup", {"zarr_format": 2})
    write(path / ".zattrs", {"shape": [1], "block_shape": [1]})
    hide_code(path / "time", mark)
    for read in (pc.load, make):
        with pytest.raises(ValueError, match=NO_STORE):
            read(path)
    assert not mark.exists()
    with pytest.raises(Exception, match=r".*"):
        zarr.open_group(path, mode="r")["time"][...]
    assert mark.exists()  # Zarr itself runs the code: else this shows nothing


@pytest.mark.few_cases
@pytest.mark.usefixtures("unpickling")
@pytest.mark.parametrize("name", ["time", "q0", "q", "status"])
@pytest.mark.parametrize("where", ["beside", "instead", "consolidated"])
def test_no_code_runs_from_an_array_of_zarr_2_in_a_store(tmp_path, timed, name, where):
    path, mark = tmp_path / "a.zarr", tmp_path / "code ran"
    shutil.copytree(timed, path)
    hide_code(path / name, mark)
    if where == "instead":
        (path / name / "zarr.json").unlink()
        with pytest.raises(ValueError, match=f"{name}/zarr.json is missing"):
            pc.load(path).q  # noqa: B018
    else:
        if where == "consolidated":
            told = json.loads((path / "zarr.json").read_text())
            told["consolidated_metadata"]["metadata"][name] = V2_ARRAY
            write(path / "zarr.json", told)
        found = pc.load(path)
        assert np.array_equal(found.q, pc.load(timed).q)
        assert found.codes.shape == (6, 9)
    assert not mark.exists()


def parts(key):
    return [int(part) if part.isdigit() else part for part in key.split("/")] if key else []


def part_of(told, key):
    for one in parts(key):
        told = told[one]
    return told


def changed(told, key, value):
    """Return a document with another value at a place such as chunk_grid/configuration."""
    if not key:
        return value
    told = copy.deepcopy(told)
    *first, last = parts(key)
    owner = told
    for one in first:
        owner = owner[one]
    owner[last] = value
    return told


def change(document, values):
    told = json.loads(document.read_text())
    for key, value in values.items():
        told = changed(told, key, value)
    write(document, told)


WRONG = [None, True, 5, -1, 1.5, "text", [], [1], ["text"], [0], {}, {"x": 1}, {"x": ["Extremes"]}]
GROUP = [
    "attributes", "attributes/pendcore", "attributes/case", "attributes/keep", "attributes/vary",
    "attributes/shape", "attributes/block_shape", "zarr_format", "node_type",
    "attributes/keep/over", "attributes/keep/over/1", "attributes/vary/0", "attributes/shape/0",
    "attributes/block_shape/1",
]  # fmt: skip
ARRAY = [
    "shape", "shape/0", "data_type", "chunk_grid", "chunk_grid/name", "chunk_grid/configuration",
    "chunk_grid/configuration/chunk_shape", "chunk_grid/configuration/chunk_shape/0",
    "chunk_key_encoding", "chunk_key_encoding/name", "codecs", "codecs/0", "codecs/1/name",
    "dimension_names", "dimension_names/0", "zarr_format", "node_type", "fill_value",
    "codecs/1/configuration", "codecs/1/configuration/level", "chunk_key_encoding/configuration",
    "codecs/0/configuration",
]  # fmt: skip
ARCHIVED = ["pendcore", "case", "keep", "vary", "shape", "axes", "axes/q0", "axes/q0/0", "ending",
            "statistics", "keep/over", "keep/over/1", "vary/0", "shape/0"]  # fmt: skip
FREE = {
    "pendcore": ["text"], "keep": [{}], "vary": [[]], "fill_value": WRONG, "statistics": [{}],
    "codecs/0/configuration": WRONG, "codecs/1/configuration": WRONG,
    "codecs/1/configuration/level": WRONG, "chunk_key_encoding/configuration": WRONG,
}  # fmt: skip
"""What may have these values as well: they do not tell that the file was changed."""
PLACES = [("", key) for key in ["", *GROUP]] + [
    (name, key)
    for name in ("q0", "gravity", "q", "status")
    for key in ["", *ARRAY]
    if (name, key) != ("status", "codecs/0/configuration")  # bytes have no order
]


@pytest.mark.few_cases
@pytest.mark.parametrize(("name", "key"), PLACES)
def test_every_wrong_kind_of_every_attribute_is_told_in_one_sentence(copied, name, key):
    document = copied / name / "zarr.json"
    whole = json.loads(document.read_text())
    for value in WRONG:
        if value == part_of(whole, key):
            continue
        write(document, changed(whole, key, value))
        try:
            pc.load(copied)
        except ValueError as error:
            told_of = str(error)
        else:
            assert value in FREE.get(key.removeprefix("attributes/"), []), value
            continue
        assert re.search(NO_STORE, told_of)
        assert "\n" not in told_of, value
        assert len(told_of) < 600, value
        assert re.search(r"zarr\.json|pendcore|case|keep|vary|shape|codec", told_of), told_of


@pytest.fixture(scope="module")
def archived(tmp_path_factory, plain):
    path = tmp_path_factory.mktemp("archive") / "all.npz"
    plain.save(path)
    with np.load(path) as entries:
        return dict(entries)


@pytest.mark.parametrize("key", ARCHIVED)
def test_every_wrong_kind_of_what_an_archive_tells_is_refused_in_one_sentence(
    tmp_path, archived, key
):
    whole, path = json.loads(str(archived["ensemble"])), tmp_path / "a.npz"
    for value in WRONG:
        if value == part_of(whole, key) or value in FREE.get(key, []):
            continue
        np.savez(path, **(archived | {"ensemble": json.dumps(changed(whole, key, value))}))
        with pytest.raises(ValueError, match=r"a\.npz: is no ensemble that pendcore saved") as said:
            pc.load(path)
        assert "\n" not in str(said.value)
        assert "object" not in str(said.value)  # as in 'int' object has no attribute


DOCUMENTS = [b"", b"null", b"{", b"\xff", b"[" * 100_000, b'{"a":' * 9999]


@pytest.mark.parametrize("name", ["", "q"])
def test_a_description_that_is_none_is_told(copied, name):
    document = copied / name / "zarr.json"
    for content in DOCUMENTS:
        document.write_bytes(content)
        with pytest.raises(ValueError, match=NO_STORE + ", or is damaged .*js"):
            pc.load(copied)


CODECS = "codecs = .*: must be of bytes, vlen-utf8, zstd: others may run"
CHANGED = [  # before Zarr sees a codec that is not ours
    (name, {"codecs/1": {"name": codec, "configuration": {}}}, f"{name}/zarr.json: {CODECS}")
    for name in ("time", "q0", "q", "gravity")
    for codec in ("numcodecs.pickle", "gzip", "sharding_indexed")
]
CHANGED += [  # no name leads out of a store
    (
        "",
        {"attributes/keep": {name: ["EnergyDrift"]}},
        "is no name of a reducer|reducers and events",
    )
    for name in ("../q", "/q", "a/../../q", "C:q", "\\q")
]
CHANGED += [  # names of derivatives
    ("", {"attributes/keep": {"a": ["Sensitivities", names]}}, told)
    for names, told in [
        (["gravty"], 'keep: sensitivities: parameter "gravty": the scene has none of that name'),
        ("gravity", "must be reducers and events"),
        ([], "must be reducers and events"),
    ]
]
CHANGED += [  # more blocks than a folder holds
    (
        "", {"attributes/shape": shape, "attributes/block_shape": [1, 1]},
        f"makes {count} blocks: must make at most 262,",
    )
    for shape, count in [([10**6, 10**6], "1,000,000,000,000"), ([2, 10**20], "200,[0,]*")]
]  # fmt: skip


@pytest.mark.parametrize(("name", "values", "told"), CHANGED)
def test_what_could_do_harm_is_refused(tmp_path, timed, name, values, told):
    path = tmp_path / "a.zarr"
    shutil.copytree(timed, path)
    change(path / name / "zarr.json", values)
    with pytest.raises(ValueError, match=told):
        pc.load(path)


@pytest.mark.parametrize("name", ["time", "q0", "gravity", "q", "status", "over"])
def test_an_array_that_is_missing_is_named(tmp_path, stored, timed, name):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored if name == "over" else timed, path)
    if name == "time":
        shutil.rmtree(path / name)
    else:
        (path / name / "zarr.json").unlink()
    with pytest.raises(
        ValueError, match="q/zarr.json: " if name == "time" else f"{name}/zarr.json is"
    ):
        pc.load(path)


def test_a_description_of_boundless_size_is_not_read(copied):
    with (copied / "zarr.json").open("r+b") as file:
        file.truncate(2**40)  # a file with a hole: it takes no room
    with pytest.raises(ValueError, match=r"zarr\.json: has 1,\S+ bytes: must have at most"):
        pc.load(copied)


def test_the_command_tells_what_is_wrong_with_a_store(copied, tmp_path, capsys):
    chunk = copied / "q0" / "c" / "0" / "0" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-5])
    assert main(["plot", str(copied), "-o", str(tmp_path / "a.png")]) == 2
    told = capsys.readouterr().err
    assert "a.zarr': its starts cannot be read" in told
    assert "None" not in told
    assert main(["plot", str(tmp_path / "none.npz")]) == 2
    assert capsys.readouterr().err.endswith("none.npz: No such file or directory\n")
