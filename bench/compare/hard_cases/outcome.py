"""What became of a hard case in a program, which is run in a process of its own."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import resource
import signal
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection

LONGEST = 60  # s of computing for one contender; whoever takes longer has not returned
NO_RETURN = "does not return (ended after {} s of computing)"
PATIENCE = 10  # times LONGEST by the wall clock: the machine may be busy


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """`error` is that of the answer, None if there was no answer; `said` tells what happened.

    `trace` has curves for a figure, by name. `right` overrules the verdict of the error, in cases
    that ask for a message.
    """

    error: float | None = None
    said: str = ""
    right: bool | None = None
    trace: Mapping[str, list[float]] = field(default_factory=dict)


class Absent(Exception):
    """A program that the contender needs is not installed, not built, or not there yet."""


def _report(run: Callable[[], Outcome], pipe: Connection, seconds: int) -> None:
    os.setsid()  # processes that it starts end with it and have the same limit
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    os.chdir(tempfile.gettempdir())  # MuJoCo writes its warnings into a file in the current folder
    try:
        pipe.send(run())
    except (ImportError, Absent) as absence:
        pipe.send(Absent(str(absence)))
    except Exception as failure:  # an exception of the program is its outcome
        pipe.send(Outcome(said=f"{type(failure).__name__}: {failure}"))


def run_bounded(run: Callable[[], Outcome], seconds: int = LONGEST) -> Outcome:
    """Run in a process of its own, which is ended after the time limit."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_report, args=(run, sender, seconds))
    process.start()
    sender.close()
    try:
        if not receiver.poll(PATIENCE * seconds):
            return Outcome(said=NO_RETURN.format(seconds), right=False)
        answer = receiver.recv()
    except EOFError:
        process.join()
        late = process.exitcode in {-signal.SIGXCPU, -signal.SIGKILL}
        return Outcome(said=NO_RETURN.format(seconds) if late else "dies", right=False)
    finally:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid or 0, signal.SIGKILL)
        process.kill()
        process.join()
    if isinstance(answer, Absent):
        raise answer
    assert isinstance(answer, Outcome)
    return answer
