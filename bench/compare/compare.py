"""Run pendcore and its peers on one case, interleaved in one run, and write what accuracy costs.

Writes into docs/comparison: CASE.json (raw figures, machine, versions, flags), CASE.md (tables) and
CASE.png (work against precision). `make compare` builds what is needed and calls this; by hand:

    python bench/compare/compare.py            some minutes
    python bench/compare/compare.py --quick    a quarter of a minute, into out/comparison
    python bench/compare/compare.py --redraw   tables and figure from the JSON, nothing measured
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import contenders
import excerpts
import figure
import page
from cases import Case, one_step, read_case
from contenders.contender import Contender, Run, Unsupported
from machine import machine
from measure import Timing, achieved, interleave
from tqdm import tqdm

PROJECT = Path(__file__).parents[2]
ONE_STEP_TOLERANCE = 1e-6

Key = tuple[str, float | None]  # contender and tolerance; None for the call of one step


def ladder(per_decade: int) -> list[float]:
    """List tolerances from 1e-1 to 1e-13, the whole decades exact."""
    finer = [10.0 ** -(part / per_decade) for part in range(per_decade)]
    return [float(f"1e-{decade}") * share for decade in range(1, 13) for share in finer] + [1e-13]


def prepare(entrants: list[Contender], case: Case, tolerances: list[float]) -> dict[Key, Run]:
    """Prepare all runs of the contenders that carry the case; the others are named on stderr."""
    runs: dict[Key, Run] = {}
    for contender in entrants:
        try:
            runs |= {(contender.name, tol): contender.prepare(case, tol) for tol in tolerances}
            runs[contender.name, None] = contender.prepare(one_step(case), ONE_STEP_TOLERANCE)
        except Unsupported as reason:
            print(f"{contender.label}: left out: {reason}", file=sys.stderr)
    return runs


def microseconds(timing: Timing) -> dict[str, float | int]:
    return {
        "minimum_us": 1e6 * timing.minimum,
        "median_us": 1e6 * timing.median,
        "calls": timing.calls,
    }


def measure(case: Case, per_decade: int, rounds: int, burst_seconds: float) -> dict[str, Any]:
    """Measure all there is, and say on what: the record, as JSON holds it."""
    begin = time.perf_counter()
    tolerances = ladder(per_decade)
    entrants = contenders.installed()
    runs = prepare(entrants, case, tolerances)
    points = {key: achieved(run, case) for key, run in runs.items() if key[1] is not None}
    bar = tqdm(range(rounds), desc="rounds", unit="round", disable=None)
    timed = {key: run for key, run in runs.items() if "failure" not in points.get(key, {})}
    timings = interleave(timed, bar, burst_seconds)
    return {
        "case": case.name,
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "rounds": rounds,
        "burst_seconds": burst_seconds,
        "seconds_in_all": round(time.perf_counter() - begin, 1),
        "machine": machine(),
        "contenders": [
            {
                "name": contender.name,
                "label": contender.label,
                "about": contender.about,
                "compile_seconds": contender.compile_seconds,
                "one_step": {
                    "evaluations": runs[contender.name, None].outcome().evaluations,
                    **microseconds(timings[contender.name, None]),
                },
                "points": [
                    {"tolerance": tol, **points[contender.name, tol]}
                    | (
                        microseconds(timings[key])
                        if (key := (contender.name, tol)) in timings
                        else {}
                    )
                    for tol in tolerances
                ],
            }
            for contender in entrants
            if (contender.name, None) in runs
        ],
    }


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--case", default="textbook", help="name in tests/data/trajectories.json")
    parser.add_argument(
        "--rounds", type=int, default=30, help="rounds of the interleaving (default 30)"
    )
    parser.add_argument("--quick", action="store_true", help="3 rounds, whole decades only")
    parser.add_argument("--redraw", action="store_true", help="measure nothing, read the JSON")
    parser.add_argument("--output", type=Path, help="folder (default docs/comparison)")
    return parser.parse_args(given)


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    folder = asked.output or PROJECT / ("out/comparison" if asked.quick else "docs/comparison")
    raw = folder / f"{asked.case}.json"
    try:
        if asked.redraw:
            record = json.loads(raw.read_text(encoding="utf-8"))
        else:
            rounds, per_decade = (3, 1) if asked.quick else (asked.rounds, 4)
            record = measure(read_case(asked.case), per_decade, rounds, burst_seconds=1e-3)
            folder.mkdir(parents=True, exist_ok=True)
            raw.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    except KeyboardInterrupt:
        print("stopped; nothing was written", file=sys.stderr)
        return 130
    raw.with_suffix(".md").write_text(page.page(record), encoding="utf-8")
    figure.draw(record, raw.with_suffix(".png"))
    if folder == PROJECT / "docs/comparison" and asked.case == "textbook":
        excerpts.write(PROJECT, record)
    print(page.summary(record))
    print(f"written: {raw}, {raw.stem}.md, {raw.stem}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
