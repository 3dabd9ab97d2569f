"""How many links are derived in symbols, and why no more.

Written out, as the textbook's function file has them, the accelerations of a chain are quotients of
determinants: every link makes them some nine times as long.
"""

from __future__ import annotations

WRITTEN_OUT = (5, 137, 1207, 10190, 90219)
"""Operations of the accelerations of 1, 2, ... uniform rods, written out; a test counts them."""

MOST_LINKS = len(WRITTEN_OUT)


def check_length(n: int) -> None:
    """Refuse a chain that is too long to be written out.

    Raises
    ------
    ValueError
        With what was measured, and what computes such a chain.
    """
    if n > MOST_LINKS:
        counts = ", ".join(f"{count:_}".replace("_", " ") for count in WRITTEN_OUT)
        raise ValueError(
            f"scene: {n} links: at most {MOST_LINKS} are derived in symbols: written out, the "
            f"accelerations of 1 to {MOST_LINKS} bare rods take {counts} operations, some nine "
            "times more with every link; pendcore.simulate takes any number, by an O(n) recursion "
            "that never writes them out"
        )
