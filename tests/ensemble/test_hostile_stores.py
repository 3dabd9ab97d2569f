"""Stores from anywhere: no code of theirs runs, and what is damaged is told in one sentence."""

from __future__ import annotations

import json
import os
import pickle
import re
import shutil

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main
from test_store import ASKED, BOOK, STARTS, contents

pytest.importorskip("zarr", exc_type=ImportError)


class RunsCode:
    """Makes a file where it is unpickled."""

    def __init__(self, mark):
        self.mark = str(mark)

    def __reduce__(self):
        return os.mkdir, (self.mark,)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("store") / "whole.zarr"
    times = {"keep": "times", "t_eval": [0.5, 1.0]}
    pc.ensemble(BOOK, q0=STARTS, store=path, chunk=7, **(ASKED | times | {"t_span": (0, 1)}))
    return path


@pytest.fixture(scope="module")
def reduced(tmp_path_factory):
    path = tmp_path_factory.mktemp("store") / "reduced.zarr"
    pc.ensemble(BOOK, q0=STARTS, store=path, chunk=7, **ASKED)
    return path


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


@pytest.mark.usefixtures("unpickling")
def test_zarr_itself_would_run_the_code(tmp_path):
    """Otherwise the tests below show nothing."""
    import zarr

    mark = hostile_group(tmp_path)
    with pytest.raises(Exception, match=r".*"):
        zarr.open_group(tmp_path / "hostile.zarr", mode="r")["time"][...]
    assert mark.exists()


def hostile_group(tmp_path):
    """Make a group of Zarr 2, and return what is there when its code has run."""
    path, mark = tmp_path / "hostile.zarr", tmp_path / "code ran"
    write(path / ".zgroup", {"zarr_format": 2})
    write(path / ".zattrs", {"shape": [1], "block_shape": [1]})
    write(path / "time" / ".zattrs", {})
    write(path / "time" / ".zarray", V2_ARRAY)
    (path / "time" / "0").write_bytes(pickle.dumps(RunsCode(mark)))
    return mark


@pytest.mark.usefixtures("unpickling")
def test_no_code_runs_from_a_group_of_zarr_2(tmp_path):
    mark = hostile_group(tmp_path)
    with pytest.raises(ValueError, match=r"hostile\.zarr': is no store of an ensemble"):
        pc.load(tmp_path / "hostile.zarr")
    with pytest.raises(ValueError, match=r"hostile\.zarr': is no store of an ensemble"):
        pc.ensemble(BOOK, q0=STARTS, store=tmp_path / "hostile.zarr", **ASKED)
    assert not mark.exists()


@pytest.mark.usefixtures("unpickling")
@pytest.mark.parametrize("name", ["time", "q0", "q", "status"])
@pytest.mark.parametrize("where", ["beside", "instead", "consolidated"])
def test_no_code_runs_from_an_array_of_zarr_2_in_a_store(tmp_path, stored, name, where):
    path, mark = tmp_path / "hostile.zarr", tmp_path / "code ran"
    shutil.copytree(stored, path)
    write(path / name / ".zarray", V2_ARRAY)
    write(path / name / ".zattrs", {})
    (path / name / "0").write_bytes(pickle.dumps(RunsCode(mark)))
    if where == "instead":
        (path / name / "zarr.json").unlink()
    if where == "consolidated":
        told = json.loads((path / "zarr.json").read_text())
        told["consolidated_metadata"]["metadata"][name] = V2_ARRAY
        write(path / "zarr.json", told)
    if where == "instead":
        with pytest.raises(ValueError, match=f"{name}/zarr.json is missing"):
            pc.load(path).q  # noqa: B018
    else:
        found = pc.load(path)
        found.q, found.codes  # noqa: B018
        assert np.array_equal(found.q, pc.load(stored).q)
    assert not mark.exists()


@pytest.mark.parametrize("name", ["time", "q0", "q", "gravity"])
@pytest.mark.parametrize("codec", ["numcodecs.pickle", "gzip", "sharding_indexed"])
def test_a_codec_that_is_not_ours_is_refused_before_zarr_sees_it(tmp_path, stored, name, codec):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    told = json.loads((path / name / "zarr.json").read_text())
    told["codecs"][1] = {"name": codec, "configuration": {}}
    write(path / name / "zarr.json", told)
    refused = f"{name}/zarr.json: codecs = .*: must be of bytes, vlen-utf8, zstd: others may run"
    with pytest.raises(ValueError, match=refused):
        pc.load(path)


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
FREE = {
    "pendcore": ["text"], "keep": [{}], "vary": [[]], "fill_value": WRONG, "statistics": [{}],
    "codecs/0/configuration": WRONG, "codecs/1/configuration": WRONG,
    "codecs/1/configuration/level": WRONG, "chunk_key_encoding/configuration": WRONG,
}  # fmt: skip
"""What may have these values as well: they do not tell that the file was changed."""


def whole_of(told, keys):
    for key in keys:
        told = told[int(key) if isinstance(told, list) else key]
    return told


def cases():
    for key in ["", *GROUP]:
        yield "", key
    for name in ("q0", "gravity", "q", "status"):
        for key in ["", *ARRAY]:
            if not (name == "status" and key == "codecs/0/configuration"):  # bytes have no order
                yield name, key


