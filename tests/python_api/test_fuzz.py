"""A few hundred cases of `make fuzz` and of `make fuzz-readers`, the same in every run."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pendcore as pc
import pytest
from fuzz import campaign, claims
from fuzz.choices import FromSeed
from fuzz.drawn_run import TIME_LIMIT, Drawn, drawn
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
from pendcore._scene.effect_class import KINDS

CASES = 400
SEED = "ci"


def test_random_cases_end_in_time_and_keep_every_claim():
    """The whole campaign, of a hundred thousand cases, is `make fuzz`."""
    told = campaign.run(SEED, range(CASES))
    assert told.outcomes.total() == CASES
    assert not told.failed, campaign.report_of("", told, SEED, 0)
    assert 0 < told.longest[0] < 4 * TIME_LIMIT


def test_the_cases_are_of_every_kind():
    cases = []
    for i in range(CASES):
        try:
            cases.append(drawn(FromSeed(f"{SEED}/{i}")))
        except ValueError:
            continue
    assert len(cases) > 0.8 * CASES
    kinds = {effect.kind for case in cases for effect in case.scene.effects}
    assert kinds >= set(KINDS) - {"compiled_user"}
    assert {len(case.scene.links) for case in cases} == {1, 2, 3, 4, 5, 6}
    spans = np.array([case.t_span[1] - case.t_span[0] for case in cases])
    assert all(some.any() for some in (spans < 0, spans == 0, spans > 1e3))
    assert any(0 < abs(x) < 1e-10 for x in spans)


class Broken:
    """A solution like another one, except for the given entries."""

    def __init__(self, sol, **changes):
        self._sol = sol
        self._changes = changes

    def __getattr__(self, name):
        return self._changes[name] if name in self._changes else getattr(self._sol, name)

    def __call__(self, t):
        return self._changes.get("at", self._sol)(t)


def case_of(**options):
    how = {"max_steps": 500, "time_limit": 5.0} | options
    return Drawn(pc.Scene.textbook(), [0.3, 1.0], [0.0, 0.0], (0.0, 0.5), how)


NOT_FINITE = np.array([[0.3, 1.0, 0, 0], [np.nan, 1.0, 0, 0]]).T
ANOTHER = case_of(rtol=1e-7).simulate()
MISTAKES = {
    "another status": (claims.says_how_it_ended, {"status": "splendid"}),
    "no message": (claims.says_how_it_ended, {"message": ""}),
    "a success that is none": (claims.says_how_it_ended, {"success": False}),
    "time runs back": (claims.times_run_one_way, {"t": np.array([0, 0.2, 0.1])}),
    "a NaN that is not said": (claims.is_finite, {"y": NOT_FINITE}),
    "beside the steps": (
        claims.dense_output_meets_the_steps,
        {"at": lambda t: np.ones((4, len(t)))},
    ),
    "NaN": (claims.dense_output_meets_the_steps, {"at": lambda t: np.full((4, len(t)), np.nan)}),
    "storing changes it": (claims.storing_changes_nothing, ANOTHER),
    "resuming changes it": (claims.resuming_changes_nothing, ANOTHER),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_breach_is_seen(mistake):
    claim, changes = MISTAKES[mistake]
    case = case_of(rtol=1e-6)
    sol = case.simulate()
    other = Broken(sol, **changes) if isinstance(changes, dict) else changes
    assert not list(claim(case, sol, FromSeed("y")))
    assert list(claim(case, other, FromSeed("y")))


# Damaged files and pickles -----------------------------------------------------------------------

TIMES = {"case": 200, "archive": 200, "state": 400, "scene": 200, "store": 100}


@pytest.mark.parametrize("reader", READERS)
def test_what_is_damaged_is_refused_in_words_or_used(reader):
    """And in time: an input that takes more processor time than `MOST_SECONDS` is a finding."""
    if reader == "store":
        pytest.importorskip("zarr", exc_type=ImportError)
    for i in range(TIMES[reader]):
        found = finding(lambda: READERS[reader](FromSeed(f"{reader}/{i}")))  # noqa: B023
        assert found is None, f"{reader}/{i}: {found}"


WHOLE = [(read_archive, one) for one in whole_archives()]
WHOLE += [(read_case, one) for one in whole_cases()]


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
@pytest.mark.parametrize(("read", "whole"), WHOLE, ids=lambda x: getattr(x, "__name__", ""))
def test_what_is_whole_is_read_and_used(read, whole):
    read(whole)


@pytest.mark.parametrize("i", range(3))
def test_stores_that_are_whole_are_read_and_used(i):
    pytest.importorskip("zarr", exc_type=ImportError)
    with pytest.warns(pc.PendcoreWarning) if i == 2 else nullcontext():  # of what was not run
        read_store(whole_stores()[i])
