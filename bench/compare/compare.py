"""Run pendcore beside its peers, interleaved in one run, and write what they take.

Four comparisons: `solves` (what accuracy costs, on a case), `chains` (forward dynamics of n links),
`effects` (what each adds) and `stiff` (implicit steps). Each writes into docs/comparison a .json
(raw figures, machine, versions, flags), a .md (tables) and a .png. `make compare` builds what is
needed and calls this; by hand:

    python bench/compare/compare.py                  some minutes
    python bench/compare/compare.py --only chains    one of the four
    python bench/compare/compare.py --quick          half a minute, into out/comparison
    python bench/compare/compare.py --redraw         tables and figures from the JSON
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import chains
import chains_figure
import chains_page
import effects
import effects_figure
import effects_page
import excerpts
import figure
import page
import solves
import stiff
import stiff_figure
import stiff_page

PROJECT = Path(__file__).parents[2]

Record = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """`stem` names the files; `measure` takes `quick` and `rounds`."""

    stem: str
    measure: Callable[..., Record]
    page: Callable[[Record], str]
    draw: Callable[[Record, Path], None]
    summary: Callable[[Record], str]


def comparisons(case: str) -> dict[str, Comparison]:
    """List all, by name."""
    return {
        "solves": Comparison(
            stem=case,
            measure=partial(solves.measure, case),
            page=page.page,
            draw=figure.draw,
            summary=page.summary,
        ),
        "chains": Comparison(
            stem="chains",
            measure=chains.measure,
            page=chains_page.page,
            draw=chains_figure.draw,
            summary=chains_page.summary,
        ),
        "effects": Comparison(
            stem="effects",
            measure=effects.measure,
            page=effects_page.page,
            draw=effects_figure.draw,
            summary=effects_page.summary,
        ),
        "stiff": Comparison(
            stem="stiff",
            measure=stiff.measure,
            page=stiff_page.page,
            draw=stiff_figure.draw,
            summary=stiff_page.summary,
        ),
    }


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--only", choices=comparisons(""), help="one comparison (default all)")
    parser.add_argument("--case", default="textbook", help="name in tests/data/trajectories.json")
    parser.add_argument(
        "--rounds", type=int, default=30, help="rounds of the interleaving (default 30)"
    )
    parser.add_argument("--quick", action="store_true", help="3 rounds, fewer points")
    parser.add_argument("--redraw", action="store_true", help="measure nothing, read the JSON")
    parser.add_argument("--output", type=Path, help="folder (default docs/comparison)")
    return parser.parse_args(given)


def run(comparison: Comparison, folder: Path, asked: argparse.Namespace) -> Record:
    """Measure, or read the record, and write what is made of it."""
    raw = folder / f"{comparison.stem}.json"
    if asked.redraw:
        record: Record = json.loads(raw.read_text(encoding="utf-8"))
    else:
        record = comparison.measure(quick=asked.quick, rounds=3 if asked.quick else asked.rounds)
        folder.mkdir(parents=True, exist_ok=True)
        raw.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    raw.with_suffix(".md").write_text(comparison.page(record), encoding="utf-8")
    comparison.draw(record, raw.with_suffix(".png"))
    print(comparison.summary(record))
    print(f"written: {raw}, {raw.stem}.md, {raw.stem}.png\n")
    return record


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    folder = asked.output or PROJECT / ("out/comparison" if asked.quick else "docs/comparison")
    known = comparisons(asked.case)
    try:
        for name in [asked.only] if asked.only else known:
            record = run(known[name], folder, asked)
            if (name, asked.case, folder) == ("solves", "textbook", PROJECT / "docs/comparison"):
                excerpts.write(PROJECT, record)
    except KeyboardInterrupt:
        print("stopped; what was not finished was not written", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