@pytest.mark.parametrize(("name", "key"), [*cases()])
def test_every_wrong_kind_of_every_attribute_is_told_in_one_sentence(tmp_path, reduced, name, key):
    path = tmp_path / "a.zarr"
    shutil.copytree(reduced, path)
    document = path / name / "zarr.json"
    whole = json.loads(document.read_text())
    *first, last = key.split("/")
    before = whole_of(whole, key.split("/")) if key else whole
    for value in WRONG:
        if value == before:
            continue
        told = json.loads(json.dumps(whole))
        if key:
            owner = whole_of(told, first)
            owner[int(last) if isinstance(owner, list) else last] = value
        write(document, told if key else value)
        try:
            pc.load(path)
        except ValueError as error:
            told_of = str(error)
        else:
            assert value in FREE.get(key.removeprefix("attributes/"), []), value
            continue
        assert "a.zarr': is no store of an ensemble" in told_of
        assert "\n" not in told_of, value
        assert len(told_of) < 600, value
        assert re.search(r"zarr\.json|pendcore|case|keep|vary|shape|codec", told_of), told_of


@pytest.mark.parametrize("content", [b"", b"null", b"{", b"\xff", b"[" * 100_000, b'{"a":' * 9999])
@pytest.mark.parametrize("name", ["", "q"])
def test_a_description_that_is_none_is_told(tmp_path, stored, name, content):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    (path / name / "zarr.json").write_bytes(content)
    with pytest.raises(
        ValueError, match=r"a\.zarr': is no store of an ensemble, or is damaged .*js"
    ):
        pc.load(path)


@pytest.mark.parametrize("name", ["time", "q0", "gravity", "q", "status", "over"])
def test_an_array_that_is_missing_is_named(tmp_path, stored, reduced, name):
    path = tmp_path / "a.zarr"
    shutil.copytree(reduced if name == "over" else stored, path)
    if name == "time":
        shutil.rmtree(path / name)
    else:
        (path / name / "zarr.json").unlink()
    told = "q/zarr.json: " if name == "time" else f"{name}/zarr.json is missing"
    with pytest.raises(ValueError, match=told):
        pc.load(path)


@pytest.mark.parametrize("name", ["../q", "/q", "a/../../q", "C:q", "\\q"])
def test_the_name_of_a_reducer_does_not_lead_out_of_a_store(tmp_path, reduced, name):
    path = tmp_path / "a.zarr"
    shutil.copytree(reduced, path)
    told = json.loads((path / "zarr.json").read_text())
    told["attributes"]["keep"] = {name: ["EnergyDrift"]}
    write(path / "zarr.json", told)
    with pytest.raises(ValueError, match=r"is no name of a reducer|reducers and events"):
        pc.load(path)


@pytest.mark.parametrize(
    ("shape", "count"), [([10**6, 10**6], "1,000,000,000,000"), ([2, 10**20], "200,[0,]*")]
)
def test_more_blocks_than_a_folder_holds_are_refused(shape, count, tmp_path, stored):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    told = json.loads((path / "zarr.json").read_text())
    told["attributes"] |= {"shape": shape, "block_shape": [1, 1]}
    write(path / "zarr.json", told)
    with pytest.raises(ValueError, match=rf"makes {count} blocks: must make at most 262,"):
        pc.load(path)


def test_a_description_of_boundless_size_is_not_read(tmp_path, stored, monkeypatch):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    with (path / "zarr.json").open("r+b") as file:
        file.truncate(2**40)  # a file with a hole: it takes no room
    with pytest.raises(ValueError, match=r"zarr\.json: has 1,\S+ bytes: must have at most"):
        pc.load(path)


def test_the_command_tells_what_is_wrong_with_a_store(tmp_path, stored, capsys):
    path = tmp_path / "a.zarr"
    shutil.copytree(stored, path)
    chunk = path / "q0" / "c" / "0" / "0" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-5])
    assert main(["plot", str(path), "-o", str(tmp_path / "a.png")]) == 2
    told = capsys.readouterr().err
    assert "a.zarr': its starts cannot be read" in told
    assert "None" not in told
    assert main(["plot", str(tmp_path / "none.npz")]) == 2
    assert capsys.readouterr().err.endswith("none.npz: No such file or directory\n")
    assert contents(path) != contents(stored)


ARCHIVED = ["pendcore", "case", "keep", "vary", "shape", "axes", "axes/q0", "axes/q0/0", "ending",
            "statistics", "keep/over", "keep/over/1", "vary/0", "shape/0"]  # fmt: skip


@pytest.fixture(scope="module")
def archived(tmp_path_factory):
    path = tmp_path_factory.mktemp("archive") / "all.npz"
    pc.ensemble(BOOK, q0=STARTS, **ASKED).save(path)
    with np.load(path) as entries:
        return dict(entries)


@pytest.mark.parametrize("key", ARCHIVED)
def test_every_wrong_kind_of_what_an_archive_tells_is_refused_in_one_sentence(
    tmp_path, archived, key
):
    whole = json.loads(str(archived["ensemble"]))
    *first, last = key.split("/")
    for value in WRONG:
        if value == whole_of(whole, key.split("/")) or value in FREE.get(key, []):
            continue
        told = json.loads(json.dumps(whole))
        owner = whole_of(told, first)
        owner[int(last) if isinstance(owner, list) else last] = value
        np.savez(tmp_path / "a.npz", **(archived | {"ensemble": json.dumps(told)}))
        with pytest.raises(ValueError, match=r"a\.npz: is no ensemble that pendcore saved") as said:
            pc.load(tmp_path / "a.npz")
        assert "\n" not in str(said.value)
        assert "object" not in str(said.value)  # as in 'int' object has no attribute
