"""Every method of the core has its rows in the tables of Python that name methods.

CONTRIBUTING.md, "Add a method", step 4, says what they are for.
"""

from __future__ import annotations

import pytest
from pendcore.accuracy.method_choice import ERROR_OVER_RTOL, MOST_ACCURATE
from pendcore.accuracy.trials import IMPLICIT
from pendcore.cost.figure import STYLES
from pendcore.run.methods import known_methods

METHODS = known_methods()
ONE_BY_ONE = [
    name for name, m in METHODS.items() if m["kind"] in ("explicit", "implicit", "taylor")
]
"""Not those that change between others."""
NEVER_CHOSEN = {"rk4": "takes fixed steps only: there is no tolerance to choose"}
"""For an error that is asked for, and why."""
STEP_4 = 'see step 4 of "Add a method" in CONTRIBUTING.md'


@pytest.mark.parametrize("method", ONE_BY_ONE)
def test_it_is_known_how_large_a_methods_error_is_or_why_not(method):
    assert (method in ERROR_OVER_RTOL) != (method in NEVER_CHOSEN), (
        f"{method}: measure its error at a tolerance and add it to ERROR_OVER_RTOL of "
        f"method_choice.py, or say in NEVER_CHOSEN here why error= never takes it; {STEP_4}"
    )


@pytest.mark.parametrize("method", METHODS)
def test_a_method_has_a_line_of_its_own_in_the_figures(method):
    assert method in STYLES, (
        f"{method}: is drawn as any other unknown: give it a colour, a dash and a marker in STYLES "
        f"of views/accuracy_cost.py; {STEP_4}"
    )


@pytest.mark.parametrize(
    ("table", "names"),
    {
        "accuracy.method_choice.ERROR_OVER_RTOL": ERROR_OVER_RTOL,
        "accuracy.trials.IMPLICIT": [IMPLICIT],
        "accuracy.method_choice.MOST_ACCURATE": MOST_ACCURATE,
        "views.accuracy_cost.STYLES": STYLES,
        "NEVER_CHOSEN": NEVER_CHOSEN,
    }.items(),
)
def test_no_table_names_a_method_that_is_none(table, names):
    assert set(names) <= set(METHODS), f"{table}: {set(names) - set(METHODS)}: the core has none"
