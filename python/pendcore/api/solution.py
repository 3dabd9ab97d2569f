"""A solution, and the case that it comes from: each makes the other, so both stand here."""

from __future__ import annotations

import os
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy.typing as npt

from pendcore.accuracy.defect import Defect, defect
from pendcore.accuracy.estimate import error_of
from pendcore.api.drawn import DrawnResult
from pendcore.api.scene import Scene
from pendcore.api.solve import solve
from pendcore.cases.archive import save
from pendcore.cases.case import CaseData
from pendcore.horizon.lyapunov import LyapunovExponents, lyapunov_of
from pendcore.messages.progress import Progress
from pendcore.run.call import resumed
from pendcore.run.error_estimate import ErrorEstimate
from pendcore.run.keywords import OnFailure
from pendcore.run.options import RUN_DEFAULTS
from pendcore.run.run_error import checked, require_on_failure
from pendcore.views.export import to_pandas, to_xarray
from pendcore.views.table import html, text

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class Solution(DrawnResult):
    """The result of `simulate`.

    Call it, ``sol(t)``, for the state between the steps. It pickles; `save` and `load` keep it all.

    Attributes
    ----------
    scene : Scene
        What moved.
    name : str
        A name for people: that of the case, if there was one. It may be set.
    accuracy : Accuracy or None
        What ``simulate(error=...)`` asked for, reached and paid; None for other runs. Its ``asked``
        and ``achieved`` are shares of the total length, and ``paid`` lists the runs that were made.
        A run that was resumed, or run again from its `case`, has none.

    Examples
    --------
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), [np.pi / 4, np.pi / 3])
    >>> sol.status, sol.q.shape == (len(sol.t), 2)
    ('finished', True)
    >>> f"q_2 = {sol(2.5)[1]:.6f} rad at 2.5 s"
    'q_2 = 0.704933 rad at 2.5 s'
    """

    __slots__ = ()
    scene: Scene

    def defect(self, *, progress: Progress = None) -> Defect:
        """Return the spurious torques, N m: what motors would have to add to make the curve exact.

        See `pendcore.Defect`; `docs/background/defect.md` says how to read them. ``progress`` is as
        in `simulate`. Raises a ValueError if the run did not store its interpolants
        (``store="dense"``).

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> found = sol.defect()
        >>> f"{found.largest:.0e} N m at joint {found.joint}"
        '3e-06 N m at joint 1'
        """
        return defect(self.scene, self.run, progress)

    def estimate_error(
        self, *, time_limit: float | None = None, progress: Progress = None
    ) -> ErrorEstimate:
        """Estimate the error over time from independent second runs, made when first asked for.

        The second runs use another method, at a hundredth of this run's tolerances or less, with
        constants and start moved by some last bits. If the run switched to ``"radau5"``, second
        runs use ``"radau5"`` too. They end where they have nothing in common with this run any
        more. A run that kept an ``error`` has the estimate that verified it.

        Parameters
        ----------
        time_limit : float, optional
            s of wall-clock time, > 0, after which the estimate ends where it is.
        progress : as in `simulate`

        Returns
        -------
        ErrorEstimate
            ``.t`` (n_t,), s, ``.angle``, rad, ``.position``, a share of the total length.

        Raises
        ------
        KeyboardInterrupt, or any exception of ``progress`` or of an effect's function
            The attribute ``estimate`` is what was found so far, ``solution`` is this run.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> error = sol.estimate_error()
        >>> f"{error.angle.max():.0e} rad, {error.position.max():.0e} of the total length"
        '5e-09 rad, 2e-09 of the total length'
        """
        return error_of(self, time_limit=time_limit, progress=progress)

    def valid_until(
        self, limit: float = 0.1, *, of: str = "angle", time_limit: float | None = None
    ) -> float:
        """Return how far to trust the run: the time at which its error passes a limit, s.

        The answer errs on the safe side; it is the end of the run if the error stays within the
        limit. See `ErrorEstimate.valid_until`.

        Parameters
        ----------
        limit : float
            rad; with ``of="position"`` a share of the total length.
        of : {"angle", "position"}
            What is limited: the angles of the links, or the positions of joints and tip.
        time_limit : float, optional
            As in `estimate_error`; the answer is then how far the run is known to hold by then.

        Examples
        --------
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 40), 0.0)  # chaotic
        >>> f"{sol.valid_until():.0f} s, {sol.valid_until(1e-6, of='position'):.0f} s"
        '18 s, 7 s'
        """
        return self.estimate_error(time_limit=time_limit).valid_until(limit, of=of)

    def lyapunov(
        self,
        *,
        count: int | None = None,
        transient: float = 0.0,
        t_eval: npt.ArrayLike | None = None,
        progress: Progress = None,
    ) -> LyapunovExponents:
        """Compute the Lyapunov exponents of this very run, 1/s; see `pendcore.lyapunov`.

        Examples
        --------
        >>> found = pc.Case.textbook().simulate().lyapunov()
        >>> found.exponents.round(2)  # 1/s
        array([ 0.42,  0.04, -0.06, -0.44])
        """
        return lyapunov_of(self, count, transient, t_eval, progress)

    def resume(
        self,
        t_end: float,
        t_eval: npt.ArrayLike | None = None,
        *,
        max_steps: int = RUN_DEFAULTS["max_steps"],
        time_limit: float | None = None,
        on_failure: OnFailure = "warn",
        progress: Progress = None,
    ) -> Solution:
        """Continue to a later end, bitwise as if the run had never stopped.

        Parameters
        ----------
        t_end : float
            s; not before the end of this run, in its direction.
        t_eval : array_like, (k,), optional
            More times to keep, s: at or beyond the end of this run, and beyond its own ``t_eval``.
            Only a run that had a ``t_eval`` takes it.
        max_steps, time_limit, on_failure, progress
            As in `simulate`, for the continuation. It begins before the first attempt that the
            earlier ``t_end`` cut short, because all later steps depend on that cut. Attempts that
            are repeated to the same ``t_end`` do not count, so a ``max_steps`` of 1 makes progress,
            too.

        Returns
        -------
        Solution
            The whole run, from its first start. This solution does not change.

        Raises
        ------
        ValueError, TypeError
            If an argument is out of its range or of the wrong type; the message names it.

        Examples
        --------
        >>> case = pc.Case.textbook()
        >>> longer = case.simulate().resume(10.0)
        >>> whole = pc.simulate(case.scene, (0, 10), case.q0, method="ode45")
        >>> np.array_equal(longer.y, whole.y)  # every bit
        True
        """
        require_on_failure(on_failure)
        longer = resumed(
            self, t_end, t_eval, max_steps=max_steps, time_limit=time_limit, progress=progress
        )
        return checked(longer, on_failure)

    def case(self) -> Case:
        """Return the case of this run, ready to be run again or written as TOML.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> again = sol.case().simulate()
        >>> np.array_equal(again.y, sol.y)
        True
        """
        return Case.of_solution(self)

    def save(self, path: str | os.PathLike[str], *, progress: Progress = None) -> None:
        """Write everything to a file of NumPy's npz format; see `pendcore.load`.

        The file is complete or absent. ``progress`` is as in `simulate`.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.save("run.npz")
        >>> np.array_equal(pc.load("run.npz").y, sol.y)
        True
        """
        save(self, path, progress=progress)

    def to_pandas(self) -> pd.DataFrame:
        """Return a table with a row per time and the columns q_1.., qd_1..; units in ``attrs``.

        Times are in s, angles in rad, rates in rad/s.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> table = sol.to_pandas()
        >>> table.iloc[-1].round(4).to_dict()
        {'q_1': 1.0831, 'q_2': 0.5385, 'qd_1': 1.0004, 'qd_2': 0.3936}
        >>> table.attrs["units"]["qd_2"]
        'rad/s'
        """
        return to_pandas(self)

    def to_xarray(self) -> xr.Dataset:
        """Return ``q`` and ``qd`` over time and link; units and the case in ``attrs``.

        Times are in s, angles in rad, rates in rad/s; each is (n_t, n).

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> data = sol.to_xarray()
        >>> f"{data.qd.sel(link=2)[-1]:.4f} {data.qd.attrs['units']}"
        '0.3936 rad/s'
        """
        return to_xarray(self)

    def __reduce__(self) -> tuple[object, ...]:
        # The scene comes first: if it cannot be pickled, its message says so best.
        verified = None if self.accuracy is None else self.known_error
        return type(self), (self.scene, self.run, self.name, self.accuracy, verified)

    def __deepcopy__(self, memo: object) -> Solution:
        # None of these objects ever changes, so the copy shares them.
        verified = None if self.accuracy is None else self.known_error
        return Solution(self.scene, self.run, self.name, self.accuracy, verified)

    def __repr__(self) -> str:
        return text(self)

    def _repr_html_(self) -> str:
        return html(self)


