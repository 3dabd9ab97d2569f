"""The estimated error of a run over its whole curve."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from pendcore._messages.arguments import Floats, positive


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ErrorEstimate:
    """The error of a run over time, estimated from above.

    Attributes
    ----------
    begin : float
        s, the start of the run.
    t : ndarray, (n_t,)
        Times, s: several in every step of a run with dense output, otherwise those that the run
        kept. They end before the run does if the run is lost, or if a second run did not get
        further.
    angle : ndarray, (n_t,)
        The largest error over the links, rad.
    position : ndarray, (n_t,)
        The largest error over the joints and the tip, as a share of the total length.
    verified_by : str
        How the second runs were made, or which run's defect took their place.
    is_lost : bool
        Whether the run had nothing in common with the motion any more at the last time.
    is_complete : bool
        Whether the times go to where the run is lost, or to its end.
    is_dense : bool
        Whether the times cover the whole curve.

    Examples
    --------
    >>> error = pc.Case.textbook().simulate().estimate_error()
    >>> f"{error.largest:.0e} of the length, {error.angle.max():.0e} rad"
    '2e-09 of the length, 5e-09 rad'
    >>> error.valid_until(1e-6)  # s: the end of the run
    5.0
    """

    begin: float
    t: Floats
    angle: Floats
    position: Floats
    verified_by: str
    is_lost: bool = False
    is_complete: bool = True
    is_dense: bool = True

    @property
    def tells_the_end(self) -> bool:
        """Whether the error is known up to the end of the run."""
        return self.is_complete and not self.is_lost

    @property
    def largest(self) -> float:
        """The largest error of a position, as a share of the total length; inf if none is known."""
        largest = float(self.position.max(initial=0.0)) if len(self.t) else inf
        return largest if largest == largest else inf

    def valid_until(self, limit: float = 0.1, *, of: str = "angle") -> float:
        """Return the last time until which the error stays within a limit, s.

        Parameters
        ----------
        limit : float
            > 0, rad; with ``of="position"`` a share of the total length.
        of : {"angle", "position"}
            What is limited: the angles of the links, or the positions of joints and tip.

        Returns
        -------
        float
            The end of the run if the error stays within the limit; its start if the error at the
            first time that is kept is beyond the limit, or none is known: a run that keeps only its
            end knows no time between. The error is assumed never to shrink.
        """
        if of not in ("angle", "position"):
            raise ValueError(f'of = {of!r}: must be "angle" (rad) or "position" (a share)')
        error = self.angle if of == "angle" else self.position
        limit = positive("limit", limit, "rad" if of == "angle" else "of the total length")
        is_past = ~(error <= limit)
        is_past[-1:] |= self.is_lost
        within = np.argmax(is_past) if is_past.any() else len(self.t)
        return float(self.t[within - 1]) if within else self.begin

    def __repr__(self) -> str:
        until = self.t[-1] if len(self.t) else self.begin
        where = "everywhere" if self.is_dense else f"at {len(self.t)} time{'s'[: len(self.t) != 1]}"
        ends = ""
        if self.is_lost:
            ends = "; past that nothing of it is known any more"
        elif not self.is_complete:
            ends = "; the run goes on past that: it is not known there yet"
        return (
            f"error estimated {where} from t = {self.begin:.6g} to {until:.6g} s: "
            f"angles up to {self.angle.max(initial=0.0):.1e} rad, positions up to "
            f"{self.position.max(initial=0.0):.1e} of the total length, verified by "
            f"{self.verified_by}{ends}"
        )
