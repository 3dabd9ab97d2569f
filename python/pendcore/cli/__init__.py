"""The command `pendcore`; a file for each sub-command adds its arguments, and `execute` runs it.

What `execute` returns is the exit status.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Sequence
from io import TextIOWrapper
from typing import Any

from pendcore import PendcoreWarning, build
from pendcore.cli import completion, cost, derive, explain, map, plot, run, show, trust
from pendcore.cli.usage import NotWritten, UsageError
from pendcore.cli.words import known_words

_EXAMPLES = """
examples:
  pendcore run                 the textbook's double pendulum, into out/textbook
  pendcore run swing.toml      your own case, into out/swing
  pendcore show swing.toml     a page that simulates it; -o swing.mp4 for a film
pendcore COMMAND --help says more of each.

exit status: 0 fine, 1 the run or a file failed (all else is written), 2 wrong usage,
141 nobody reads what is printed
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command with arguments, by default those of the process; return its exit status.

    That is 0: fine, 1: the run failed or was interrupted, or a file is not written, 2: wrong usage,
    141: nobody reads.
    """
    _make_surroundings_safe()
    parser, commands = _parser()
    if "_ARGCOMPLETE" in os.environ:  # a shell asks how a line goes on
        import argcomplete

        argcomplete.autocomplete(parser)
    try:
        args = known_words(parser, commands, sys.argv[1:] if argv is None else argv)
    except SystemExit as stop:  # after --help, --version and wrong usage
        return int(stop.code or 0)
    with warnings.catch_warnings():
        warnings.simplefilter("always", PendcoreWarning)
        warnings.showwarning = _show_warning
        try:
            status = int(args.execute(args))
            sys.stdout.flush()
            return status
        except (UsageError, NotWritten) as error:
            print(f"pendcore {args.command}: {error}", file=sys.stderr)
            return 2 if isinstance(error, UsageError) else 1
        except KeyboardInterrupt:  # outside the run, which handles its own
            print(f"pendcore {args.command}: interrupted", file=sys.stderr)
            return 1
        except BrokenPipeError:  # the reader of our output has stopped reading
            _print_no_more()
            return 141
        except OSError as error:
            # Errors of files name the file, so an error without a name is one of printing.
            told = error if error.filename else f"standard output: {error.strerror or error}"
            print(f"pendcore {args.command}: {told}", file=sys.stderr)
            if not error.filename:
                _print_no_more()
            return 1


def _make_surroundings_safe() -> None:
    """Draw by Agg, whatever backend is set, and print any text to any stream.

    A notebook sets a backend for all that is started from it, and matplotlib cannot be imported
    where that backend is missing. Letters that the encoding of a stream lacks are printed escaped.
    """
    os.environ["MPLBACKEND"] = "agg"
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed: print(file=None) would go to standard output
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8"))
        elif isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _print_no_more() -> None:
    """Let what is left to print go nowhere, so that Python does not fail to print it at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _parser() -> tuple[argparse.ArgumentParser, Any]:
    """Return the parser, and that of the sub-commands."""
    raw: Any = {"formatter_class": argparse.RawDescriptionHelpFormatter}
    told = "Direct dynamics of pendulum chains."
    parser = argparse.ArgumentParser(prog="pendcore", description=told, epilog=_EXAMPLES, **raw)
    told = "show version, instruction set and compiler"
    parser.add_argument("--version", action=_Version, nargs=0, help=told)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in (run, explain, plot, show, trust, cost, map, derive, completion):
        parser_of_command = commands.add_parser(
            command.__name__.rpartition(".")[2],
            help=command.HELP,
            description=command.DESCRIPTION,
            epilog=command.EPILOG,
            **raw,
        )
        command.add_arguments(parser_of_command)
        parser_of_command.set_defaults(execute=command.execute)
    return parser, commands


class _Version(argparse.Action):
    """Print what this build is, and end.

    The instruction set is asked for only here, as a wrong PENDCORE_INSTRUCTION_SET is an error.
    """

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        try:
            made = f"{build.instruction_set()}, {build.compiler}"
        except ValueError as error:
            parser.error(str(error))
        print(f"pendcore {build.version} ({made})")
        parser.exit()


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    print(f"pendcore: warning: {message}", file=sys.stderr)
