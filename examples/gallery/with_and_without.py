"""With and without friction.

The same release, once without and once with dry friction in the joints: friction
brings the rods to rest in finite time.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

free = pc.Scene.textbook()
friction = [pc.effects.DryJointFriction(joint=j, coulomb=0.8) for j in (1, 2)]
start = np.radians([0, 20])
sol = pc.simulate(free.replace(effects=friction), (0, 12), start)
other = pc.simulate(free, (0, 12), start)
sol.to_video(
    "with_and_without.mp4", other, beside=True, names=("with friction", "without")
)
sol.to_html("with_and_without.html", title="With and without friction")
