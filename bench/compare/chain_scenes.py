"""A scene for forward dynamics: a chain of uniform rods with an effect, in several states.

Angles are absolute, from +x towards +y, y down.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

GRAVITY = 9.807
NUMBERS_IN_ALL = 256  # angles; a short chain's states stay in the nearest memory


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainScene:
    """Masses (n,) are in kg, lengths (n,) in m; q and qd (n_states, n) are in rad and rad/s.

    The calls go through the states in turn; their number is a power of two.
    """

    masses: Array
    lengths: Array
    gravity: float
    effect: str
    q: Array
    qd: Array


def chain_scene(n: int, effect: str = "none", seed: int = 1) -> ChainScene:
    """Draw a hanging, swinging chain of n rods of about 1 kg and 1 m."""
    random = np.random.default_rng(seed)
    n_states = 1 << max(1, (NUMBERS_IN_ALL // n).bit_length() - 1)
    return ChainScene(
        masses=random.uniform(0.8, 1.2, n),
        lengths=random.uniform(0.8, 1.2, n),
        gravity=GRAVITY,
        effect=effect,
        q=np.pi / 2 + random.uniform(-0.8, 0.8, (n_states, n)),
        qd=random.uniform(-1.0, 1.0, (n_states, n)),
    )
