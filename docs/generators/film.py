"""Make the README's film: three pendulums that start a ten-thousandth of a radian apart.

    make write PAGE=film

writes docs/figures/swing.gif, in true time.
"""

from __future__ import annotations

from pathlib import Path

import pendcore as pc

TARGET = Path(__file__).parents[1] / "figures" / "swing.gif"
APART = 1e-4  # rad
UNTIL = 12.0  # s


def runs() -> list[pc.Solution]:
    scene = pc.Scene.textbook()
    return [
        pc.simulate(scene, (0, UNTIL), [-0.6, -0.9 + k * APART], rtol=1e-11, atol=1e-12)
        for k in range(3)
    ]


def main() -> None:
    first, second, third = runs()
    names = ("q2 = -0.9 rad", "-0.8999 rad", "-0.8998 rad")
    third.to_video(TARGET, second, first, names=names[::-1], fps=20, trace=0.6, size=(560, 420))
    print(f"{TARGET}: {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
