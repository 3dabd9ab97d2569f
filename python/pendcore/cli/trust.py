"""`pendcore trust`: until when a run is right, how fast errors grow, how far it is from exact."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from typing import Any

from pendcore import Solution
from pendcore.cli.arguments import add_case, add_flags, add_number, solution_of
from pendcore.cli.horizon import horizon_of
from pendcore.cli.usage import blamed_on_usage
from pendcore.explanation.solution_text import LIMIT
from pendcore.messages import as_json, positive

HELP = "say until when a run is right"
DESCRIPTION = "Say how far to trust a run: a saved run, or the run of a case."
EPILOG = """
what is told:
  until when every angle is right to the limit, from independent second runs (sol.valid_until)
  the largest error of the angles and of the positions as far as it is known (sol.estimate_error)
  the largest Lyapunov exponent, and the seconds that one more right digit is worth (sol.lyapunov)
  the largest torque that would make the run an exact motion (sol.defect)

example:
  pendcore trust out/swing/solution.npz --limit 0.01
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_case(parser, or_solution=True)
    told = "error of an angle, rad, up to which a run counts as right"
    add_number(parser, "--limit", "RAD", told, LIMIT)
    add_number(parser, "--time-limit", "S", "seconds of computing for the second runs")
    add_flags(parser, json="print the same as JSON")


def execute(args: argparse.Namespace) -> int:
    with blamed_on_usage():
        positive("--limit", args.limit, "rad")
        if args.time_limit is not None:
            positive("--time-limit", args.time_limit, "s")
        solution = solution_of(args)
        found = trust(solution, args.limit, args.time_limit)
    if args.json:
        print(json.dumps({key: x for key, (x, _) in found.items()}, indent=2))
    else:
        for _, sentence in found.values():
            print(sentence)
    return 0


def trust(
    solution: Solution, limit: float, time_limit: float | None
) -> dict[str, tuple[float | None, str]]:
    """Return each number, None where there is none, with a sentence."""
    estimate = solution.estimate_error(time_limit=time_limit)
    horizon = horizon_of(solution, estimate, limit)
    found: dict[str, tuple[float | None, str]] = {
        "valid_until": (horizon.valid_until, f"right to {limit:g} rad {horizon.sentence}"),
        "largest_error": (as_json(estimate.largest), str(estimate)),
    }
    measures: dict[str, tuple[str, Callable[[], Any]]] = {
        "lyapunov_exponent": ("Lyapunov exponent", solution.lyapunov),
        "defect": ("defect", solution.defect),
    }
    for key, (noun, measure) in measures.items():
        try:
            told = measure()
        except ValueError as refusal:  # with dry friction and stops, neighbours part at no rate
            why = str(refusal).removeprefix(f"{measure.__name__}: ")
            found[key] = (None, f"no {noun}: {why}")
        else:
            found[key] = (as_json(told.largest), str(told))
    return found
