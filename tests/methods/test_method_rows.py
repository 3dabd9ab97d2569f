"""The descriptor of every method is complete, so that no other file need name the method."""

from __future__ import annotations

import pendcore as pc
import pytest
from pendcore._run.methods import known_methods, line_style, most_accurate

METHODS = known_methods()


@pytest.mark.parametrize("method", METHODS)
def test_a_method_has_words_a_source_and_a_line_of_its_own(method: str) -> None:
    known = METHODS[method]
    assert known["sentence"].endswith(".")
    assert known["citation"]
    others = [line_style(other) for other in METHODS if other != method]
    assert line_style(method) not in others
    assert f'``"{method}"``' in (pc.simulate.__doc__ or "")


@pytest.mark.parametrize("method", METHODS)
def test_a_method_that_chooses_its_steps_says_how_large_its_error_is(method: str) -> None:
    """Fixed steps have no tolerance to choose: ``error=`` never takes them."""
    known = METHODS[method]
    assert (known["error_over_rtol"] > 0) == (known["error_order"] > 0)


def test_no_two_methods_have_one_place_among_second_opinions() -> None:
    places = [one["second_opinion"] for one in METHODS.values() if one["second_opinion"]]
    assert sorted(places) == [*range(1, len(places) + 1)]
    assert len(most_accurate()) == len(places)
