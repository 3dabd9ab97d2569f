"""What rounding may do to a run: the same run with its constants and start moved a little.

Runs in doubles share more than they seem to: the constants of the mass matrix are rounded before
the first step, and alike in all of them. So runs agree with each other and not with the truth
where a motion makes much of a last bit. A run that verifies another one therefore begins with
masses, lengths, mass centres, inertias, gravity and angles that are a few last bits off, each by a
random share of its own. What comes of that is several times what rounding itself can have done.
"""

from __future__ import annotations

import numpy as np

from pendcore.run.call import Start
from pendcore.scene.link import Link
from pendcore.scene.scene import SceneData

CONSTANTS = ("mass", "length", "center", "inertia")
LAST_BITS = 8 * np.finfo(np.float64).eps
"""How far a number is moved at most, relatively; an angle below 1 rad by so many radians.

Constants are formed in two or three operations, each of which is off by half a last bit at most.
"""


def moved(start: Start, seed: int) -> Start:
    """Return what is run with its constants and angles some last bits off, others for each seed.

    Angles stay where effects say where they may be (stops, locks); a constant that is zero stays
    zero.
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
    nearby = SceneData._unpickled(links, scene.gravity * by(1)[0], scene.effects)
    if any(effect.description.bounds_joint for effect in scene.effects):
        return start._replace(scene=nearby)
    q = np.broadcast_to(np.asarray(start.q0, dtype=np.float64), len(links))
    off = (np.array(by(len(links))) - 1.0) * np.maximum(1.0, np.abs(q))
    return start._replace(scene=nearby, q0=q + off)
