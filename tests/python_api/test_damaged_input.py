"""Damaged case files, archives and pickled states are refused in words, or used: never a crash.

The damage is the same in every run; `make fuzz-readers` goes on with it, guided by coverage.
"""

from __future__ import annotations

import time
from contextlib import nullcontext

import pendcore as pc
import pytest
from fuzz import damage
from fuzz.choices import FromSeed
from fuzz.readers import (
    READERS,
    finding,
    read_archive,
    read_case,
    read_store,
    whole_archives,
    whole_cases,
    whole_stores,
)

TIMES = {"case": 200, "archive": 200, "state": 400, "scene": 200, "store": 100}


def require_what_it_needs(reader: str) -> None:
    """Skip the test of a store where Zarr is missing."""
    if reader == "store":
        pytest.importorskip("zarr", exc_type=ImportError)


@pytest.mark.parametrize("reader", READERS)
def test_what_is_damaged_is_refused_in_words_or_used(reader: str) -> None:
    """And in time: an input that takes more processor time than `MOST_SECONDS` is a finding."""
    require_what_it_needs(reader)
    for i in range(TIMES[reader]):
        found = finding(lambda: READERS[reader](FromSeed(f"{reader}/{i}")))  # noqa: B023
        assert found is None, f"{reader}/{i}: {found}"


@pytest.mark.parametrize("i", range(len(whole_archives())))
def test_what_is_whole_is_read_and_used(i: int) -> None:
    read_archive(whole_archives()[i])


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
@pytest.mark.parametrize("i", range(len(whole_cases())))
def test_examples_are_read_and_used(i: int) -> None:
    read_case(whole_cases()[i])


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
@pytest.mark.parametrize("reader", READERS)
def test_most_of_the_damage_is_damage(reader: str) -> None:
    """Damage that changes nothing tests nothing: some of it is refused, and some is not."""
    require_what_it_needs(reader)
    refused = 0
    for i in range(100):
        try:
            READERS[reader](FromSeed(f"{reader}/{i}"))
        except (ValueError, TypeError, KeyError):
            refused += 1
    assert 10 < refused < 100


def test_an_error_of_another_kind_is_a_finding() -> None:
    def fails() -> None:
        raise IndexError("list index out of range")

    def in_no_words() -> None:
        raise ValueError

    def slowly(error: type[Exception]) -> None:
        until = time.process_time() + 0.02
        while time.process_time() < until:
            pass
        raise error("it is damaged")

    assert "of processor time" in (finding(lambda: slowly(ValueError), most_seconds=0.01) or "")
    assert "IndexError" in (finding(lambda: slowly(IndexError), most_seconds=0.01) or "")
    assert finding(lambda: slowly(ValueError)) is None
    assert "IndexError" in (finding(fails) or "")
    assert "says nothing" in (finding(in_no_words) or "")
    assert finding(lambda: None) is None


@pytest.mark.parametrize("i", range(3))
def test_stores_that_are_whole_are_read_and_used(i: int) -> None:
    require_what_it_needs("store")
    with pytest.warns(pc.PendcoreWarning) if i == 2 else nullcontext():  # of what was not run
        read_store(whole_stores()[i])


def test_damage_is_the_same_for_the_same_seed() -> None:
    whole = pc.Case.textbook().to_toml()
    texts = {damage.text(FromSeed("a"), whole) for _ in range(3)}
    assert len(texts) == 1
    assert damage.text(FromSeed("b"), whole) not in texts
