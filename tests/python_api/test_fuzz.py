"""A few hundred cases of `make campaign` OF=fuzz and OF=readers, the same in every run."""

from __future__ import annotations

import pytest
from fuzz import campaign
from fuzz.choices import FromSeed
from fuzz.drawn_run import TIME_LIMIT
from fuzz.readers import (
    READERS,
    finding,
    read_archive,
    read_case,
    whole_archives,
    whole_cases,
)

CASES = 400
SEED = "ci"


def test_random_cases_end_in_time_and_keep_every_claim():
    """The whole campaign, of a hundred thousand cases, is `make campaign OF=fuzz`."""
    told = campaign.run(SEED, range(CASES))
    assert told.outcomes.total() == CASES
    assert not told.failed, campaign.report_of("", told, SEED, 0)
    assert 0 < told.longest[0] < 4 * TIME_LIMIT


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_what_is_whole_is_read_and_used():
    for data in whole_archives():
        read_archive(data)
    for text in whole_cases():
        read_case(text)


TIMES = {"case": 200, "archive": 200, "state": 400, "scene": 200, "store": 100}


@pytest.mark.parametrize("reader", READERS)
def test_what_is_damaged_is_refused_in_words_or_used(reader):
    """And in time: an input that takes more processor time than `MOST_SECONDS` is a finding."""
    if reader == "store":
        pytest.importorskip("zarr", exc_type=ImportError)
    for i in range(TIMES[reader]):
        found = finding(lambda: READERS[reader](FromSeed(f"{reader}/{i}")))  # noqa: B023
        assert found is None, f"{reader}/{i}: {found}"
