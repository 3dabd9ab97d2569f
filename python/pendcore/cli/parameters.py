"""Numbers of a case that the command line replaces, by name."""

from __future__ import annotations

import re

from pendcore import Case
from pendcore.case_files import KEYS
from pendcore.cli.usage import UsageError
from pendcore.cli.words import CHOSEN_FOR_ERROR, of_the_run

START = re.compile(r"(q0|qd0)\[(\d+)\]")


def with_parameters(case: Case, given: list[str]) -> Case:
    """Return the case with numbers replaced, each ``NAME=VALUE``.

    A name is that of a parameter of the scene, or of the start: ``q0[1]``, ``qd0[2]``.
    """
    starts = {"q0": list(case.q0), "qd0": list(case.qd0)}
    of_scene: dict[str, float] = {}
    names: set[str] = set()
    for one in given:
        name, equals, text = one.partition("=")
        if name in names:
            raise UsageError(f"--parameters {one}: {name} is given twice: give it once")
        names.add(name)
        if name in KEYS["run"]:
            shorter = f", or give --{name} {text}" if name in ("error", *CHOSEN_FOR_ERROR) else ""
            raise UsageError(f"--parameters {one}: {of_the_run(name, text)}{shorter}")
        try:
            value = float(text)
        except ValueError:
            equals = ""
        if not equals:
            raise UsageError(f"--parameters {one}: must be NAME=VALUE, such as link[2].mass=0.9")
        start = START.fullmatch(name)
        if name in starts:
            raise UsageError(f"--parameters {one}: must say of which link, such as {name}[1]")
        if start is None:
            of_scene[name] = value
        elif not 1 <= int(start[2]) <= len(case.q0):
            raise UsageError(
                f"--parameters {one}: the scene has {len(case.q0)} links, counted from 1"
            )
        else:
            starts[start[1]][int(start[2]) - 1] = value
    return Case(
        scene=case.scene.with_parameters(of_scene), **starts, t_span=case.t_span, name=case.name,
        options=case.options,
    )  # fmt: skip
