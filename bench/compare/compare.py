"""Run pendcore beside its peers and write records, tables and figures.

Solves of five cases (what accuracy costs), `stiff` (implicit steps), `chains` (forward dynamics of
n links), `derivatives` of them, `effects` (what each adds) and `ensembles` (many runs at once) are
timed in turns, in one run each; `hard_cases` asks who is right. Each writes a record into
docs/records and a page with figures; README.md in docs/comparison covers all solves.
`make compare` builds what is needed and calls this, with ONLY=... for some of them; by hand:

    python bench/compare/compare.py                        all that is timed, twenty minutes
    python bench/compare/compare.py --only chains stiff    some of them
    python bench/compare/compare.py --quick                a few minutes, into out in place of docs
    python bench/compare/compare.py --redraw               pages and figures from the records
    python bench/compare/compare.py --only hard_cases      some minutes
    python bench/compare/compare.py --only bounces         this hard case, the others as recorded
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import chains
import effects
import ensembles
import excerpts
import forward_derivatives
import hard_cases
import pages
import solves
import stiff
from cases import read_case
from contenders.programs import end_conversations
from overview_tables import NAMES
from pages import PAGES
from record import Record
from tqdm import tqdm

PROJECT = Path(__file__).parents[2]
HARD = "hard_cases"
MEASURE = {
    "stiff": stiff.measure,
    "chains": chains.measure,
    "derivatives": forward_derivatives.measure,
    "effects": effects.measure,
    "ensembles": ensembles.measure,
}
TIMED = [*NAMES, *MEASURE]


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=TIMED, help="some (default: all timed ones)")
    parser.add_argument("--rounds", type=int, default=30, help="of the interleaving (default 30)")
    parser.add_argument("--quick", action="store_true", help="3 rounds, fewer points")
    parser.add_argument("--redraw", action="store_true", help="measure nothing, read the records")
    parser.add_argument("--output", type=Path, help="in place of docs")
    asked = parser.parse_args(given)
    known = [*PAGES, *hard_cases.CASES]
    unknown = [name for name in asked.only if name not in known]
    if unknown:
        parser.error(f"--only {' '.join(unknown)}: known are {', '.join(known)}")
    return asked


def measure(stem: str, *, quick: bool, rounds: int) -> Record:
    if stem in NAMES:
        return solves.measure(read_case(stem), quick=quick, rounds=rounds)
    try:
        return MEASURE[stem](quick=quick, rounds=rounds)
    finally:
        end_conversations()


def measure_hard_cases(names: Sequence[str], path: Path) -> None:
    """Run hard cases, and write each at once beside the others that are recorded."""
    for name in tqdm(names, desc="hard cases", disable=None):
        before = Record.read(path) if path.exists() else None
        hard_cases.measure(name, before).write(path)


def redraw(stem: str, docs: Path) -> None:
    """Write the page of a record and its figures."""
    record = Record.read(docs / PAGES[stem].record.format(stem))
    path = docs / PAGES[stem].page.format(stem)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(pages.page(stem, record), encoding="utf-8")
    if draw := PAGES[stem].draw:
        draw(record, path.with_suffix(".png"))
    if (stem, docs) == ("textbook", PROJECT / "docs"):
        excerpts.write(PROJECT, record)
    print(f"written: {path}")


def write_overview(docs: Path) -> None:
    """Write the page on all solves that have a record."""
    paths = {stem: docs / PAGES[stem].record.format(stem) for stem in (*NAMES, "stiff")}
    known = {stem: Record.read(path) for stem, path in paths.items() if path.exists()}
    if known:
        (docs / "comparison/README.md").write_text(pages.overview(known), encoding="utf-8")


def run(stem: str, docs: Path, asked: argparse.Namespace) -> None:
    """Measure, unless the record shall do, and write page and figures."""
    path = docs / PAGES[stem].record.format(stem)
    try:
        if stem == HARD and not asked.redraw:
            chosen = [name for name in hard_cases.CASES if name in asked.only]
            measure_hard_cases(chosen or list(hard_cases.CASES), path)
        elif not asked.redraw:
            rounds = 3 if asked.quick else asked.rounds
            measure(stem, quick=asked.quick, rounds=rounds).write(path)
    finally:
        if path.exists():
            redraw(stem, docs)


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    docs = asked.output or PROJECT / ("out" if asked.quick else "docs")
    try:
        for stem in dict.fromkeys(name if name in PAGES else HARD for name in asked.only):
            run(stem, docs, asked)
    except KeyboardInterrupt:
        print("stopped; what was not finished was not written", file=sys.stderr)
        return 130
    finally:
        write_overview(docs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
