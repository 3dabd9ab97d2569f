"""Boost.odeint's side: contenders/hard_cases_odeint.cpp, called with the name of a case."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Callable

from contenders.conversation import find_executable

from hard_cases.case import Contender, NoReturn, Outcome


def ask(*request: str) -> dict[str, list[float]]:
    """Ask the program, and return the numbers of its lines by name."""
    path = find_executable("hard_cases_odeint", "HARD_CASES_ODEINT")
    done = subprocess.run([path, *request], capture_output=True, text=True, check=False)
    if done.returncode in {-signal.SIGXCPU, -signal.SIGKILL}:
        raise NoReturn
    if done.returncode:
        raise RuntimeError(done.stderr.strip() or f"ended with {done.returncode}")
    lines = (line.split() for line in done.stdout.splitlines())
    return {name: [float(number) for number in numbers] for name, *numbers in lines}


def odeint(
    how: str,
    *request: str,
    judge: Callable[[dict[str, list[float]]], Outcome],
    own_loop: bool = False,
) -> Contender:
    """Make the contender that asks the program and judges the answer."""
    return Contender(program="odeint", how=how, run=lambda: judge(ask(*request)), own_loop=own_loop)
