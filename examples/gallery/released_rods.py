"""Released rods.

The textbook's two rods, let go at rest. The forces at the joints are drawn as they
act on each link.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

scene = pc.Scene.textbook()
sol = pc.simulate(scene, (0, 10), np.radians([-35, -50]))
sol.to_video("released_rods.mp4", reactions=True)
sol.to_html("released_rods.html", title="Released rods")
