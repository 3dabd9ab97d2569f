"""THE writer: a page is a template of prose, in which names in braces stand for tables.

A name is that of a function of the page's module, or of tables.py, which is given the record, and
the second word in the braces if there is one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import figures
import forward_figures
import forward_tables
import hard_case_figures
import hard_case_tables
import overview_tables
import solve_tables
import tables
from record import Record

TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True, slots=True)
class Page:
    """`draw` may draw the record into a file beside the page; `record` and `page` lie in docs."""

    template: str
    tables: ModuleType
    draw: Callable[[Record, Path], None] | None
    record: str = "records/comparison/{}.json"
    page: str = "comparison/{}.md"


OF_SOLVES = Page("solves", solve_tables, figures.draw_solves)
PAGES = {
    **dict.fromkeys(overview_tables.NAMES, OF_SOLVES),
    "stiff": Page("stiff", solve_tables, figures.draw_stiff),
    "chains": Page("chains", forward_tables, forward_figures.draw_chains),
    "derivatives": Page("derivatives", forward_tables, None),
    "effects": Page("effects", forward_tables, forward_figures.draw_effects),
    "ensembles": Page("ensembles", solve_tables, figures.draw_ensembles),
    "hard_cases": Page(
        "hard_cases",
        hard_case_tables,
        hard_case_figures.draw,
        record="records/{}.json",
        page="background/{}.md",
    ),
}


def filled(template: str, module: ModuleType, record: Record | Mapping[str, Record]) -> str:
    """Return the template with its tables."""

    def table(found: re.Match[str]) -> str:
        name, argument = found.groups()
        function: Any = getattr(module, name, None) or getattr(tables, name)
        return str(function(record, argument) if argument else function(record))

    text = (TEMPLATES / f"{template}.md").read_text(encoding="utf-8")
    return re.sub(r"\{(\w+)(?: (\w+))?\}", table, text)


def page(stem: str, record: Record) -> str:
    return filled(PAGES[stem].template, PAGES[stem].tables, record)


def overview(records: Mapping[str, Record]) -> str:
    """Make the page on all records of solves that there are, by stem."""
    return filled("overview", overview_tables, records)
