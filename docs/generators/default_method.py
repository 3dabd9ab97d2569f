"""The method and tolerances that `simulate` takes by default, and the measurements behind them.

    make write PAGE=default_method

It writes two tables of docs/background/accuracy_cost.md, and docs/records/default_method.json:
errors and times of the default at several tolerances on 200 random regular scenes, beside dopri5;
and times of the methods at the same achieved error on chains. Times are ratios of calls in turns,
Python included.
"""

from __future__ import annotations

import json
import sys
from functools import partial
from math import inf
from typing import Any

import numpy as np
import pendcore as pc
from asked_errors import least_times
from page_part import ROOT, rewrite, table_of
from tqdm import tqdm

sys.path += [str(ROOT / "tests"), str(ROOT / "tests/models")]
from regular_scenes import EXACT, REGULAR, Regular, growth, scene_and_start

SCENES = range(1200, 1400)
"""Seeds other than those from which the bounds of accuracy/method_choice.py were measured."""
ROUNDS = 7
DEFAULT = "the default"
WAYS: dict[str, dict[str, Any]] = {
    **{
        f"{DEFAULT}, rtol 1e-{k}": {"rtol": 10.0**-k, "atol": 10.0 ** -(k + 3)}
        for k in range(6, 13)
    },
    "`dopri5`, rtol 1e-9": {"method": "dopri5", "rtol": 1e-9, "atol": 1e-12},
}
YARDSTICK = f"{DEFAULT}, rtol 1e-9"
SPANS = {1: 10.0, 2: 10.0, 3: 3.0, 4: 3.0, 6: 2.0, 10: 2.0, 30: 1.0, 100: 0.4}  # links: s
METHODS = ("dopri5", "dop853", "taylor")
ERRORS = (1e-4, 1e-6, 1e-8, 1e-10)


def timed(
    ways: dict[str, dict[str, Any]], arguments: tuple[Any, ...]
) -> tuple[dict[str, pc.Solution], dict[str, float], dict[str, float]]:
    """Run all ways in turns; return their last solutions, their errors, their least times, s."""
    scene = Regular(arguments, inf, {}, [])
    scene.known.update({name: scene.run(method=name, **EXACT).q for name in METHODS[1:]})
    solutions: dict[str, pc.Solution] = {}
    times = scene.times

    def run(name: str) -> None:
        solutions[name] = pc.simulate(*arguments, t_eval=times, progress=False, **ways[name])

    seconds = least_times({name: partial(run, name) for name in ways}, ROUNDS)
    errors = {name: scene.error_of(solution) for name, solution in solutions.items()}
    return solutions, errors, seconds


def of_scene(seed: int) -> dict[str, Any]:
    """Draw a regular scene; return errors and times of each way, and the method of the default."""
    rng = np.random.default_rng(seed)
    while growth(*(arguments := scene_and_start(rng))) >= REGULAR:
        pass
    solutions, errors, seconds = timed(WAYS, arguments)
    return {
        "links": len(arguments[0].links),
        "method": solutions[YARDSTICK].method,
        "error": errors,
        "time": {name: one / seconds[YARDSTICK] for name, one in seconds.items()},
    }


def of_chain(n: int) -> dict[str, Any]:
    """Return the least time of each method at each error, over that of dop853, with one damper."""
    links = [pc.Link(mass=1.0, length=1.0)] * n
    scene = pc.Scene(links=links, effects=[pc.effects.ViscousJoint(joint=1, damping=0.01)])
    arguments = (scene, (0.0, SPANS[n]), np.linspace(0.6, 1.0, n), 0.0)
    ways = {
        f"{method} {k}": {"method": method, "rtol": 10.0 ** (-k / 2), "atol": 10.0 ** (-k / 2 - 3)}
        for method in METHODS
        for k in range(4, 26)
    }
    _, errors, seconds = timed(ways, arguments)

    def least(method: str, wanted: float) -> float:
        names = [name for name in ways if name.split()[0] == method and errors[name] <= wanted]
        return min(seconds[name] for name in names)

    return {
        "links": n,
        "time": {
            method: [least(method, e) / least("dop853", e) for e in ERRORS]
            for method in ("taylor", "dopri5")
        },
    }


def table_of_scenes(found: list[dict[str, Any]]) -> str:
    rows = []
    for name in WAYS:
        errors = np.percentile([one["error"][name] for one in found], [50, 97, 100])
        times = np.percentile([one["time"][name] for one in found], [50, 97])
        rows.append([name, *(f"{x:.0e}" for x in errors), *(f"{x:.2f}" for x in times)])
    heads = ["of 200 scenes", "error, median", "97 %", "all", "time, median", "97 %"]
    return table_of(heads, rows)


def table_of_chains(found: list[dict[str, Any]]) -> str:
    heads = [f"{method}, {e:.0e}" for method in ("taylor", "dopri5") for e in ERRORS]
    rows = []
    for one in found:
        cells = [f"{x:.2f}" for method in one["time"].values() for x in method]
        rows.append([str(one["links"]), *cells])
    return table_of(["links", *heads], rows, left=0)


def main() -> None:
    scenes = [of_scene(seed) for seed in tqdm(SCENES, unit="scene", disable=None)]
    chains = [of_chain(n) for n in tqdm(SPANS, unit="chain", disable=None)]
    record = {"scenes": scenes, "chains": chains}
    (ROOT / "docs/records/default_method.json").write_text(json.dumps(record, indent=1) + "\n")
    tables = {"default_scenes": table_of_scenes(scenes), "default_chains": table_of_chains(chains)}
    rewrite(ROOT / "docs/background/accuracy_cost.md", **tables)
    print(*tables.values(), sep="\n")


if __name__ == "__main__":
    main()
