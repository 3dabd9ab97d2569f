"""The textbook's claim of speed, measured: inline function, function file, NumPy, compiled core.

    make write PAGE=book_speed

All take turns in one run. It writes docs/records/book_speed.json, the tables of
docs/background/book_speed.md and the figure docs/figures/book_speed.png.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pendcore as pc
from page_part import ROOT, rewrite, table_of
from pendcore.plotting import LIGHT, new_axes

sys.path.append(str(ROOT / "bench/compare"))
from contenders.contender import PythonRun
from contenders.programs import Conversation
from machine import circumstances
from measure import Timing, interleave

BOOK, START, SPAN = pc.Scene.textbook(), (np.pi / 4, np.pi / 3), (0.0, 5.0)
BY_CORE = partial(pc.simulate, BOOK, SPAN, START)
TOLERANCES = {f"1e-{k}": {"rtol": 10.0**-k, "atol": 10.0 ** (-k - 3)} for k in (3, 6, 9)}
"""The first are the defaults of ode45, which the book takes."""
WAYS = {
    "inline": "Octave, inline function",
    "file": "Octave, function file, as the book's",
    "shared": "Octave, function file, subexpressions shared",
    "numpy": "Python, NumPy from SymPy, SciPy's RK45",
    "core": "Python, pendcore, ode45's method",
    "default": "Python, pendcore, its own choice",
}
STATES = (1, 100, 100_000)
CALLS = 200
ROUNDS, BURST, SECONDS_A_RUN = 24, 0.02, 15.0


@dataclass(frozen=True)
class Asked:
    """A request that another program answers with the seconds it took, for `calls` calls."""

    program: Conversation
    request: str
    calls: int = 1

    def burst(self, seconds: float) -> list[float]:
        """Ask once: a run takes longer than any burst."""
        return [float(self.program.ask(self.request)) / self.calls]


def begin_octave(folder: Path) -> Conversation:
    """Start Octave on the functions that pendcore.derive writes into the folder."""
    from pendcore.derive import Derivation
    from pendcore.derive.code.octave import written_out

    book = Derivation.textbook()
    (folder / "RR.m").write_text(written_out(book))
    (folder / "shared.m").write_text(book.to_octave("shared"))
    (folder / "g.m").write_text(book.to_octave_inline())
    return Conversation(ROOT / "docs/generators/book_speed.m", {"BOOK_SPEED": str(folder)})


def begin_cpp(folder: Path) -> Conversation:
    """Compile and start the program that calls the generated header."""
    from pendcore.derive import Derivation
    from pendcore.derive.code.cpp import header

    (folder / "book.hpp").write_text(header(Derivation.textbook(), namespace="book"))
    command = ["g++", "-std=c++17", "-O2", f"-I{folder}", ROOT / "docs/generators/book_speed.cpp"]
    subprocess.run([*command, "-o", folder / "calls"], check=True)
    return Conversation(folder / "calls")


def numpy_module() -> dict[str, Any]:
    """Return the names that the generated module defines."""
    from pendcore.derive import Derivation

    names: dict[str, Any] = {}
    exec(Derivation.textbook().to_python(), names)
    return names


def solvers(module: dict[str, Any]) -> dict[str, Callable[..., Any]]:
    """Return what solves the case in this process with `rtol` and `atol`."""
    from scipy.integrate import solve_ivp

    return {
        "numpy": partial(solve_ivp, module["right_hand_side"], SPAN, [*START, 0.0, 0.0]),
        "core": partial(BY_CORE, method="ode45"),
        "default": partial(BY_CORE, method="auto"),
    }


def looked_at(
    octave: Conversation, here: dict[str, Callable[..., Any]]
) -> dict[tuple[str, str], dict[str, float]]:
    """Return right-hand sides and error of every way at every tolerance.

    The error is the larger of the two angles' errors at the end, rad, against a far tighter run.
    """
    exact = BY_CORE(method="taylor", rtol=1e-15, atol=1e-16).q[-1]
    found = {}
    for named, pair in TOLERANCES.items():
        for way in WAYS:
            if way in here:
                solution = here[way](**pair)
                count = getattr(solution, "nfev", None) or solution.stats.nfev
                end = solution.y[:2, -1]
            else:
                said = octave.ask(f"look {way} {pair['rtol']} {pair['atol']}").split()
                count, end = int(said[0]), np.array(said[1:], float)
            error = float(np.abs(end - exact).max())
            found[way, named] = {"right_hand_sides": int(count), "error": error}
    return found


def right_hand_sides(
    octave: Conversation, cpp: Conversation, module: dict[str, Any]
) -> dict[tuple[str, int], Asked | PythonRun[Any]]:
    """Return what computes accelerations of so many states in one call."""
    runs: dict[tuple[str, int], Asked | PythonRun[Any]] = {
        (way, 1): Asked(octave, f"call {way} {CALLS}", CALLS)
        for way in ("inline", "file", "shared")
    }
    runs["cpp", 1] = Asked(cpp, f"call {1000 * CALLS}", 1000 * CALLS)
    for count in STATES:
        q = np.random.default_rng(1).uniform(-3.0, 3.0, (2, count))
        columns = (q[:, 0], q[:, 0]) if count == 1 else (q, q)
        rows = tuple(np.ascontiguousarray(one.T) for one in columns)
        runs["numpy", count] = _timed(partial(module["accelerations"], 0.0, *columns))
        runs["core", count] = _timed(partial(BOOK.accelerations, 0.0, *rows))
    return runs


def _timed(call: Callable[[], Any]) -> PythonRun[Any]:
    return PythonRun(call, lambda _: None)  # type: ignore[arg-type]


def once() -> dict[str, float]:
    """Return the shortest time, s, of what is done once, each in a process of its own."""
    solve = "import pendcore as pc; pc.simulate(pc.Scene.textbook(), (0, 5), .8)"
    derive = "from pendcore.derive import Derivation; Derivation.textbook().to_octave()"
    commands = {
        "octave": ["octave-cli", "--no-init-file", "--eval", "1;"],
        "solve": [sys.executable, "-c", solve],
        "derive": [sys.executable, "-c", derive],
    }
    seconds = dict.fromkeys(commands, np.inf)
    for _ in range(5):
        for name, command in commands.items():
            begun = time.perf_counter()
            subprocess.run(command, check=True, capture_output=True)
            seconds[name] = min(seconds[name], time.perf_counter() - begun)
    return {name: float(one) for name, one in seconds.items()}


def record(rounds: int) -> dict[str, Any]:
    """Measure it all."""
    import scipy
    import sympy

    begun, module = time.perf_counter(), numpy_module()
    here = solvers(module)
    with TemporaryDirectory() as folder:
        octave, cpp = begin_octave(Path(folder)), begin_cpp(Path(folder))
        try:
            looked = looked_at(octave, here)
            runs: dict[Any, Any] = {}
            for named, pair in TOLERANCES.items():
                for way in WAYS:
                    request = f"solve {way} {pair['rtol']} {pair['atol']}"
                    asked = Asked(octave, request)
                    run = _timed(partial(here[way], **pair)) if way in here else asked
                    runs["solve", way, named] = run
            for (way, count), run in right_hand_sides(octave, cpp, module).items():
                runs["call", way, count] = run
            timings = interleave(runs, rounds, BURST, SECONDS_A_RUN)
            versions = {"octave": octave.ask("version"), "scipy": scipy.__version__}
        finally:
            octave.close()
            cpp.close()
    seconds = once()
    about = circumstances(begun, rounds, BURST)
    about["machine"] |= {**versions, "sympy": sympy.__version__, "pendcore": pc.__version__}
    return {
        "solves": [
            {"way": way, "tolerance": named, **_seconds(timings["solve", way, named]), **facts}
            for (way, named), facts in looked.items()
        ],
        "right_hand_sides": [
            {"way": key[1], "states": key[2], **_seconds(timing)}
            for key, timing in timings.items()
            if key[0] == "call"
        ],
        "once": seconds,
        **about,
    }


def _seconds(timing: Timing) -> dict[str, float]:
    return {"least": timing.minimum, "median": timing.median, "calls": timing.calls}


def in_words(seconds: float) -> str:
    """Write seconds in three digits, with the unit that suits."""
    scaled, unit = next(
        (seconds * factor, unit)
        for factor, unit in ((1.0, "s"), (1e3, "ms"), (1e6, "us"), (1e9, "ns"))
        if seconds * factor >= 1.0 or unit == "ns"
    )
    return f"{scaled:.{max(0, 2 - int(np.log10(scaled)))}f} {unit}"


def of_times(ratio: float) -> str:
    """Write a ratio in two or three digits."""
    return f"{ratio:.2f}" if ratio < 10 else f"{float(f'{ratio:.2g}'):,.0f}"


def solves_table(found: dict[str, Any]) -> str:
    """Return the table of whole solves."""
    rows = []
    for named in TOLERANCES:
        solves = [one for one in found["solves"] if one["tolerance"] == named]
        inline = next(one["least"] for one in solves if one["way"] == "inline")
        for one in solves:
            cells = [
                named,
                WAYS[one["way"]],
                in_words(one["least"]),
                in_words(one["median"]),
                of_times(inline / one["least"]),
                f"{one['right_hand_sides']:,}",
                f"{one['error']:.0e}",
            ]
            rows.append(cells)
    heads = ["tolerance", "way", "least time", "median", "faster than inline", "calls of f"]
    return table_of([*heads, "error, rad"], rows, left=2)


def calls_table(found: dict[str, Any]) -> str:
    """Return the table of single right-hand sides, with the time of one state in each cell."""
    known = {(row["way"], row["states"]): row["least"] for row in found["right_hand_sides"]}
    names = {way: WAYS[way] for way in ("inline", "file", "shared")}
    names["cpp"] = "C++ header from SymPy, in C++"
    names |= {"numpy": "NumPy from SymPy", "core": "pendcore from Python, `scene.accelerations`"}
    heads = [f"{count:,} state{'s' * (count > 1)}" for count in STATES]
    rows = []
    for way, name in names.items():
        cells = [
            in_words(known[way, count] / count) if (way, count) in known else "" for count in STATES
        ]
        rows.append([name, *cells])
    return table_of(["time of a state, in a call of", *heads], rows)


def once_table(found: dict[str, Any]) -> str:
    """Return the table of what is done once."""
    names = {
        "octave": "start Octave",
        "solve": "start Python, import pendcore, solve the case",
        "derive": "start Python, derive the case with SymPy, write RR.m",
    }
    rows = [(words, in_words(found["once"][name])) for name, words in names.items()]
    return table_of(["once", "least time"], rows)


TABLES = {"solves": solves_table, "calls": calls_table, "once": once_table}


def figure(found: dict[str, Any], path: Path) -> None:
    """Draw the least times as bars, with their numbers."""
    axes = new_axes((11, 3.9), columns=2, sharey=True)
    every = [row["least"] for row in found["solves"]]
    colors = [LIGHT.ochre] * 3 + [LIGHT.quiet] + [LIGHT.blue] * 2
    for part, named in zip(axes, ("1e-3", "1e-9"), strict=True):
        rows = {row["way"]: row for row in found["solves"] if row["tolerance"] == named}
        least = [rows[way]["least"] for way in WAYS]
        bars = part.barh([*WAYS.values()], least, color=colors, height=0.7)
        labels = [f"{in_words(x)}   ×{of_times(least[0] / x)}" for x in least]
        part.bar_label(bars, labels, padding=4, fontsize=9)
        part.set(xscale="log", xlim=(min(every) / 3, max(every) * 80))
        part.set_xlabel("time of a run of 5 s (s); ×: faster than inline")
        part.set_title(f"relative tolerance {named}")
    axes[0].invert_yaxis()
    axes[0].figure.savefig(path, dpi=110)


def main() -> None:
    found = record(ROUNDS)
    (ROOT / "docs/records/book_speed.json").write_text(json.dumps(found, indent=1) + "\n")
    tables = {f"book speed: {name}": table(found) for name, table in TABLES.items()}
    rewrite(ROOT / "docs/background/book_speed.md", **tables)
    print(*tables.values(), sep="\n")
    figure(found, ROOT / "docs/figures/book_speed.png")


if __name__ == "__main__":
    main()
