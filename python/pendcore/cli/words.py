"""Words of the command line that are not known, and what to write in their place."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
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
        remedy = _remedy(unknown[0], args.command, commands.choices)
        used.error(f"unrecognized arguments: {' '.join(unknown)}{remedy}")
    return args


def of_the_run(name: str, value: str) -> str:
    """Return where an option of a run belongs."""
    return f"{name} is an option of the run: write {name} = {value} below [run] in the case"


def _remedy(word: str, command: str, parsers: Mapping[str, argparse.ArgumentParser]) -> str:
    """Return what to write for an option that a command does not have."""
    name = word.partition("=")[0]
    key = name.lstrip("-").replace("-", "_")
    if not name.startswith("--"):
        return ""
    if key in KEYS["run"]:
        return f": {of_the_run(key, '...')}"
    own = _options(parsers[command])
    if key == "gravity":
        here = " or give --parameters gravity=..." if "--parameters" in own else ""
        return f": write gravity = ... into the case{here}"
    others = [other for other, parser in parsers.items() if name in _options(parser)]
    if command in others:
        return f": write it behind `pendcore {command}`"
    if others:
        commands = " and ".join(f"`pendcore {other}`" for other in others)
        return f": it is an option of {commands}"
    return f": {did_you_mean(name, own)}"


def _options(parser: argparse.ArgumentParser) -> list[str]:
    return [option for option in parser._option_string_actions if option[:2] == "--"]
