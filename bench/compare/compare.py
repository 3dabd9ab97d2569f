"""Run pendcore beside its peers, interleaved in one run, and write the times that they take.

Solves of five cases (what accuracy costs), `stiff` (implicit steps), `chains` (forward dynamics of
n links), `effects` (what each adds) and `ensembles` (many runs at once). Each writes
docs/comparison/*.md (tables) and *.png, and docs/records/comparison/*.json (raw figures, machine,
versions, flags); README.md beside the pages covers all solves.
`make compare` builds what is needed and calls this; by hand:

    python bench/compare/compare.py                        twenty minutes
    python bench/compare/compare.py --only chains stiff    some of them
    python bench/compare/compare.py --quick                a few minutes, into out in place of docs
    python bench/compare/compare.py --redraw               tables and figures from the JSON
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import chains
import chains_figure
import chains_page
import effects
import effects_figure
import effects_page
import ensembles
import ensembles_figure
import ensembles_page
import excerpts
import figure
import overview
import page
import solves
import stiff
import stiff_figure
import stiff_page
from cases import read_case

PROJECT = Path(__file__).parents[2]

Record = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A comparison: `stem` names its files, and `measure` takes `quick` and `rounds`."""

    stem: str
    measure: Callable[..., Record]
    page: Callable[[Record], str]
    draw: Callable[[Record, Path], None]
    summary: Callable[[Record], str]


def of_solves(case: str) -> Comparison:
    def measure(*, quick: bool, rounds: int) -> Record:
        return solves.measure(read_case(case), quick=quick, rounds=rounds)

    return Comparison(
        stem=case, measure=measure, page=page.page, draw=figure.draw, summary=page.summary
    )


def of_pages(stem: str, measuring: Any, pages: Any, figures: Any) -> Comparison:
    """Gather modules that measure, write and draw under these names."""
    return Comparison(
        stem=stem,
        measure=measuring.measure,
        page=pages.page,
        draw=figures.draw,
        summary=pages.summary,
    )


COMPARISONS = {
    **{case: of_solves(case) for case in page.ABOUT},
    "stiff": of_pages("stiff", stiff, stiff_page, stiff_figure),
    "chains": of_pages("chains", chains, chains_page, chains_figure),
    "effects": of_pages("effects", effects, effects_page, effects_figure),
    "ensembles": of_pages("ensembles", ensembles, ensembles_page, ensembles_figure),
}


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--only", choices=COMPARISONS, nargs="+", help="some (default all)")
    parser.add_argument(
        "--rounds", type=int, default=30, help="rounds of the interleaving (default 30)"
    )
    parser.add_argument("--quick", action="store_true", help="3 rounds, fewer points")
    parser.add_argument("--redraw", action="store_true", help="measure nothing, read the JSON")
    parser.add_argument("--output", type=Path, help="in place of docs")
    return parser.parse_args(given)


def record_path(docs: Path, stem: str) -> Path:
    return docs / "records/comparison" / f"{stem}.json"


def run(comparison: Comparison, docs: Path, asked: argparse.Namespace) -> Record:
    """Measure, or read the record, and write the page and the figure."""
    raw = record_path(docs, comparison.stem)
    page_path = docs / "comparison" / f"{comparison.stem}.md"
    if asked.redraw:
        record: Record = json.loads(raw.read_text(encoding="utf-8"))
    else:
        record = comparison.measure(quick=asked.quick, rounds=3 if asked.quick else asked.rounds)
        raw.parent.mkdir(parents=True, exist_ok=True)
        raw.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    page_path.parent.mkdir(parents=True, exist_ok=True)
    page_path.write_text(comparison.page(record), encoding="utf-8")
    comparison.draw(record, page_path.with_suffix(".png"))
    print(comparison.summary(record))
    print(f"written: {raw}, {page_path}, {page_path.stem}.png\n")
    return record


def write_overview(docs: Path) -> None:
    """Write the page on all solves that have a record."""
    stems = [*page.ABOUT, "stiff"]
    records = {stem: record_path(docs, stem) for stem in stems}
    known = {
        stem: json.loads(path.read_text(encoding="utf-8"))
        for stem, path in records.items()
        if path.exists()
    }
    if known:
        (docs / "comparison/README.md").write_text(overview.page(known), encoding="utf-8")


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    docs = asked.output or PROJECT / ("out" if asked.quick else "docs")
    try:
        for name in asked.only or COMPARISONS:
            record = run(COMPARISONS[name], docs, asked)
            if (name, docs) == ("textbook", PROJECT / "docs"):
                excerpts.write(PROJECT, record)
    except KeyboardInterrupt:
        print("stopped; what was not finished was not written", file=sys.stderr)
        return 130
    finally:
        write_overview(docs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
