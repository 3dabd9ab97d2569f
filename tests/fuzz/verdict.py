"""The result of one case from its seed, and every claim that it breaks."""

from __future__ import annotations

import re
import time
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field

import pendcore as pc

from fuzz.choices import Choices, FromSeed, happens
from fuzz.claims import ALWAYS, SOMETIMES, Claim
from fuzz.drawn_run import TIME_LIMIT, Drawn, drawn
from fuzz.own_functions import Forces, Raised, Watched


@dataclass
class Verdict:
    """The result of a case: a status, "refused: ..." or "not drawn", and what it broke."""

    outcome: str
    breaches: list[str] = field(default_factory=list)
    seconds: float = 0.0


def seed_of(campaign: str, case: int) -> str:
    """Return the seed of a case of a campaign."""
    return f"{campaign}/{case}"


def of_number(case: int, campaign: str) -> Verdict:
    """Draw a case of a campaign, and judge it."""
    seed = seed_of(campaign, case)
    try:
        return of_case(drawn(FromSeed(seed)), seed)
    except ValueError as refusal:
        return Verdict(outcome_of_refusal("not drawn", refusal))


def of_case(case: Drawn, seed: str) -> Verdict:
    """Run a case, and check the claims; the seed chooses those that are not always checked."""
    choices = FromSeed(f"{seed}, claims")
    claims: list[Claim] = [*ALWAYS]
    if happens(choices, 50):
        claims.append(choices.one_of(SOMETIMES))
    started = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        verdict = _judged(case, claims, choices)
    verdict.seconds = time.perf_counter() - started
    if verdict.seconds > 4 * TIME_LIMIT:
        verdict.breaches.append(f"took {verdict.seconds:.1f} s: the time limit does not bound it")
    return verdict


def _judged(case: Drawn, claims: list[Claim], choices: Choices) -> Verdict:
    try:
        try:
            sol = case.simulate()
        except (ValueError, TypeError) as refusal:
            if not hasattr(refusal, "solution"):
                return _refused(refusal)
            sol = refusal.solution
        except Raised as raised:
            if not hasattr(raised, "solution"):
                return Verdict("raised before the first step")
            sol = raised.solution
    except Exception as error:
        return Verdict("broke", [_told(error)])
    verdict = Verdict(sol.status)
    for claim in claims:
        verdict.breaches += [f"{claim.__name__}: {x}" for x in _held(claim, case, sol, choices)]
    return verdict


def _held(claim: Claim, case: Drawn, sol: pc.Solution, choices: Choices) -> Iterator[str]:
    try:
        yield from claim(case, sol, choices)
    except Exception as error:
        if hasattr(error, "solution") or _has_own(case):
            return  # the user's function raised once more
        yield _told(error)


def _has_own(case: Drawn) -> bool:
    own = [getattr(e, "function", None) for e in case.scene.effects]
    own += [getattr(e, "f", None) for e in case.options.get("events", ())]
    return any(isinstance(function, Forces | Watched) for function in own)


def _refused(refusal: Exception) -> Verdict:
    message = str(refusal)
    breaches = [] if len(message) > 10 and ":" in message else [f"refused in no words: {message!r}"]
    return Verdict(outcome_of_refusal("refused", refusal), breaches)


def outcome_of_refusal(word: str, refusal: Exception) -> str:
    """Return the kind of a refusal: its message without numbers."""
    text = re.sub(r"\(\w+\)|[-+]?\d[\d.e+-]*|-?\b(?:inf|nan)\b", "", str(refusal))
    return f"{word}: {' '.join(text.split())[:60]}"


def _told(error: Exception) -> str:
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "fuzz/" not in f.filename]
    where = f" in {frames[-1].name}" if frames else ""
    return f"{type(error).__name__}{where}: {error}"
