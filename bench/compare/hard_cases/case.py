"""The question of a hard case, and the result in one program."""

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
    """`error` against the right answer, None where none was given; `said`: what happened, in words.

    `trace`: curves for a figure, by name. `right` overrules what the error says: for cases that ask
    what a program says.
    """

    error: float | None = None
    said: str = ""
    right: bool | None = None
    trace: Mapping[str, list[float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Contender:
    """`program` is its column, `how` what its user wrote.

    `own_loop`: modes and switches are the user's own program, not the library's.
    """

    program: str
    how: str
    run: Callable[[], Outcome]
    own_loop: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class HardCase:
    """`unit` is that of the error; an error of at most `allowed` counts as right.

    `figure` says what its picture shows, where there is one (figures.py). `loop_not_run` names the
    programs around which one could write a loop that would be right, and none is run here.
    """

    name: str
    title: str
    scene: str
    answer: str
    unit: str
    allowed: float
    contenders: tuple[Contender, ...]
    reference: Callable[[], Mapping[str, list[float]]] = dict
    figure: str = ""
    loop_not_run: tuple[str, ...] = ()


class Absent(Exception):
    """A program that the contender needs is not installed, not built, or not there yet."""


class NoReturn(Exception):
    """The time limit of a contender was over."""


def _report(run: Callable[[], Outcome], pipe: Connection, seconds: int) -> None:
    os.setsid()  # what it starts is ended with it, and has the same limit
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    os.chdir(tempfile.gettempdir())  # MuJoCo writes its warnings into a file where it runs
    try:
        pipe.send(run())
    except NoReturn:
        os.kill(os.getpid(), signal.SIGXCPU)
    except (ImportError, Absent) as absence:
        pipe.send(Absent(str(absence)))
    except Exception as failure:  # what a program throws is what happened in it
        pipe.send(Outcome(said=f"{type(failure).__name__}: {failure}"))


def run_bounded(run: Callable[[], Outcome], seconds: int = LONGEST) -> Outcome:
    """Run in a process of its own, which is ended when the time is over."""
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
