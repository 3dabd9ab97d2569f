"""`make campaign OF=mutants`: which small mistakes, drawn by a seed, `make test` notices.

    PYTHONPATH=tests python -m mutants.campaign core --count 200 --seed 1
    PYTHONPATH=tests python -m mutants.campaign package --count 200 --seed 1
    PYTHONPATH=tests python -m mutants.campaign package --only 17      # that one again

A line is drawn of all lines in which a mistake can be made, and a mistake on it. A mistake that
makes no program, or the same one, does not count. Each outcome is written down at once; the same
command goes on where it was broken off, and then shows what is alive.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict
from itertools import islice, takewhile
from os import cpu_count
from pathlib import Path
from queue import SimpleQueue
from random import Random
from typing import Any

from tqdm import tqdm

from mutants.mutation import PARSERS, Mutant, mutants
from mutants.workshop import ROOT, SOURCE, Outcome, Place, Workshop

PARTS = {"core": ["cpp/src", "cpp/include", "cpp/bindings"], "package": ["python/pendcore"]}
COUNTED = ("killed", "alive")
AT_ONCE = cpu_count() or 1
"""So many mutants of the package are tested at once; the core is built for one at a time."""


def main(arguments: list[str] | None = None) -> int:
    """Run a campaign, or go on with it."""
    parser = argparse.ArgumentParser(prog="mutants.campaign", description=__doc__.split("\n")[0])
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--commit", help="of which the mutants are: the record's, or HEAD")
    parser.add_argument("--only", type=int, help="the number of one mutant, tried again")
    parser.add_argument("--seconds", type=float, default=1e9, help="begin no mutant after these")
    parser.add_argument("--record", type=Path, help="default: docs/records/mutants/PART.jsonl")
    asked = parser.parse_args(arguments)
    record = asked.record or ROOT / f"docs/records/mutants/{asked.part}.jsonl"
    told = read(record)
    wanted = asked.commit or (told[0]["commit"] if told else "HEAD")
    source = {"commit": git(ROOT, "rev-parse", wanted), "seed": asked.seed}
    if any(source.items() - one.items() for one in told):
        parser.error(f"{record} is of another commit or seed: give another --record")
    workshop = Workshop(source["commit"])
    if asked.part == "package" and (plain := workshop.measured()).what != "alive":
        print(f"the tests fail without a mistake: {plain.by}")
        return 1
    tested: Callable[[Mutant], Outcome] = workshop.tested
    if asked.part == "package":
        places: SimpleQueue[Place] = SimpleQueue()
        for number in range(AT_ONCE):
            places.put(Place(workshop, number))

        def tested(mutant: Mutant) -> Outcome:
            place = places.get()
            try:
                return place.tested(mutant)
            finally:
                places.put(place)

    def tried(number: int, mutant: Mutant) -> dict[str, Any]:
        start = time.monotonic()
        outcome = tested(mutant)
        seconds = round(time.monotonic() - start, 1)
        found = {"outcome": outcome.what, "by": outcome.by, "seconds": seconds}
        return {"number": number, **source, **asdict(mutant), **found}

    mutants_drawn = enumerate(drawn(asked.part, asked.seed))
    if asked.only is not None:
        print(json.dumps(tried(*next(islice(mutants_drawn, asked.only, None))), indent=1))
        return 0
    until = time.monotonic() + asked.seconds
    counted = sum(one["outcome"] in COUNTED for one in told)
    left = takewhile(
        lambda _: counted < asked.count and time.monotonic() < until,
        islice(mutants_drawn, len(told), None),
    )
    record.parent.mkdir(parents=True, exist_ok=True)
    with tqdm(total=asked.count, initial=counted, unit="mutant", disable=None) as bar:
        for one in in_order(tried, left, AT_ONCE if asked.part == "package" else 1):
            told.append(one)
            with record.open("a") as lines:
                print(json.dumps(one), file=lines)
            if one["outcome"] in COUNTED:
                counted += 1
                bar.update()
    print(report(told))
    return 0


def in_order(
    function: Callable[..., dict[str, Any]], given: Iterable[tuple[Any, ...]], at_once: int
) -> Iterator[dict[str, Any]]:
    """Yield the results of calls, some of which run at once, in the order of what is given."""
    with ThreadPoolExecutor(at_once) as pool:
        waiting: deque[Future[dict[str, Any]]] = deque()
        for one in given:
            waiting.append(pool.submit(function, *one))
            if len(waiting) > 3 * at_once:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


def drawn(part: str, seed: int) -> Iterator[Mutant]:
    """Return the mutants of a part of the program, each line once, in an order drawn by a seed."""
    dice = Random(f"{seed} {part}")
    by_line: dict[tuple[str, int], list[Mutant]] = {}
    for path in git(SOURCE, "ls-files", *PARTS[part]).splitlines():
        if Path(path).suffix in PARSERS:
            for mutant in mutants(path, (SOURCE / path).read_bytes()):
                by_line.setdefault((mutant.path, mutant.line), []).append(mutant)
    lines = sorted(by_line)
    dice.shuffle(lines)
    for line in lines:
        yield dice.choice(by_line[line])


def read(record: Path) -> list[dict[str, Any]]:
    """Return what a campaign has found so far."""
    return [json.loads(line) for line in record.read_text().splitlines()] if record.exists() else []


def report(told: list[dict[str, Any]]) -> str:
    """Return how many are killed, of each kind, and those that are alive."""
    outcomes = Counter(one["outcome"] for one in told)
    lines = [f"{count:5d}  {what}" for what, count in outcomes.most_common()]
    for kind in sorted({one["kind"] for one in told}):
        of_kind = Counter(one["outcome"] for one in told if one["kind"] == kind)
        lines.append(
            f"{kind}: {of_kind['killed']} of {of_kind['killed'] + of_kind['alive']} killed"
        )
    for one in told:
        if one["outcome"] == "alive":
            place = f"{one['number']}  {one['path']}:{one['line']}"
            lines.append(f"alive: {place}: {one['kind']}: {one['before']!r} -> {one['after']!r}")
    return "\n".join(lines)


def git(folder: Path, *words: str) -> str:
    return subprocess.check_output(["git", *words], cwd=folder, text=True).strip()


if __name__ == "__main__":
    sys.exit(main())
