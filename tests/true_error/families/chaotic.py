"""Chaotic scenes, from short of where doubles know the error that is asked to beyond it."""

from __future__ import annotations

from dataclasses import replace
from math import log
from typing import Any

import numpy as np
import pendcore as pc

from true_error.asked import asked, times_kept
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains
from true_error.families import smooth_effects as act

E = pc.effects


def chaotic(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("chaotic", seed)
    n = dice.whole(1, 5)
    is_textbook = n == 2 and dice.chance(0.5)
    links = chains.links(dice, n, 0.5) if not is_textbook else list(pc.Scene.textbook().links)
    if n == 1:
        links = [pc.Link(mass=links[0].mass, length=links[0].length)]
    found: list[Any] = []
    if n == 1 or dice.chance(0.15):
        # One rod alone is regular: what drives it makes it chaotic.
        scale = 9.8 * links[0].mass * links[0].length
        drive = act.sinusoid(dice, scale * dice.uniform(0.3, 1.5), dice.uniform(1.0, 4.0))
        found.append(E.Motor(1, sinusoid=drive))
    scene = chains.scene_of(links, found, 9.807)
    start = chains.start(dice, n, (2.0, 3.0), (0.0, 0.0, 2.0))
    drawn = asked(dice, "chaotic", seed, scene, start, 1.0, backward=0.0)
    # Errors grow about so fast, and doubles know them until about here.
    rate = 0.5 if n == 1 else 0.7 * np.sqrt(9.807 * n / sum(link.length for link in links))
    span = dice.uniform(0.2, 1.3) * log(drawn.error / 1e-16) / rate
    if dice.chance(0.08):
        span *= 5
    if dice.chance(0.2):
        span = -span
    t_end = drawn.t_start + span
    options = times_kept(dice, drawn.t_start, t_end)
    options |= {name: drawn.options[name] for name in drawn.options if name == "events"}
    return replace(drawn, t_end=t_end, options=options)
