"""How much rounding may change a run: the same run with its constants and start moved a little.

All runs in doubles share some rounding errors, as the constants of the mass matrix are rounded
before the first step. So runs may agree with each other and not with the truth where a motion
amplifies a last bit. A run that verifies another one therefore begins with masses, lengths, mass
centres, inertias, gravity and angles that are a few last bits off, each by a random share. This
changes the run several times as much as rounding itself can.
"""

from __future__ import annotations

import numpy as np

from pendcore._run.call import Start
from pendcore._scene.link import Link
from pendcore._scene.scene import Scene

CONSTANTS = ("mass", "length", "center", "inertia")
NEIGHBOURS = ((1e-12, 2), (5e-12, 1))
"""Pairs: rounding may matter in a run below this scale, so that it takes this many neighbours."""
LAST_BITS = 8 * np.finfo(np.float64).eps
"""The largest relative change of a number; an angle below 1 rad changes by up to as many radians.

Constants are formed in two or three operations, each of which is off by half a last bit at most.
"""


def neighbours(scale: float) -> int:
    """Return how many moved motions show what rounding does to a run of a typical error."""
    return next((count for below, count in NEIGHBOURS if scale < below), 0)


def moved(start: Start, seed: int) -> Start:
    """Return a start with constants and angles moved by a few last bits, drawn from a seed.

    Angles stay where they are if effects bound them (stops, locks); a constant of zero stays zero.
    """
    scene = start.scene
    rng = np.random.default_rng(seed)

    def by(count: int) -> list[float]:
        shares = rng.uniform(0.5, 1.0, count) * rng.choice([-1.0, 1.0], count)
        return [float(x) for x in 1.0 + LAST_BITS * shares]

    links = [
        Link(**{name: getattr(one, name) * x for name, x in zip(CONSTANTS, by(4), strict=True)})
        for one in scene.links
    ]
    nearby = Scene._unpickled(links, scene.gravity * by(1)[0], scene.effects)
    if any(effect.description.bounds_joint for effect in scene.effects):
        return start._replace(scene=nearby)
    q = np.broadcast_to(np.asarray(start.q0, dtype=np.float64), len(links))
    off = (np.array(by(len(links))) - 1.0) * np.maximum(1.0, np.abs(q))
    return start._replace(scene=nearby, q0=q + off)