@dataclass(frozen=True, slots=True, init=False, repr=False, eq=False)
class Case(CaseData):
    """A scene with its start, its time span and the options of its run; immutable and hashable.

    Parameters
    ----------
    scene : Scene
        What moves.
    q0 : array_like, (n,)
        Absolute angles at the start, rad. A scalar holds for every link.
    qd0 : array_like, (n,), default 0
        Rates at the start, rad/s. A scalar holds for every link.
    t_span : (float, float)
        Start and end, s.
    name : str
        A name for people.
    options : mapping
        Keywords of `simulate`; missing ones have its defaults. Kept as a read-only mapping.

    Raises
    ------
    ValueError, TypeError
        If q0, qd0 or t_span are not finite numbers of that shape, or an option is unknown.

    Examples
    --------
    >>> case = pc.Case(scene=pc.Scene.textbook(), q0=0.5, t_span=(0, 5), options={"rtol": 1e-12})
    >>> case.q0, case.simulate().success
    ((0.5, 0.5), True)
    >>> pc.read_case(case.to_toml()) == case
    True
    """

    scene: Scene

    @classmethod
    def textbook(cls) -> Case:
        """Section 2.1 of the textbook: from rest at 45 and 60 degrees, for 5 s, by ode45.

        Examples
        --------
        >>> case = pc.Case.textbook()
        >>> np.degrees(case.q0).round(6), case.t_span
        (array([45., 60.]), (0.0, 5.0))
        """
        return cls(
            name="double pendulum, section 2.1",
            scene=Scene.textbook(),
            q0=(pi / 4, pi / 3),
            t_span=(0.0, 5.0),
            options={"method": "ode45"},
        )

    def simulate(self, *, on_failure: OnFailure | None = None) -> Solution:
        """Run the case; see `pendcore.simulate`. The solution has the name of the case.

        If ``on_failure`` is given, it replaces that of the case.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.name
        'double pendulum, section 2.1'
        """
        options = dict(self.options)
        if on_failure is not None:
            options["on_failure"] = on_failure
        try:
            solution = solve(Solution, self.scene, self.t_span, self.q0, self.qd0, options)
        except BaseException as stop:
            if isinstance(so_far := getattr(stop, "solution", None), Solution):
                so_far.name = self.name
            raise
        solution.name = self.name
        return solution
