"""The comparison of whole solves: what accuracy costs, pendcore and its peers on one case."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import contenders
from cases import Case, one_step
from contenders.contender import Contender, Run, Unsupported
from contenders.programs import end_conversations
from machine import circumstances
from measure import achieved, interleave
from record import ONE_STEP, Point, Record
from tqdm import tqdm

ONE_STEP_SETTINGS = {"tolerance": 1e-6, "step": 1e-4}
BURST_SECONDS = 1e-3
SECONDS_A_RUN = 0.6  # enough for 30 calls that take less than 20 ms each
LONGEST = 0.5  # s; a contender that takes longer at a setting is not tried with tighter ones
PER_DECADE = 4
FOR_STIFF_SCENES = ("-radau5", "cyrk_nbsolve2_lsoda", "cyrk_nbsolve2_radau", "cyrk_nbsolve2_bdf")
FACTS = ("label", "about", "ours", "sides", "setting")

Key = tuple[str, Any]
"""Contender and setting."""


def for_any_scene(name: str) -> bool:
    return not any(part in name for part in FOR_STIFF_SCENES)


def first_look(
    who: Contender, case: Case, settings: list[float]
) -> tuple[list[Point], dict[Key, Run]]:
    """Find what a contender achieves at each setting; return rows, and runs to be timed.

    If no setting succeeds, there are no runs.
    """
    rows: list[Point] = []
    runs: dict[Key, Run] = {}
    given_up = ""
    for setting in settings:
        row: Point = {"contender": who.name, "case": case.name, "setting": setting}
        rows.append(row)
        if given_up:
            row["failure"] = given_up
            continue
        run = who.prepare(case, setting)
        begin = time.perf_counter()
        row |= achieved(run, case)
        if time.perf_counter() - begin > LONGEST:
            given_up = "not run: it would take too long"
        if "failure" not in row:
            runs[who.name, setting] = run
    if runs:
        short = who.prepare(one_step(case), ONE_STEP_SETTINGS[who.setting])
        row = {"contender": who.name, "case": case.name, "setting": ONE_STEP}
        rows.append(row | {"evaluations": short.outcome().evaluations})
        runs[who.name, ONE_STEP] = short
        waits = [run.compile_seconds for run in runs.values() if run.compile_seconds]
        if waits:
            rows[-1] |= {"compiling_least_s": min(waits), "compiling_most_s": max(waits)}
    return rows, runs


def measure(
    case: Case,
    *,
    quick: bool,
    rounds: int,
    takes_part: Callable[[str], bool] = for_any_scene,
    tightest: float = 0.0,
    facts: Mapping[str, Any] | None = None,
) -> Record:
    """Measure everything that is here.

    `takes_part` chooses contenders by name; settings below the `tightest` are not tried; `facts`
    are further ones of the case.
    """
    begin = time.perf_counter()
    entrants, absent = contenders.installed()
    rows: list[Point] = []
    runs: dict[Key, Run] = {}
    looked: dict[str, Any] = {}
    try:
        bar = tqdm([who for who in entrants if takes_part(who.name)], leave=False, disable=None)
        for who in bar:
            bar.set_description(f"{case.name}: {who.label}")
            settings = who.settings(1 if quick or who.slow else PER_DECADE)
            try:
                found = first_look(who, case, [one for one in settings if one > 0.9 * tightest])
            except Unsupported as reason:
                absent[who.label] = str(reason)
                continue
            rows += found[0]
            runs |= found[1]
            looked[who.name] = {name: getattr(who, name) for name in FACTS}
        timings = interleave(runs, rounds, BURST_SECONDS, SECONDS_A_RUN, f"{case.name}: rounds")
    finally:
        end_conversations()
    for row in rows:
        if "failure" not in row:
            row |= timings[row["contender"], row["setting"]].row("us", 1e6)
    measured = {"comparison": case.name, **circumstances(begin, rounds, BURST_SECONDS)}
    known = {
        "uncertainty": case.uncertainty,
        "duration": float(case.times[-1] - case.times[0]),
        "times": len(case.times),
    }
    cases = {case.name: {**(facts or {}), **known}}
    return Record.of({**measured, "absent": absent}, looked, cases, rows)
