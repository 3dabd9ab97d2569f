"""Chains with a link so short that its angle may be lost while all positions are still right.

The error that is asked for is from a third of the link's share of the length to ten times that.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pendcore as pc

from true_error.asked import asked
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains


def short_links(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("short_links", seed)
    n = dice.whole(2, 3)
    share = dice.decades(-2.5, -1.0)
    short = dice.whole(1, n)
    links = []
    for number in range(1, n + 1):
        length = share if number == short else dice.uniform(0.5, 1.0)
        mass = dice.decades(-0.5, 0.5)
        links.append(dice.one_of((pc.Link.point_mass, pc.Link))(mass=mass, length=length))
    scene = chains.scene_of(links, [], 9.807)
    start = chains.start(dice, n, (1.0, 2.0, 3.0), (0.0, 0.0, 2.0))
    drawn = asked(dice, "short_links", seed, scene, start, dice.uniform(1.0, 30.0))
    total = sum(link.length for link in links)
    return replace(drawn, error=float(np.clip(share / total * dice.decades(-0.5, 1.0), 1e-4, 0.2)))
