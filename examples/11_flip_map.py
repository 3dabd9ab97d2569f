"""A flip map: when the second rod first turns over, and which of its pixels are true.

The case of 11_flip_map.toml, run from a plane of starts. A second ensemble, with
another method and with last bits moved, says where the map shows the motion and not its
rounding errors.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pendcore as pc

case = pc.read_case(Path(__file__).with_suffix(".toml"))
over = case.options["events"][0]
theta = np.radians(np.linspace(-177, 177, 60))  # from hanging
plane = np.stack(np.meshgrid(theta, theta, indexing="ij"), axis=-1)
q0 = pc.angles_from_vertical(plane)

turned = pc.ensemble(case.scene, case.t_span, q0, keep=pc.reducers.FirstEvent(over))
print(turned)
resolved = turned.resolved()
print(f"{resolved.mean():.1%} of the pixels are resolved")

image, *marks = turned.plot(resolved=resolved)
image.figure.savefig("flip_map.png", dpi=120)
