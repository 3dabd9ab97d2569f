"""Make the README's film: two rods let go, the forces in their joints, and how large these are.

    make write PAGE=film

writes docs/figures/swing.gif, in true time.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pendcore as pc

TARGET = Path(__file__).parents[1] / "figures" / "swing.gif"


def main() -> None:
    sol = pc.simulate(pc.Scene.textbook(), (0, 8), np.radians([-35, -50]))
    sol.to_video(TARGET, fps=20, trace=1.0, reactions=True)
    print(f"{TARGET}: {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
