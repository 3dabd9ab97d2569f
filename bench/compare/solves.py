"""The comparison of whole solves: what accuracy costs, pendcore and its peers on one case."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import contenders
from cases import Case, one_step
from contenders.compiled import end_conversations
from contenders.contender import Contender, Run, Unsupported
from machine import circumstances
from measure import Timing, achieved, interleave
from tqdm import tqdm

ONE_STEP_SETTINGS = {"tolerance": 1e-6, "step": 1e-4}
BURST_SECONDS = 1e-3
SECONDS_A_RUN = 0.6  # enough for 30 calls that take less than 20 ms each
LONGEST = 0.5  # s; a contender that takes longer at a setting is not tried with tighter ones
PER_DECADE = 4

Key = tuple[str, float | None]  # contender and setting; None for the call of one step
Record = dict[str, Any]


FOR_STIFF_SCENES = ("-radau5", "cyrk_nbsolve2_lsoda", "cyrk_nbsolve2_radau", "cyrk_nbsolve2_bdf")


def for_any_scene(name: str) -> bool:
    return not any(part in name for part in FOR_STIFF_SCENES)


class Look:
    """A first look at a contender: what it achieves at each setting, and runs to be timed.

    If no setting succeeds, there are no runs.
    """

    def __init__(self, contender: Contender, case: Case, settings: list[float]) -> None:
        self.contender = contender
        self.points: list[Record] = []
        self.runs: dict[Key, Run] = {}
        given_up = ""
        for setting in settings:
            point: Record = {"setting": setting}
            if given_up:
                self.points.append({**point, "failure": given_up})
                continue
            run = contender.prepare(case, setting)
            begin = time.perf_counter()
            self.points.append(point | achieved(run, case))
            if time.perf_counter() - begin > LONGEST:
                given_up = "not run: it would take too long"
            if "failure" not in self.points[-1]:
                self.runs[contender.name, setting] = run
        if self.runs:
            short = contender.prepare(one_step(case), ONE_STEP_SETTINGS[contender.setting])
            self.short_evaluations = short.outcome().evaluations
            self.runs[contender.name, None] = short

    def record(self, timings: dict[Key, Timing]) -> Record:
        """Return the contender and its points, as JSON holds them."""
        who = self.contender
        compiling = [run.compile_seconds for run in self.runs.values() if run.compile_seconds]
        return {
            "name": who.name,
            "label": who.label,
            "about": who.about,
            "ours": who.ours,
            "sides": list(who.sides),
            "setting": who.setting,
            "compile_seconds": [min(compiling), max(compiling)] if compiling else None,
            "one_step": {
                "evaluations": self.short_evaluations,
                **microseconds(timings[who.name, None]),
            }
            if self.runs
            else None,
            "points": [
                point if "failure" in point else point | microseconds(timings[who.name, setting])
                for point in self.points
                for setting in [point["setting"]]
            ],
        }


def microseconds(timing: Timing) -> Record:
    return {
        "minimum_us": 1e6 * timing.minimum,
        "median_us": 1e6 * timing.median,
        "calls": timing.calls,
    }


def measure(
    case: Case,
    *,
    quick: bool,
    rounds: int,
    takes_part: Callable[[str], bool] = for_any_scene,
    tightest: float = 0.0,
) -> Record:
    """Measure everything that is here; return the record, with the machine, as JSON holds it.

    `takes_part` chooses contenders by name; settings below the `tightest` are not tried.
    """
    begin = time.perf_counter()
    entrants, absent = contenders.installed()
    looks: list[Look] = []
    try:
        bar = tqdm([who for who in entrants if takes_part(who.name)], leave=False, disable=None)
        for who in bar:
            bar.set_description(f"{case.name}: {who.label}")
            each = who.settings(1 if quick or who.slow else PER_DECADE)
            try:
                looks.append(Look(who, case, [one for one in each if one > 0.9 * tightest]))
            except Unsupported as reason:
                absent[who.label] = str(reason)
        runs = {key: run for look in looks for key, run in look.runs.items()}
        turns = tqdm(range(rounds), desc=f"{case.name}: rounds", unit="round", disable=None)
        timings = interleave(runs, turns, BURST_SECONDS, SECONDS_A_RUN)
    finally:
        end_conversations()
    return {
        "case": case.name,
        **circumstances(begin, rounds, BURST_SECONDS),
        "uncertainty": case.uncertainty,
        "duration": float(case.times[-1] - case.times[0]),
        "times": len(case.times),
        "absent": absent,
        "contenders": [look.record(timings) for look in looks],
    }
