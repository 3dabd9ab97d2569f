"""What is known of a method before it runs: how error and work follow the tolerance.

Over the tolerances that matter the largest position error is proportional to rtol, and the steps to
a small power of 1/rtol, a little less than 1/p with the order p, as the least steps and the
starts do not follow. The factor between error and rtol is the scene's: how fast it is, for how
long, how far it drives neighbours apart. It is measured with pilot runs. From one method's factor
another's follows within a decade. The numbers below are those that served a thousand scenes of
tests/regular_scenes.py best (seeds 0 to 199 and 400 to 1199); docs/asked_errors.py tests others.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import floor, inf, log10
from typing import NamedTuple

from pendcore.accuracy.second_run import TIGHTEST
from pendcore.effect_description import account_of
from pendcore.scene import Scene

LOOSEST = 1e-2
COMPENSATED_BELOW = 1e-12
"""rtol, from which on the rounding of the state is carried on."""
_DIGITS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)


class Law(NamedTuple):
    """Of a method.

    Attributes
    ----------
    exponent : float
        Of 1/rtol in how often it takes a right-hand side or a series.
    factor : float
        Its error as a multiple of that of dopri5 at the same rtol, typically.
    aim : float
        What share of the asked error to aim at, before the method's own factor is measured.
    check : float
        What share of it to aim at in verifying another method's run.
    handicap : float
        By how much a forecast from looser tolerances makes its work too small, typically.
    """

    exponent: float
    factor: float
    aim: float
    check: float
    handicap: float = 1.0


LAWS = {
    "dopri5": Law(exponent=0.182, factor=1.0, aim=0.65, check=0.15),
    "dop853": Law(exponent=0.1, factor=0.065, aim=0.9, check=0.045, handicap=1.2),
    "taylor": Law(exponent=0.03, factor=0.3, aim=0.6, check=0.06, handicap=1.1),
    "radau5": Law(exponent=0.174, factor=0.3, aim=1.0, check=0.1),
}
MEASURED_AIM = 0.7
"""The same once the factor is measured at a tolerance nearby."""
SERIES_TO_DOP853 = 0.092
"""Series that taylor takes at rtol 1e-3 for each right-hand side of dop853, typically."""
INERTIA_ALONE = {"payload", "rotor_inertia"}
"""Effects that change what the links weigh, and add no torque."""


def series_work(scene: Scene, rtol: float) -> float:
    """Return how many right-hand sides take as long as the series of one step of ``taylor``.

    Its order, and so its work, grows with the digits asked for. Measured; the ratio is large where
    the right-hand side has a closed form and the series has not. docs/series_work.py measures it
    again, for every kind of effect.
    """
    n, free = len(scene.links), scene._compiled.mobility()[-1]
    moving = any(account_of(effect.kind) == "drive" for effect in scene.effects)
    waves = sum(getattr(effect, "sinusoid", None) is not None for effect in scene.effects)
    if n == 1:  # where time enters, its sines are the larger part of the right-hand side
        base, exponent = (14.2, 0.035) if moving or waves else (26.0, 0.036)
    elif n == 2 and (moving or waves > 2 or free < n):  # have the series of longer chains
        base, exponent = 26.0, 0.037
    elif n == 2:
        bare = all(effect.kind in INERTIA_ALONE for effect in scene.effects)
        base, exponent = (8.3, 0.030) if bare else (11.2, 0.029)
    else:
        base, exponent = 12.2, 0.040
    if free < n:
        base *= 1.5
    return float(base * (1e-3 / rtol) ** exponent)


def rounded(rtol: float) -> float:
    """Return a tolerance as people write it, not above, within what makes sense."""
    if not rtol > TIGHTEST:
        return TIGHTEST
    if rtol >= LOOSEST:
        return LOOSEST
    power = floor(log10(rtol) + 1e-9)
    digit = max((d for d in _DIGITS if d * 10.0**power <= rtol * 1.0001), default=1.0)
    return float(f"{digit}e{power}")


class Forecast:
    """What is expected of each method on one scene, from the runs that were made."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._factors: dict[str, float] = {}
        self._work: dict[str, tuple[float, float]] = {}

    def measured_error(self, method: str, rtol: float, error: float) -> None:
        """Take note of the error of a run."""
        if 0 < error < inf:
            self._factors[method] = error / rtol

    def measured_distance(
        self, one: tuple[str, float], other: tuple[str, float], distance: float
    ) -> None:
        """Take note of how far apart the runs of two methods are: of the error of the first.

        Each has its share of it, as its method and its tolerance let expect.
        """
        own, others = (LAWS[method].factor * rtol for method, rtol in (one, other))
        self.measured_error(*one, distance * own / (own + others))

    def at_least(self, method: str, rtol: float, error: float) -> None:
        """Take note that the error of a run may have been as large."""
        if 0 < error < inf:
            self._factors[method] = max(self.factor(method), error / rtol)

    def measured_work(self, method: str, rtol: float, work: float) -> None:
        """Take note of the work of a run; the tightest so far counts."""
        if method not in self._work or rtol < self._work[method][0]:
            self._work[method] = (rtol, work)

    def factor(self, method: str) -> float:
        """Return error / rtol, from another method's where its own was not measured."""
        if method in self._factors:
            return self._factors[method]
        if not self._factors:
            return LAWS[method].factor
        other, value = next(iter(self._factors.items()))
        return value * LAWS[method].factor / LAWS[other].factor

    def rtol_for(self, method: str, error: float, aim: float | None = None) -> float:
        """Return the tolerance at which to expect a share, ``aim``, of an error."""
        return rounded(error * (LAWS[method].aim if aim is None else aim) / self.factor(method))

    def work_for(self, method: str, rtol: float) -> float:
        """Return the right-hand sides that a run is expected to take."""
        law = LAWS[method]
        if method in self._work:
            known, work = self._work[method]
        else:
            other, known = "dop853", 1e-3
            work = self.work_for(other, known) / LAWS[other].handicap
            work *= SERIES_TO_DOP853 * series_work(self._scene, known)
        if method == "taylor":
            work *= series_work(self._scene, rtol) / series_work(self._scene, known)
        return float(law.handicap * work * (known / rtol) ** law.exponent)

    def cheapest(self, methods: Iterable[str], error: float) -> tuple[str, float]:
        """Return what is expected to take the least work for an error: a method and its rtol."""
        ways = [(method, self.rtol_for(method, error)) for method in methods]
        return min(ways, key=lambda way: self.work_for(*way))

    def least_work(self, methods: Iterable[str], error: float) -> float:
        """Return the work that an error takes at least, as far as it can be told."""
        return min(self.work_for(m, self.rtol_for(m, error, 1.0)) for m in methods)
