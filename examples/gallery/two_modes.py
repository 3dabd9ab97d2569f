"""Two modes.

Two equal rods swing in two ways that never mix while they are small: together, and
against each other. The shapes are eigenvectors.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

scene = pc.Scene.textbook()
hanging = np.full(2, np.pi / 2)
stiffness = np.diag([1.5, 0.5]) * scene.gravity  # g (m1 c1 + m2 L1), g m2 c2
squares, shapes = np.linalg.eig(np.linalg.solve(scene.mass_matrix(hanging), stiffness))
order = np.argsort(squares)
starts = [hanging + 0.3 * shapes[:, k] for k in order]
sol, against = [pc.simulate(scene, (0, 8), q0) for q0 in starts]
sol.to_video(
    "two_modes.mp4", against, beside=True, names=("together", "against each other")
)
sol.to_html("two_modes.html", title="Two modes")
