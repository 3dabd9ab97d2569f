"""`make campaign OF=mutants`: which small mistakes, drawn by a seed, `make test` notices.

    PYTHONPATH=tests python -m mutants.campaign core --count 200 --seed 1
    PYTHONPATH=tests python -m mutants.campaign package --count 200 --seed 1
    PYTHONPATH=tests python -m mutants.campaign package --only 17      # that one again

A line is drawn of all lines in which a mistake can be made, and a mistake on it. A mistake that
makes no program, or the same one, does not count. All mistakes in the core are in one build, and
are switched on one by one; what cannot be switched does not count, and is tried with --only. Each
outcome is written down at once; the same command goes on where it was broken off, and then shows
what is alive.
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

from mutants.mutation import PARSERS, Mutant
from mutants.mutation import mutants as mutants_of
from mutants.workshop import ROOT, Outcome, Place, Workshop

PARTS = {"core": ["cpp/src", "cpp/include", "cpp/bindings"], "package": ["python/pendcore"]}
COUNTED = ("killed", "alive")
AT_ONCE = cpu_count() or 1
"""So many mutants are tested at once."""
SPARE = 1.3
"""So many times the mutants asked for are built into a core: some do not count."""


def main(arguments: list[str] | None = None) -> int:
    """Run a campaign, or go on with it."""
    parser = argparse.ArgumentParser(prog="mutants.campaign", description=__doc__.split("\n")[0])
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, help="of the draw: the record's, or 1")
    parser.add_argument("--commit", help="of which the mutants are: the record's, or HEAD")
    parser.add_argument("--only", type=int, help="the number of one mutant, tried again")
    parser.add_argument("--seconds", type=float, default=1e9, help="begin no mutant after these")
    parser.add_argument("--record", type=Path, help="default: docs/records/mutants/PART.jsonl")
    asked = parser.parse_args(arguments)
    record = asked.record or ROOT / f"docs/records/mutants/{asked.part}.jsonl"
    drawn_from, told = read(record)
    wanted = asked.commit or drawn_from.get("commit", "HEAD")
    seed = drawn_from.get("seed", 1) if asked.seed is None else asked.seed
    source = {"commit": git(ROOT, "rev-parse", wanted), "seed": seed}
    if drawn_from and drawn_from != source:
        parser.error(f"{record} is of another commit or seed: give another --record")
    wide = max(int(SPARE * asked.count), (asked.only or 0) + 1)
    mutants = list(islice(drawn(asked.part, seed, source["commit"]), wide))
    alone = asked.part == "core" and asked.only is not None
    switches = asked.part == "core" and not alone
    workshop = Workshop(source["commit"], dict(enumerate(mutants, 1)) if switches else {})
    without_mistake = workshop.unswitched if switches else workshop.measured
    if not alone and (plain := without_mistake()).what != "alive":
        print(f"the tests fail without a mistake: {plain.by}")
        return 1
    places: SimpleQueue[Place] = SimpleQueue()
    for number in range(0 if alone else AT_ONCE):
        places.put(Place(workshop, number))

    def tested(number: int, mutant: Mutant) -> Outcome:
        if alone:
            return workshop.tested(mutant)
        place = places.get()
        try:
            return place.tested_in_build(number, mutant) if switches else place.tested(mutant)
        finally:
            places.put(place)

    def tried(number: int, mutant: Mutant) -> dict[str, Any]:
        start = time.monotonic()
        outcome = tested(number + 1, mutant)
        seconds = round(time.monotonic() - start, 1)
        found = {"outcome": outcome.what, "by": outcome.by, "seconds": seconds}
        told = asdict(mutant)
        del told["start"], told["end"]  # the draw has them
        return {"number": number, **told, **found}

    if asked.only is not None:
        print(json.dumps(tried(asked.only, mutants[asked.only]), indent=1))
        return 0
    until = time.monotonic() + asked.seconds
    counted = sum(one["outcome"] in COUNTED for one in told)
    left = takewhile(
        lambda _: counted < asked.count and time.monotonic() < until,
        islice(enumerate(mutants), len(told), None),
    )
    record.parent.mkdir(parents=True, exist_ok=True)
    if not drawn_from:
        record.write_text(json.dumps(source) + "\n")
    with tqdm(total=asked.count, initial=counted, unit="mutant", disable=None) as bar:
        for one in in_order(tried, left, AT_ONCE):
            told.append(one)
            with record.open("a") as lines:
                print(json.dumps(one), file=lines)
            if one["outcome"] in COUNTED:
                counted += 1
                bar.update()
    print(report(told))
    if counted < asked.count and len(told) == len(mutants):
        print(f"all {len(mutants)} are tried: a larger --count draws more")
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


def drawn(part: str, seed: int, commit: str) -> Iterator[Mutant]:
    """Return the mutants of a part of the program, each line once, in an order drawn by a seed."""
    dice = Random(f"{seed} {part}")
    by_line: dict[tuple[str, int], list[Mutant]] = {}
    for path in git(ROOT, "ls-tree", "-r", "--name-only", commit, *PARTS[part]).splitlines():
        if Path(path).suffix in PARSERS:
            source = subprocess.check_output(["git", "show", f"{commit}:{path}"], cwd=ROOT)
            for mutant in mutants_of(path, source):
                by_line.setdefault((mutant.path, mutant.line), []).append(mutant)
    lines = sorted(by_line)
    dice.shuffle(lines)
    for line in lines:
        yield dice.choice(by_line[line])


def read(record: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return which commit and seed a campaign draws from, and what it has found so far."""
    if not record.exists():
        return {}, []
    source, *told = map(json.loads, record.read_text().splitlines())
    return source, told


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
