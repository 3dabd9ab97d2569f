"""docs/how_to/case_files.md has every key of a case file, and the defaults that hold."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pendcore as pc
import pytest
from pendcore._cases.case_file import EVENT_KEYS, KEYS
from pendcore._run.options import RUN_DEFAULTS

REFERENCE = (Path(__file__).parents[2] / "docs/how_to/case_files.md").read_text()
BLOCKS = re.findall(r"```toml\n(.*?)```", REFERENCE, re.DOTALL)


def documented():
    """Kind of table, key and default of every row of the reference."""
    for section in REFERENCE.split("\n## ")[1:]:
        title = section.splitlines()[0].strip("`[]")
        for key, default in re.findall(r"^\| `(\w+)` \| [^|]*\| ([^|]*) \|", section, re.MULTILINE):
            yield "" if title == "Above all tables" else title, key, default


def test_the_reference_has_every_key_and_no_other():
    found = [(kind, key) for kind, key, _ in documented()]
    assert found == [(kind, key) for kind, keys in KEYS.items() for key in keys]


def test_the_reference_has_the_keys_of_every_event():
    (rows,) = re.findall(r"^\| kind \| keys, and for each.*?\n\n", REFERENCE, re.M | re.DOTALL)
    usual, _, *kinds = (re.findall(r"`(\w+)`", row) for row in rows.strip().splitlines())
    found = {kind: {"kind", *keys, *usual} for kind, *keys in kinds}
    assert found == {kind: set(keys) for kind, keys in EVENT_KEYS.items()}


def test_the_reference_has_the_defaults_of_simulate():
    for kind, key, default in documented():
        usual = RUN_DEFAULTS.get(key) if kind == "run" else None
        assert "`None`" not in default, key
        if usual is not None:
            assert tomllib.loads(f"default = {default.strip('`')}")["default"] == usual, key


@pytest.mark.parametrize("tables", BLOCKS[1:])
def test_the_tables_that_the_reference_shows_can_be_added_to_a_case(tables):
    before, start = BLOCKS[0].split("[start]")
    added = pc.read_case(f"{before}{tables}[start]{start}").scene.effects
    assert [effect.kind for effect in added] == re.findall(r'kind = "(\w+)"', tables)
