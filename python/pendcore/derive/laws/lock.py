"""A locked joint: phi = constant, held by a couple that is one more unknown."""

from __future__ import annotations

from pendcore.derive.laws.law import Law
from pendcore.derive.notation import Notation


class Lock(Law):
    """See the core's effect of that name.

    Its couple Lambda_j does no work; qdd_j = qdd_(j-1) is one more equation. The angle at which the
    joint is locked comes from the state.
    """

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        joint = self.effect.joint
        return (
            f"A lock keeps the angle of joint {joint} constant by the couple "
            f"$\\Lambda_{{{joint}}}$, one more unknown, on the link beyond it."
        )

    def lock(self) -> int:
        """Return its joint."""
        return int(self.effect.joint)
