"""What must hold of any run at all, however wild the scene.

A claim takes what was drawn, its solution and more choices, and yields a sentence for each breach.
"""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pendcore as pc
from pendcore._scene.effect_class import OwnEffect

from fuzz.choices import Choices
from fuzz.drawn_run import Drawn

Claim = Callable[[Drawn, pc.Solution, Choices], Iterator[str]]

SUCCESSES = {"finished", "event", "at_rest"}
FAILURES = {
    "max_steps", "max_turns", "step_too_small", "not_converged", "non_finite", "time_limit",
    "callback_error",
}  # fmt: skip


def same(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two arrays are the same to the last bit, except that 0.0 and -0.0 are equal."""
    return a.shape == b.shape and bool(np.array_equal(a, b, equal_nan=True))


def is_ordinary(drawn: Drawn, sol: pc.Solution) -> bool:
    """Whether the scene's numbers, the tolerances and the motion are those of pendulums."""
    numbers = [abs(float(x)) for x in re.findall(r"[-+]?\d[\d.]*(?:e[-+]?\d+)?", repr(drawn.scene))]
    tolerances = (drawn.options.get("rtol", 1e-6), drawn.options.get("atol", 1e-6))
    return (
        all(x == 0 or 1e-6 < x < 1e6 for x in numbers)
        and max(tolerances) < 0.1
        and max(map(abs, drawn.t_span)) < 1e9
        and bool(np.abs(sol.y).max(initial=0) < 1e6)
        and not any(isinstance(effect, OwnEffect) for effect in drawn.scene.effects)
    )


def _end(sol: pc.Solution) -> str:
    return f"{sol.status} at {sol._run.t_reached!r}"


def says_how_it_ended(drawn: Drawn, sol: pc.Solution, _: Choices) -> Iterator[str]:
    if sol.status not in SUCCESSES | FAILURES:
        yield f"status {sol.status!r} is none that this run could have"
    if sol.success != (sol.status in SUCCESSES):
        yield f"success = {sol.success} with status {sol.status!r}"
    if sol.message.startswith("no step gets further") and is_ordinary(drawn, sol):
        yield f"the law chatters: {sol.message}"
    if len(sol.message) < 10:
        yield f"message {sol.message!r} says nothing"
    reached = sol._run.t_reached
    if sol.status == "finished" and reached != drawn.t_span[1]:
        yield f"finished at {reached}, not at {drawn.t_span[1]}"
    if not min(drawn.t_span) <= reached <= max(drawn.t_span):
        yield f"reached {reached}, outside {drawn.t_span}"
    most = drawn.options["max_steps"]
    if sol.stats.accepted + sol.stats.rejected > most:
        yield f"{sol.stats.accepted} + {sol.stats.rejected} steps: more than max_steps = {most}"


def times_run_one_way(drawn: Drawn, sol: pc.Solution, _: Choices) -> Iterator[str]:
    direction = -1.0 if drawn.t_span[1] < drawn.t_span[0] else 1.0
    gaps = np.diff(sol.t) * direction
    if (gaps < 0).any():
        yield f"time runs back at index {int(np.argmax(gaps < 0))}"
    # Twice where the state jumps: then the two states differ.
    for i in np.flatnonzero(gaps == 0):
        if same(sol.y[:, i], sol.y[:, i + 1]):
            yield f"t = {sol.t[i]} stands twice with the same state"


def is_finite(drawn: Drawn, sol: pc.Solution, _: Choices) -> Iterator[str]:
    """What is kept was reached, and what was reached is finite, also where the run failed."""
    for name, values in {"t": sol.t, "y": sol.y, "the end": sol._run.y_reached}.items():
        if not np.isfinite(values).all():
            yield f"{name} is not finite, status {sol.status!r}"
    if drawn.options.get("ledger"):
        for name, values in sol._run.ledger.items():
            if not np.isfinite(values).all():
                yield f"ledger.{name} is not finite, status {sol.status!r}"


def dense_output_meets_the_steps(drawn: Drawn, sol: pc.Solution, choices: Choices) -> Iterator[str]:
    if sol.store != "dense":
        return
    start, end = drawn.t_span[0], sol._run.t_reached
    shares = np.array([choices.real(0, 1) for _ in range(5)])
    times = np.clip(start + shares * (end - start), min(start, end), max(start, end))
    between = sol(times)
    if not np.isfinite(between).all() and np.abs(sol.y).max(initial=0) < 1e100:
        yield f"sol({times.tolist()}) is not finite"
    if "t_eval" not in drawn.options and len(sol.t):
        last_of_each = np.append(np.diff(sol.t) != 0, True)
        if not same(sol(sol.t[last_of_each]), sol.y[:, last_of_each]):
            yield "sol(sol.t) is not sol.y"


def storing_changes_nothing(drawn: Drawn, sol: pc.Solution, choices: Choices) -> Iterator[str]:
    store = choices.one_of(("end", "steps", "dense", "dense"))
    changes = {"store": store, "ledger": choices.one_of((True, False))}
    without = {k: v for k, v in drawn.options.items() if k != "t_eval"}
    other = replace(drawn, options=without | changes).simulate()
    if "time_limit" in (sol.status, other.status):
        return
    if "the ledger" in sol.message + other.message:
        return  # only a run with a ledger ends where the ledger overflows
    if (sol.status, sol._run.t_reached) != (other.status, other._run.t_reached):
        yield f"with {changes}: {_end(other)}, not {_end(sol)}"
    elif not same(sol._run.y_reached, other._run.y_reached):
        yield f"with {changes}: another end"


def resuming_changes_nothing(drawn: Drawn, sol: pc.Solution, choices: Choices) -> Iterator[str]:
    """Cut a run short by max_steps or t_end, and continue it."""
    if "t_eval" in drawn.options or sol.status == "time_limit":
        return
    start, end = drawn.t_span
    most = drawn.options["max_steps"]
    taken = sol.stats.accepted + sol.stats.rejected
    if choices.one_of((True, False)):
        part = drawn.simulate(max_steps=choices.integer(1, max(taken, 1)))
    else:
        middle = start + choices.real(0, 1) * (end - start)
        part = replace(drawn, t_span=(start, middle)).simulate()
    if part.status not in ("finished", "max_steps"):
        return
    whole = part.resume(
        end, max_steps=most, time_limit=drawn.options["time_limit"], on_failure="ignore"
    )
    if sol.status in ("max_steps", "max_turns") or "time_limit" in (part.status, whole.status):
        return  # the whole run was given more steps, or turns
    if (whole.status, whole._run.t_reached) != (sol.status, sol._run.t_reached):
        yield f"resumed after {_end(part)}: {_end(whole)}, not {_end(sol)}"
    elif not same(whole.t, sol.t) or not same(whole.y, sol.y):
        yield "resumed: other states"


def events_are_where_they_are_told(drawn: Drawn, sol: pc.Solution, _: Choices) -> Iterator[str]:
    asked = drawn.options.get("events", ())
    if sol.status == "event" and not any(event.terminal for event in asked):
        yield "ended at an event, and none is terminal"
    if not asked:
        return
    start, end = drawn.t_span[0], sol._run.t_reached
    direction = -1.0 if end < start else 1.0
    for event, found in zip(asked, sol.events, strict=True):
        times = np.array([one.t for one in found])
        if len(times) and not (min(start, end) <= times.min() and times.max() <= max(start, end)):
            yield f"{event!r}: found at {times.tolist()}, outside {start} to {end}"
        if (np.diff(times) * direction < 0).any():
            yield f"{event!r}: found at {times.tolist()}, in no order"
        for one in found:
            if not np.isfinite(one.y).all():
                yield f"{event!r}: the state at t = {one.t} is not finite"
            if event.direction and one.direction != event.direction:
                yield f"{event!r}: found in direction {one.direction}"


def watching_changes_nothing(drawn: Drawn, sol: pc.Solution, _: Choices) -> Iterator[str]:
    asked = drawn.options.get("events", ())
    if not asked or sol.status in ("time_limit", "callback_error", "max_turns"):
        return
    seen = {k: v for k, v in drawn.options.items() if k != "t_eval"} | {"store": "steps"}
    bare = {k: v for k, v in seen.items() if k != "events"}
    watched, plain = (replace(drawn, options=options).simulate() for options in (seen, bare))
    if "time_limit" in (watched.status, plain.status):  # the machine had other things to do
        return
    shared = len(watched.t) - (watched.status == "event")
    if not same(watched.t[:shared], plain.t[:shared]):
        yield "watched, the run takes other steps"
    elif not same(watched.y[:, :shared], plain.y[:, :shared]):
        yield "watched, the run has other states"
    elif watched.status != "event" and watched.status != plain.status:
        yield f"watched: {_end(watched)}, not {_end(plain)}"


def comes_back_from_a_pickle(drawn: Drawn, sol: pc.Solution, _: Choices) -> Iterator[str]:
    own = [getattr(event, "f", None) for event in drawn.options.get("events", ())]
    if any(own) or any(isinstance(effect, OwnEffect) for effect in drawn.scene.effects):
        return
    again = pickle.loads(pickle.dumps(sol))
    if again.status != sol.status or not same(again.y, sol.y) or again.scene != sol.scene:
        yield "another solution comes out of the pickle"
    case = sol.case()
    if pc.read_case(case.to_toml()) != case:
        yield "another case comes out of the TOML"


def views_do_not_fail(drawn: Drawn, sol: pc.Solution, choices: Choices) -> Iterator[str]:
    ordinary = is_ordinary(drawn, sol)
    energy = sol.energy()
    found = {
        "positions": sol.positions(),
        "mass_centers": sol.mass_centers(),
        "energy": energy.total,
    }
    if energy.ledger is not None:
        found["ledger"] = energy.ledger.residual
    if sol.status != "callback_error":
        found |= {"accelerations": sol.accelerations(), "reactions": sol.reactions()}
    for name, values in found.items():
        if np.isnan(values).any() and ordinary and sol.status != "non_finite":
            yield f"{name} has a NaN"
    if choices.one_of((True, False)):
        repr(sol)
        # What a scene costs is measured at rates of its own, which a user's law may refuse.
        if not any(isinstance(effect, pc.effects.User) for effect in drawn.scene.effects):
            repr(drawn.scene.explain())


ALWAYS: tuple[Claim, ...] = (
    says_how_it_ended,
    times_run_one_way,
    is_finite,
    dense_output_meets_the_steps,
    events_are_where_they_are_told,
)
"""The claims that are checked in every case."""

SOMETIMES: tuple[Claim, ...] = (
    storing_changes_nothing,
    watching_changes_nothing,
    resuming_changes_nothing,
    comes_back_from_a_pickle,
    views_do_not_fail,
)
"""Claims that take another run or as much work; every other case checks one of them."""
