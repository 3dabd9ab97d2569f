"""A small file cannot ask for boundless time or memory: what would is refused with its bound."""

from __future__ import annotations

import io
import os
import time
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from fuzz.readers import MOST_SECONDS, finding
from pendcore._cases import case_file
from pendcore._cases.toml_text import MOST_NESTED
from pendcore.cli import main

BOOK = pc.Case.textbook().to_toml()
RUN = BOOK.index("[run]")

SLOW = {
    "blanks in a line": BOOK + " " * 100_000 + "\n",
    "blanks before a key": BOOK + " " * 100_000 + "rtl = 1e-9\n",
    "blanks within a key": BOOK + "r " + " " * 100_000 + "= 1\n",
    "blanks where a table stands twice": BOOK + " " * 100_000 + "\n[start]\n",
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
def test_a_text_that_is_no_case_is_refused_in_a_moment(name: str) -> None:
    """The slowest took hours; a moment is 50 times what they take on an idle machine."""

    def read() -> None:
        with pytest.raises(ValueError, match=r"."):
            pc.read_case(SLOW[name] if name != "blanks in a line" else SLOW[name] + "=")

    assert finding(read) is None


def test_blanks_are_allowed() -> None:
    assert pc.read_case(SLOW["blanks in a line"]) == pc.Case.textbook()
    text = SLOW["blanks before a key"].replace("rtl", "rtol")
    assert pc.read_case(text).options["rtol"] == 1e-9


@pytest.mark.parametrize(
    "text", ["x = " + "[" * 33 + "\n", "a." * 32 + "a = 1\n", "[" + "a." * 32 + "a]\n"]
)
def test_what_is_nested_too_deeply_is_told_with_its_line_and_bound(text: str) -> None:
    told = rf"case, line 2: is nested too deeply: at most {MOST_NESTED} arrays, tables or names"
    with pytest.raises(ValueError, match=told):
        pc.read_case('name = "x"\n' + text + BOOK)


def test_brackets_and_dots_in_texts_and_comments_are_no_nesting() -> None:
    many = "[{" * 50 + "." * 50 + "a" * 3
    texts = [f'"{many}"', f"'{many}'", f'"""{many}"""', f"'''{many}\n{many}'''", f'"""{many}"""""']
    for text in texts:
        case = pc.read_case(f"# {many}\nname = {text} # {many}\n" + BOOK.partition("\n")[2])
        assert many in case.name


def test_the_line_of_a_mistake_after_a_text_that_ends_in_quotes_is_right() -> None:
    text = 'name = """a\n"""""\n' + BOOK.partition("\n")[2].replace("mass = 1.0", "mas = 1.0", 1)
    line = text.split("\n").index("mas = 1.0") + 1
    with pytest.raises(ValueError, match=rf"case, line {line}: unknown key 'mas'"):
        pc.read_case(text)


def test_even_times_are_bounded_and_read_in_a_moment() -> None:
    def with_count(count: int) -> str:
        return BOOK.replace("[run]", f"[run]\nt_eval = {{start = 0, stop = 5, count = {count}}}")

    told = r"t_eval\.count = 1000001: must be a whole number from 2 to 1,000,000"
    with pytest.raises(ValueError, match=told):
        pc.read_case(with_count(1_000_001))
    begin = time.process_time()
    assert len(pc.read_case(with_count(1_000_000)).options["t_eval"]) == 1_000_000
    assert time.process_time() - begin < MOST_SECONDS


def test_a_case_file_is_read_up_to_its_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(case_file, "MOST_BYTES", 1000)
    path = tmp_path / "long.toml"
    path.write_text(BOOK + "#" * (1000 - len(BOOK)))
    assert pc.read_case(path) == pc.Case.textbook()
    path.write_text(BOOK + "#" * (1001 - len(BOOK)))
    with pytest.raises(ValueError, match=r"long\.toml: is too large for a case: at most 1,000 byt"):
        pc.read_case(path)


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="needs a device without an end")
def test_a_device_without_an_end_is_refused() -> None:
    with pytest.raises(ValueError, match=r"/dev/zero: is too large for a case: at most 67,108,864"):
        pc.read_case("/dev/zero")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_may_end_as_anywhere(end: str, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(BOOK.replace("\n", end).encode())
    assert pc.read_case(path) == pc.Case.textbook()


def test_a_map_of_boundless_size_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "map.toml"
    axes = "".join(
        f'{x} = {{name = "q0[{i}]", start = 0, stop = 1, count = 20_000}}\n'
        for i, x in ((1, "x"), (2, "y"))
    )
    path.write_text(f'{BOOK}\n[map]\nshow = "q[1]"\n{axes}')
    assert main(["map", str(path), "-o", str(tmp_path / "out")]) == 2
    assert "20,000 x 20,000 pixels: must be at most 100,000,000" in capsys.readouterr().err
    assert main(["map", str(path), "--count", "1000000000"]) == 2


# Archives --------------------------------------------------------------------------------------

HUGE = 100_000_000


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("saved") / "run.npz"
    pc.Case.textbook().simulate().save(path)
    return path


def head(shape: tuple[int, ...], descr: str = "<f8") -> bytes:
    file = io.BytesIO()
    told = {"shape": shape, "fortran_order": False, "descr": descr}
    np.lib.format.write_array_header_1_0(file, told)
    return file.getvalue()


def with_entry(
    saved: Path,
    to: Path,
    name: str,
    content: bytes,
    zeros: int = 0,
    how: int = zipfile.ZIP_DEFLATED,
) -> Path:
    """Write an archive with one entry in place of its own: a content, and zeros after it."""
    with zipfile.ZipFile(saved) as whole, zipfile.ZipFile(to, "w", compression=how) as archive:
        for one in whole.namelist():
            if one != f"{name}.npy":
                archive.writestr(one, whole.read(one))
        with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
            entry.write(content)
            for _ in range(zeros // 1_000_000):
                entry.write(bytes(1_000_000))
    return to


@pytest.mark.parametrize("name", ["run.states", "case", "error.t", "run.of_nobody"])
def test_an_archive_that_unpacks_to_far_more_than_its_size_is_refused_before(
    saved: Path, tmp_path: Path, name: str
) -> None:
    path = with_entry(saved, tmp_path / "bomb.npz", name, head((HUGE // 8,)), HUGE)
    assert path.stat().st_size < HUGE / 200
    tracemalloc.start()
    with pytest.raises(
        ValueError, match=r"bomb\.npz: is not .*unpacks to 10\d,\d+,\d+: at most 100"
    ):
        pc.load(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < HUGE / 10


@pytest.mark.parametrize("shape", [(HUGE // 8,), (10**15,), (2,), (), (-1,), (-1, -4), (2**62, 4)])
def test_an_entry_that_is_not_as_long_as_its_head_says_is_refused_before(
    saved: Path, tmp_path: Path, shape: tuple[int, ...]
) -> None:
    path = with_entry(saved, tmp_path / "a.npz", "run.states", head(shape) + bytes(4 * 8))
    tracemalloc.start()
    with pytest.raises(
        ValueError, match=r"a\.npz: is not .*run\.states: is not as long as its sha"
    ):
        pc.load(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < HUGE / 10


@pytest.mark.parametrize("descr", ["|O", "|V8", "<c16", "<M8[s]", "|S8"])
def test_an_entry_of_another_type_is_refused_unread(
    saved: Path, tmp_path: Path, descr: str
) -> None:
    """A pickle among them: it would run what it says."""
    path = with_entry(saved, tmp_path / "a.npz", "run.states", head((1,), descr) + bytes(16))
    with pytest.raises(ValueError, match=r"run\.states: is of type .*: numbers and texts are read"):
        pc.load(path)


def test_an_archive_that_was_compressed_is_read(saved: Path, tmp_path: Path) -> None:
    with np.load(saved) as entries:
        np.savez_compressed(tmp_path / "small.npz", **entries)
    assert (tmp_path / "small.npz").stat().st_size < saved.stat().st_size
    small, whole = pc.load(tmp_path / "small.npz"), pc.load(saved)
    assert np.array_equal(small.q, whole.q)


def test_arrays_in_fortran_order_are_read_in_their_order(tmp_path: Path) -> None:
    found = pc.ensemble(
        pc.Scene.textbook(), q0=pc.sampling.uniform(-1, 1, (3, 2, 2), seed=1), t_span=(0, 1)
    )
    found.save(tmp_path / "all.npz")
    with np.load(tmp_path / "all.npz") as entries:
        turned: dict[str, Any] = {
            name: np.array(values, order="F") for name, values in entries.items()
        }
    np.savez(tmp_path / "turned.npz", **turned)
    again = pc.load(tmp_path / "turned.npz")
    assert np.array_equal(again.q, found.q)
    again.q[0] = 0.0  # as before, they are arrays that a user may change
