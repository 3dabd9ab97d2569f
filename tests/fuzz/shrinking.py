"""A smaller case that breaks the same claim: fewer effects, links and options, plainer numbers.

Every try runs in a process of its own, so that a crash or a hang can be made smaller as well.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import islice

import pendcore as pc

from fuzz import watch
from fuzz.drawn_run import Drawn
from fuzz.verdict import of_case

PATIENCE = 20.0


def kind(breach: str) -> str:
    """Return which claim a breach is of."""
    return breach.split(":")[0].split(" in ")[0]


def breaches_alone(case: Drawn, seed: str) -> list[str]:
    """Judge a case in a process of its own."""
    (verdict,) = watch.run(partial(of_case, seed=seed), [case], patience=PATIENCE)
    return verdict.breaches


def smaller(case: Drawn) -> Iterator[Drawn]:
    """Yield cases that are one step smaller."""
    scene = case.scene
    for make in _scenes(scene):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", pc.PendcoreWarning)
                found = make()
        except (ValueError, TypeError):
            continue
        n = len(found.links)
        yield replace(case, scene=found, q0=case.q0[:n], qd0=case.qd0[:n])
    for name in case.options:
        if name not in ("max_steps", "time_limit"):
            left = {k: v for k, v in case.options.items() if k != name}
            if not (name == "t_eval" and left.get("store") == "times"):
                yield replace(case, options=left)
    for name in ("q0", "qd0"):
        numbers = getattr(case, name)
        for i, x in enumerate(numbers):
            for plain in _plainer(x):
                yield replace(case, **{name: [*numbers[:i], plain, *numbers[i + 1 :]]})


def _plainer(x: float) -> list[float]:
    return [y for y in (0.0, 1.0, float(f"{x:.1g}")) if abs(y) <= abs(x) and y != x]


def _scenes(scene: pc.Scene) -> Iterator[Callable[[], pc.Scene]]:
    for i in range(len(scene.effects)):
        yield lambda i=i: scene.replace(effects=scene.effects[:i] + scene.effects[i + 1 :])
    if len(scene.links) > 1:
        yield lambda: scene.replace(links=scene.links[:-1])
    rod = pc.Link(mass=1.0, length=1.0)
    for i, link in enumerate(scene.links):
        if link != rod:
            yield lambda i=i: scene.replace(links=[*scene.links[:i], rod, *scene.links[i + 1 :]])
    for gravity in (9.807, 0.0):
        if scene.gravity not in (9.807, 0.0):
            yield lambda g=gravity: scene.replace(gravity=g)


def shrunk(case: Drawn, seed: str, breach: str, tries: int = 200) -> Drawn:
    """Return the smallest case found that breaks the same claim."""
    while candidates := list(islice(smaller(case), tries)):
        for verdict, candidate in zip(
            watch.run(partial(of_case, seed=seed), candidates, patience=PATIENCE),
            candidates,
            strict=False,
        ):
            tries -= 1
            if any(kind(found) == kind(breach) for found in verdict.breaches):
                case = candidate
                break
        else:
            break
    return case
