"""Words of the command line that are not known, and what to write in their place."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence
from typing import Any

from pendcore.case_files import KEYS
from pendcore.messages import did_you_mean
from pendcore.options import OPTIONS

CHOSEN_FOR_ERROR = tuple(name for name, one in OPTIONS.items() if one.chosen_for_error)
"""The options of a run that the command line takes too; an error that is asked for chooses all."""


def known_words(parser: ArgumentParser, commands: Any, argv: Sequence[str]) -> Namespace:
    """Return the arguments; for a word that is not known, exit with what may have been meant."""
    first = argv[0] if argv else "-"
    if not first.startswith("-") and first not in commands.choices:
        remedy = did_you_mean(first, commands.choices)
        if first.endswith(".toml"):
            remedy = f"did you mean `pendcore run {first}`?"
        parser.error(f"argument COMMAND: invalid choice: {first!r}: {remedy}")
    if first.startswith("--") and first.partition("=")[0] not in _options(parser):
        used = next((word for word in argv if word in commands.choices), "")
        remedy = f": {_remedy(first, used, commands.choices)}" if used else ""
        parser.error(f"unrecognized arguments: {first}{remedy}")
    args, unknown = parser.parse_known_args(argv)
    if unknown:
        remedy = _remedy(unknown[0], args.command, commands.choices)
        told = f"unrecognized arguments: {' '.join(unknown)}{remedy and f': {remedy}'}"
        commands.choices[args.command].error(told)
    return args


def of_the_run(name: str, value: str) -> str:
    """Return where an option of a run belongs."""
    return f"{name} is an option of the run: write {name} = {value} below [run] in the case"


def _remedy(word: str, command: str, parsers: Mapping[str, ArgumentParser]) -> str:
    """Return what to write for an option where a command does not take it."""
    name = word.partition("=")[0]
    key = name.lstrip("-").replace("-", "_")
    if not name.startswith("--"):
        return ""
    own = _options(parsers[command])
    if name in own:
        return f"write it after `pendcore {command}`"
    if key in KEYS["run"]:
        return of_the_run(key, "...")
    if key == "gravity":
        here = " or give --parameters gravity=..." if "--parameters" in own else ""
        return f"write gravity = ... into the case{here}"
    others = [f"`pendcore {one}`" for one, parser in parsers.items() if name in _options(parser)]
    return f"{name} is an option of {', '.join(others)}" if others else did_you_mean(name, own)


def _options(parser: ArgumentParser) -> list[str]:
    return [option for option in parser._option_string_actions if option[:2] == "--"]
