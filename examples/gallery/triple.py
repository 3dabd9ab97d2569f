"""Three rods.

Three equal rods turn over and over: a quarter of a minute of weather in a mechanism.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.5)] * 3)
sol = pc.simulate(scene, (0, 15), np.radians([-60, -90, -120]))
sol.to_video("triple.mp4", horizon=0.1)
sol.to_html("triple.html", title="Three rods")
