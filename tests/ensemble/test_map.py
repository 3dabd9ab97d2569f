"""`pendcore map`."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main

CASE = Path(__file__).parents[2] / "examples" / "11_flip_map.toml"


def run(folder, *arguments, case=CASE):
    return main(["map", str(case), "-o", str(folder), *arguments])


def test_a_map_of_flips(tmp_path, capsys):
    assert run(tmp_path, "--count", "16") == 0
    told = capsys.readouterr().out
    assert "first_event over q0_deg[1] and q0_deg[2], t = 0 to 30 s" in told
    (needless,) = re.findall(r"\n(\d+) were not needed: the energy does not suffice", told)
    (runs,) = re.findall(r"\nruns: (.*)\n", told)
    assert int(needless) + sum(int(count) for count in re.findall(r"\d+", runs)) == 16 * 16
    assert (tmp_path / "summary.txt").read_text() == told
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    with np.load(tmp_path / "map.npz") as found:
        x, y, values, resolved = (found[name] for name in ("x", "y", "values", "resolved"))
        case = pc.read_case(str(found["case"]))
    q0 = np.radians(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))
    event = case.options["events"][0]
    plain = pc.ensemble(case.scene, q0=q0, t_span=case.t_span, keep=pc.reducers.FirstEvent(event))
    assert np.array_equal(values, plain["first_event"], equal_nan=True)
    assert f"resolved: {np.mean(resolved):.2%}" in told
    assert x[0] == -90 + 360 / 32


def test_zoom_refine_and_other_numbers(tmp_path, capsys):
    assert run(tmp_path / "a", "--count", "16", "--refine", "2", "--no-trust") == 0
    assert "computed at the finest level" in capsys.readouterr().out
    assert run(tmp_path / "b", "--count", "8", "--zoom", "0", "90", "0", "45") == 0
    with np.load(tmp_path / "b" / "map.npz") as found:
        assert np.allclose(found["y"], 45 * (np.arange(8) + 0.5) / 8, rtol=1e-15)
    text = CASE.read_text().replace('"first_event"', '"{}"')
    text = text.replace("t_end = 30.0", "t_end = 2.0")
    for show in ("largest_exponent", "energy_drift", "q[2]", "qd[1]"):
        case = tmp_path / "case.toml"
        case.write_text(text.replace("{}", show).replace('"q0_deg[2]"', '"gravity"'))
        assert run(tmp_path / show, "--count", "4", "--zoom", "0", "90", "5", "9", case=case) == 0
        with np.load(tmp_path / show / "map.npz") as found:
            assert np.isfinite(found["values"]).all()
    # Where gravity varies, that of the case forbids nothing.
    case.write_text(text.replace("{}", "first_event").replace('"q0_deg[2]"', '"gravity"'))
    capsys.readouterr()
    assert run(tmp_path / "g", "--count", "4", "--zoom", "0", "90", "0.1", "9", case=case) == 0
    assert "were not needed" not in capsys.readouterr().out


SHOW = 'show = "first_event"'
CHANGED = [
    ("[map]", "[maps]", "unknown key 'maps': did you mean 'map'?"),
    (SHOW, 'show = "second"', "show = 'second': must be one of first_event"),
    (SHOW, 'show = "q[3]"', "show = 'q[3]': the scene has 2 links"),
    (f"{SHOW}\n", "", "[map] needs show"),
    ('"q0_deg[2]"', '"q0_deg[3]"', "q0_deg[3]: the scene has 2 links"),
    ('"q0_deg[2]"', '"gravityy"', "gravity"),
    ('"q0_deg[2]"', '"q0[1]"', "y.name = 'q0[1]': is that of x too: name another one"),
    ("count = 200}", "count = 1}", "x.count = 1: must be a whole number from 2"),
    ("stop = 270, ", "", "x: must be a table with name, start, stop, count"),
    ("start = -90", "start = 300", "start = 300, stop = 270: must be increasing"),
]
ARGUMENTS = [
    (["--count", "1"], "--count = 1: must be 2 or more"),
    (["--zoom", "1", "0", "0", "1"], "X0 < X1 and Y0 < Y1 are needed"),
    (["--refine", "-1"], "--refine = -1: must be 0 or more"),
    (["--refine", "4"], "count = 200: must be a multiple of 16"),
]


def test_mistakes_are_told_in_a_line(tmp_path, capsys):
    case = tmp_path / "case.toml"
    for old, new, told in CHANGED:
        case.write_text(CASE.read_text().replace(old, new).replace("t_end = 30.0", "t_end = 0.1"))
        assert run(tmp_path / "out", "--count", "4", case=case) == 2
        error = capsys.readouterr().err
        assert told in error
        assert error.count("\n") == 1
    for arguments, told in ARGUMENTS:
        assert run(tmp_path / "out", *arguments) == 2
        assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_refused_before_the_map(tmp_path, capsys, monkeypatch):
    def refuse(dir):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pendcore.cli.usage.TemporaryFile", refuse)  # root may write everywhere
    monkeypatch.setattr("pendcore.cli.map._Map.compute", lambda *asked: pytest.fail("computed"))
    folder = tmp_path / "new" / "folder"
    assert run(folder, "--count", "4") == 2
    told = f"{folder}: cannot be written: Permission denied: choose another folder"
    assert told in capsys.readouterr().err
    assert not folder.parent.exists()
