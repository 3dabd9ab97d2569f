"""A program of C++ contenders, with which we speak line by line (see conversation.hpp).

In this way its bursts take turns with those of the Python contenders and of other programs.
"""

from __future__ import annotations

import os
import subprocess
import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contenders.contender import Unsupported

PROJECT = Path(__file__).parents[3]
LONGEST_ANSWER = 120.0  # s


def words(numbers: Iterable[Any]) -> str:
    """Write numbers so that they read back as the same doubles."""
    return " ".join(repr(float(number)) for number in numbers)


def find_executable(name: str, variable: str) -> Path:
    """Find an executable by an environment variable, which names the file or its folder.

    Without the variable, find the newest file of that name under the project's build.
    """
    named = os.environ.get(variable)
    if named and Path(named).is_dir():
        found = [Path(named) / name]
    else:
        found = [Path(named)] if named else list(PROJECT.glob(f"build/**/{name}"))
    found = [path for path in found if path.is_file()]
    if not found:
        raise ImportError(f"{name}: not built; `make build-bench` builds it")
    return max(found, key=lambda path: path.stat().st_mtime)


class Conversation:
    """A request is a line, the answer is a line: `ok ...`, `unsupported ...` or `error ...`."""

    def __init__(self, path: Path, environment: Mapping[str, str] | None = None) -> None:
        """Start the program; `environment` is added to this process's."""
        self.name = path.name
        # The program has a group of its own, so that a Ctrl-C reaches us alone. It ends when its
        # input ends.
        self.process = subprocess.Popen(
            [path],
            env={**os.environ, **(environment or {})},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
            process_group=0,
        )

    def ask(self, request: str) -> str:
        if self.process.stdin is None or self.process.stdout is None:
            raise RuntimeError("the conversation has no pipes")
        self.process.stdin.write(request + "\n")
        self.process.stdin.flush()
        alarm = threading.Timer(LONGEST_ANSWER, self.process.kill)
        alarm.start()
        try:
            line = self.process.stdout.readline()
        finally:
            alarm.cancel()
        verdict, _, answer = line.rstrip("\n").partition(" ")
        if verdict == "unsupported":
            raise Unsupported(answer)
        if verdict != "ok":
            raise RuntimeError(
                f"{self.name}: {request[:60]}: {answer or 'it ended, or took too long'}"
            )
        return answer

    def close(self) -> None:
        """End the program, which happens by itself when its input ends."""
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                pipe.close()
        try:
            self.process.wait(LONGEST_ANSWER)
        except BaseException:
            self.process.kill()
            raise

    def described(self) -> list[tuple[str, str, str]]:
        """List its contenders: name, label, and version and settings."""
        result = []
        for name in self.ask("names").split():
            label, _, about = self.ask(f"about {name}").partition(": ")
            result.append((name, label, about))
        return result


@dataclass(frozen=True, slots=True)
class Prepared:
    """What a program has prepared, under a number."""

    conversation: Conversation
    number: str

    def ask(self, word: str) -> str:
        return self.conversation.ask(f"{word} {self.number}")

    def burst(self, seconds: float) -> list[float]:
        """Call for about that long and list seconds of a call, or batch by batch of many."""
        answer = self.conversation.ask(f"burst {self.number} {seconds}")
        return [1e-9 * float(nanoseconds) for nanoseconds in answer.split()]
