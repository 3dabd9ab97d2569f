"""Some hundred cases of `make campaign` OF=fuzz and OF=readers, the same in every run."""

from __future__ import annotations

import os
import time
from types import SimpleNamespace

import numpy as np
import pendcore as pc
import pytest
from fuzz import campaign, claims, watch
from fuzz.choices import FromSeed
from fuzz.drawn_run import TIME_LIMIT, Drawn
from fuzz.readers import READERS, finding, read_archive, read_case, whole_archives, whole_cases
from fuzz.verdict import Verdict
from sweeps import random_examples

CASES = random_examples(1000)
SEED = "ci"


def test_random_cases_end_in_time_and_keep_every_claim():
    """The whole campaign, of a hundred thousand cases, is `make campaign OF=fuzz`."""
    told = campaign.run(SEED, range(CASES))
    assert told.outcomes.total() == CASES
    assert not told.failed, campaign.report_of("", told, SEED, 0)
    assert 0 < told.longest[0] < 4 * TIME_LIMIT


def deliberate(case: str) -> Verdict:
    if case == "crash":
        os.abort()
    if case == "hang":
        time.sleep(600)
    return Verdict(case)


@pytest.mark.unsanitized
def test_a_crash_and_a_hang_are_told_and_the_next_case_is_judged():
    cases = ["crash", "fine", "hang", "fine"]
    found = list(watch.run(deliberate, cases, patience=3.0))
    assert [verdict.outcome for verdict in found] == cases
    assert [len(verdict.breaches) for verdict in found] == [1, 0, 1, 0]
    assert "Fatal Python error: Aborted" in found[0].breaches[0]


def test_a_nan_breaks_a_claim():
    case = Drawn(pc.Scene.textbook(), [0.3, 1.0], [0.0, 0.0], (0.0, 1.0))
    sol = case.simulate()
    assert list(claims.is_finite(case, sol, FromSeed(""))) == []
    bad = SimpleNamespace(t=sol.t, y=np.nan * sol.y, _run=sol._run, status="finished")
    (breach,) = claims.is_finite(case, bad, FromSeed(""))
    assert breach == "y is not finite, status 'finished'"


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_what_is_whole_is_read_and_used():
    for data in whole_archives():
        read_archive(data)
    for text in whole_cases():
        read_case(text)


TIMES = {"case": 200, "archive": 100, "state": 400, "scene": 200, "store": 40}


@pytest.mark.few_cases
@pytest.mark.parametrize("reader", READERS)
def test_what_is_damaged_is_refused_in_words_or_used(reader):
    """And in time: an input that takes more processor time than `MOST_SECONDS` is a finding."""
    if reader == "store":
        pytest.importorskip("zarr", exc_type=ImportError)
    for i in range(random_examples(TIMES[reader])):
        found = finding(lambda: READERS[reader](FromSeed(f"{reader}/{i}")))  # noqa: B023
        assert found is None, f"{reader}/{i}: {found}"
