"""A locked joint: phi = constant, held by a couple that is one more unknown."""

from __future__ import annotations

from pendcore.derive.laws.law import Law


class Lock(Law):
    """See the core's effect of that name.

    Its couple Lambda_j does no work; qdd_j = qdd_(j-1) is one equation more. At which angle it is
    locked is the state's affair.
    """

    sentence = "A lock keeps the angle of the joint constant, by a couple that is unknown"

    def lock(self) -> int:
        """Return its joint."""
        return int(self.effect.joint)
