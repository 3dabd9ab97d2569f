"""A small file cannot ask for boundless time or memory: what would is refused with its bound."""

from __future__ import annotations

import time
from pathlib import Path

import pendcore as pc
import pytest
from fuzz.readers import MOST_SECONDS, finding
from pendcore._cases import case_file
from pendcore._cases.toml_text import MOST_NESTED
from pendcore.cli import main

BOOK = pc.Case.textbook().to_toml()
BELOW_THE_NAME = BOOK.partition("\n")[2]
BLANKS = " " * 100_000
SLOW = {
    "blanks in a line": BOOK + BLANKS + "\n=",
    "blanks before a key": BOOK + BLANKS + "rtl = 1e-9\n",
    "blanks within a key": BOOK + "r " + BLANKS + "= 1\n",
    "blanks where a table stands twice": BOOK + BLANKS + "\n[start]\n",
    "quotes that do not end": BOOK + '"""\\' * 30_000,
    "texts that do not end": BOOK + "'''" + "\n'" * 50_000,
    "a long word": BOOK + "a" * 500_000 + "\n",
    "dots": BOOK + "a." * 50_000 + "a = 1\n",
    "dots with blanks": BOOK + "a . " * 50_000 + "a = 1\n",
    "dots between quotes": BOOK + '"a".' * 50_000 + "a = 1\n",
    "dots in a header": BOOK + "[" + "a." * 50_000 + "a]\n",
    "dots in a table in a line": BOOK + "x = {" + "a." * 50_000 + "a = 1}\n",
    "dots after quotes": BOOK + 'x = {y = """z"""", ' + "a." * 50_000 + "a = 1}\n",
    "arrays": "x = " + "[" * 100_000 + "\n" + BOOK,
    "arrays that end": "x = " + "[" * 2_000 + "]" * 2_000 + "\n" + BOOK,
    "tables": "x = " + "{a = " * 2_000 + "\n" + BOOK,
    "a number of many digits": BOOK.replace("9.807", "9" * 500_000),
    "a number in hexadecimal": BOOK.replace("9.807", "0x" + "f" * 500_000),
    "many keys": BOOK + "".join(f"k{i} = 1\n" for i in range(30_000)),
    "a name of many letters": BOOK.replace("[run]", "[run]\n" + "m" * 200_000 + " = 1"),
}


@pytest.mark.every_value("name")
@pytest.mark.parametrize("name", SLOW)
def test_a_text_that_is_no_case_is_refused_in_a_moment(name):
    """The slowest took hours; a moment is 50 times what they take on an idle machine."""

    def read():
        with pytest.raises(ValueError, match=r"."):
            pc.read_case(SLOW[name])

    assert finding(read) is None


def test_blanks_are_allowed():
    assert pc.read_case(SLOW["blanks in a line"][:-1]) == pc.Case.textbook()
    text = SLOW["blanks before a key"].replace("rtl", "rtol")
    assert pc.read_case(text).options["rtol"] == 1e-9


@pytest.mark.parametrize(
    "text", ["x = " + "[" * 33 + "\n", "a." * 32 + "a = 1\n", "[" + "a." * 32 + "a]\n"]
)
def test_what_is_nested_too_deeply_is_told_with_its_line_and_bound(text):
    told = rf"case, line 2: is nested too deeply: at most {MOST_NESTED} arrays, tables or names"
    with pytest.raises(ValueError, match=told):
        pc.read_case('name = "x"\n' + text + BOOK)


MANY = "[{" * 50 + "." * 50 + "a" * 3


@pytest.mark.parametrize("text", ['"{}"', "'{}'", '"""{}"""', "'''{0}\n{0}'''", '"""{}"""""'])
def test_brackets_and_dots_in_texts_and_comments_are_no_nesting(text):
    case = pc.read_case(f"# {MANY}\nname = {text.format(MANY)} # {MANY}\n{BELOW_THE_NAME}")
    assert MANY in case.name


def test_a_million_even_times_are_read_in_a_moment():
    times = "t_eval = {start = 0, stop = 5, count = 1_000_000}"
    begin = time.process_time()
    case = pc.read_case(BOOK.replace("[run]", f"[run]\n{times}"))
    assert len(case.options["t_eval"]) == 1_000_000
    assert time.process_time() - begin < MOST_SECONDS


def test_a_case_file_is_read_up_to_its_bound(tmp_path, monkeypatch):
    if Path("/dev/zero").exists():  # a device without an end
        with pytest.raises(ValueError, match=r"/dev/zero: is too large .*: at most 67,108,864"):
            pc.read_case("/dev/zero")
    monkeypatch.setattr(case_file, "MOST_BYTES", 1000)
    path = tmp_path / "long.toml"
    path.write_text(BOOK + "#" * (1000 - len(BOOK)))
    assert pc.read_case(path) == pc.Case.textbook()
    path.write_text(BOOK + "#" * (1001 - len(BOOK)))
    with pytest.raises(ValueError, match=r"long\.toml: is too large for a case: at most 1,000 byt"):
        pc.read_case(path)


def test_a_map_of_boundless_size_is_refused(tmp_path, capsys):
    path = tmp_path / "map.toml"
    axes = "".join(
        f'{x} = {{name = "q0[{i}]", start = 0, stop = 1, count = 20_000}}\n'
        for i, x in ((1, "x"), (2, "y"))
    )
    path.write_text(f'{BOOK}\n[map]\nshow = "q[1]"\n{axes}')
    assert main(["map", str(path), "-o", str(tmp_path / "out")]) == 2
    assert "20,000 x 20,000 pixels: must be at most 100,000,000" in capsys.readouterr().err
    assert main(["map", str(path), "--count", "1000000000"]) == 2
