"""`pendcore explain`: what a case simulates and what not, what it costs, how fast it moves."""

from __future__ import annotations

import argparse
import json

from pendcore.cli.arguments import add_case, add_flags, case_of
from pendcore.cli.usage import blamed_on_usage
from pendcore.messages import warn

HELP = "say what a case simulates, what it costs, how fast it moves"
DESCRIPTION = "Explain a case at its start, without running it."
EPILOG = """
what is told:
  the effects, and what each costs in a right-hand side: operations, and ns measured on the spot
  degrees of freedom, counted as the textbook does and from the rank of the constraints
  equilibria with their natural frequencies, the stiffest rate, a safe first step
  what is not simulated

example:
  pendcore explain swing.toml --json | jq .first_step
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_case(parser)
    add_flags(parser, json="print the same as JSON")


def execute(args: argparse.Namespace) -> int:
    with blamed_on_usage():
        case = case_of(args)
    for message in case.scene.run_warnings(case.q0, case.t_span):
        warn(message)
    told = case.scene.explain(t=case.t_span[0], q=case.q0)
    print(json.dumps(told.to_dict(), indent=2) if args.json else told)
    return 0
