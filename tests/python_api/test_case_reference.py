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
    usual, *kinds = rows.strip().splitlines()
    common = set(re.findall(r"`(\w+)`", usual))
    found = {}
    for row in kinds[1:]:
        kind, *keys = re.findall(r"`(\w+)`", row)
        found[kind] = {"kind", *keys} | common
    assert found == {kind: set(keys) for kind, keys in EVENT_KEYS.items()}


def test_the_reference_has_the_defaults_of_simulate():
    for kind, key, default in documented():
        if kind == "run" and key in RUN_DEFAULTS:
            usual = RUN_DEFAULTS[key]
            if usual is None:
                assert "`None`" not in default, key
            else:
                assert tomllib.loads(f"default = {default.strip('`')}")["default"] == usual, key


def test_the_case_of_the_reference_is_the_examples():
    example = Path(__file__).parents[2] / "examples/03_case_file.toml"
    assert pc.read_case(BLOCKS[0]) == pc.read_case(example)


@pytest.mark.parametrize("tables", BLOCKS[1:])
def test_the_tables_that_the_reference_shows_can_be_added_to_a_case(tables):
    before, start = BLOCKS[0].split("[start]")
    added = pc.read_case(f"{before}{tables}[start]{start}").scene.effects
    assert [effect.kind for effect in added] == re.findall(r'kind = "(\w+)"', tables)
