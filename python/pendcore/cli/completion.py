"""`pendcore completion`: print what a shell needs to complete the command's words."""

from __future__ import annotations

import argparse

from pendcore.cli.usage import UsageError

HELP = "let a shell complete sub-commands, options and files"
DESCRIPTION = "Print a script with which a shell completes sub-commands, options and files."
EPILOG = """
to switch completion on, for this user:
  bash   pendcore completion bash >> ~/.bashrc
  zsh    pendcore completion zsh >> ~/.zshrc
  fish   pendcore completion fish > ~/.config/fish/completions/pendcore.fish
and open a new shell. It needs the package argcomplete, which is in pendcore's extra "completion".
"""
SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("shell", choices=SHELLS, help="whose script")


def execute(args: argparse.Namespace) -> int:
    try:
        import argcomplete
    except ImportError:
        raise UsageError("needs argcomplete: pip install argcomplete") from None
    print(argcomplete.shellcode(["pendcore"], shell=args.shell))
    return 0
