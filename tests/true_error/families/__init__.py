"""The families that scenes are drawn from, each with seeds of its own."""

from __future__ import annotations

from collections.abc import Callable

from true_error.drawn import Drawn
from true_error.families.chaotic import chaotic
from true_error.families.contact import contact
from true_error.families.damped import damped
from true_error.families.mixed import mixed
from true_error.families.own import own
from true_error.families.short_links import short_links
from true_error.families.stiff import stiff

FAMILIES: dict[str, Callable[[int], Drawn]] = {
    "mixed": mixed,
    "damped": damped,
    "chaotic": chaotic,
    "stiff": stiff,
    "contact": contact,
    "own": own,
    "short_links": short_links,
}
