"""Words of the command line that are not known, and what to write in their place."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from pendcore.cases.case_file import KEYS
from pendcore.messages.arguments import did_you_mean
from pendcore.run.options import OPTIONS

CHOSEN_FOR_ERROR = tuple(name for name, one in OPTIONS.items() if one.chosen_for_error)
"""The options of a run that the command line takes too; an error that is asked for chooses all."""


def known_words(
    parser: argparse.ArgumentParser, commands: Any, argv: Sequence[str]
) -> argparse.Namespace:
    """Return the arguments; for a word that is not known, exit with what may have been meant."""
    first = argv[0] if argv else "-"
    if not first.startswith("-") and first not in commands.choices:
        remedy = did_you_mean(first, commands.choices)
        if first.endswith(".toml"):
            remedy = f"did you mean `pendcore run {first}`?"
        parser.error(f"argument COMMAND: invalid choice: {first!r}: {remedy}")
    args, unknown = parser.parse_known_args(argv)
    if unknown:
        used = commands.choices[args.command]
        used.error(f"unrecognized arguments: {' '.join(unknown)}{_remedy(unknown[0], used)}")
    return args


def of_the_run(name: str, value: str) -> str:
    """Return where an option of a run belongs."""
    return f"{name} is an option of the run: write {name} = {value} below [run] in the case"


def _remedy(word: str, used: argparse.ArgumentParser) -> str:
    """Return what to write for an option that a sub-command does not have."""
    name = word.partition("=")[0]
    key = name.lstrip("-").replace("-", "_")
    if not name.startswith("--"):
        return ""
    if key in KEYS["run"]:
        return f": {of_the_run(key, '...')}"
    return f": {did_you_mean(name, [x for x in used._option_string_actions if x[:2] == '--'])}"
