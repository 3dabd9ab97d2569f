"""What can be seen of a solution: figures, an animation, a film."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from pendcore.cases.whole_file import whole_file
from pendcore.figures.plot import What
from pendcore.figures.plot import plot as draw
from pendcore.films.animate import animate
from pendcore.films.stage import Choices
from pendcore.films.video import to_video
from pendcore.messages.arguments import text, whole_number
from pendcore.messages.progress import Progress
from pendcore.page.html import page_of
from pendcore.page.notebook import NotebookPage, widget_of
from pendcore.run.result import RunResult

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.artist import Artist


class DrawnResult(RunResult):
    """The methods of `pendcore.Solution` that draw."""

    __slots__ = ()

    def plot(
        self,
        ax: Any = None,
        *,
        what: What = "angles",
        label: str | None = None,
        horizon: float | None = None,
        t: npt.ArrayLike | None = None,
        event: int | None = None,
        link: int | None = None,
        **line_properties: Any,
    ) -> list[Artist]:
        """Draw a figure; without ``what``, the textbook's: the angles, deg, over time, s.

        Curves go from the first to the last time that was kept, or from start to end if there is
        but one. A run without dense output is simulated anew where it is not known between them.

        =================  ========================================================================
        ``"angles"``       the absolute angle of each link, deg, over time
        ``"rates"``        the rate of each link, rad/s, over time
        ``"reactions"``    the force on each link at its joint, N, over time: x, y (downwards), size
        ``"energy"``       kinetic, potential and total energy, J, over time; with ``ledger=True``
                           the work and loss of every effect
        ``"path"``         the path of the tip in the plane, with the chain at the start and the end
        ``"phase"``        the rate of each link, rad/s, over its angle, rad
        ``"section"``      a Poincare section: rate over angle of a ``link`` where an ``event``
                           happened, an index into ``sol.events``
        ``"strip"``        the chain at the times ``t``, s, (k,), side by side
        ``"free_bodies"``  each link by itself with the forces on it, N, at the time ``t``, s;
                           couples in joints are not drawn
        =================  ========================================================================

        Parameters
        ----------
        ax : Axes or array of Axes, optional
            One axes; for angles and rates also one for each link, for reactions one for each joint,
            for energy two with a ledger. Default: a new figure of pyplot's, which is not shown.
            Where curves are drawn already, the next ones are dashed.
        what : str
            The figure.
        label : str, optional
            Name of this solution in the legend.
        horizon : float, optional
            rad. What lies past the time at which the estimated error passes it is shaded or pale
            (`valid_until`: that takes further runs, when it is first asked for).
        t, event, link
            As above. Defaults: eight times along the curves, or where they begin; 0; 1.
        **line_properties
            Passed on to matplotlib's ``Line2D``, such as ``color``, ``linestyle`` or ``linewidth``.

        Returns
        -------
        list of Artist
            The lines; of poses also texts and arrows. ``artists[0].axes`` leads to the rest.

        Raises
        ------
        ValueError, TypeError
            If there is no such figure, or a parameter is not one of it; in the words of ``sol(t)``
            if the run kept no dense output and cannot be simulated anew: a function of the user's
            gives other values now, say.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> first, second = sol.plot(label="section 2.1")
        >>> second.axes.get_ylabel()  # first.axes.figure.savefig("angles.png") keeps the figure
        'q2 (deg)'
        >>> sol.plot(what="path")[0].axes.get_ylabel()
        'y (m), downwards'
        """
        return draw(
            self, ax, what=what, label=label, horizon=horizon, t=t, event=event, link=link,
            **line_properties,
        )  # fmt: skip

    def animate(
        self,
        *others: RunResult,
        names: tuple[str, ...] | None = None,
        speed: float = 1.0,
        fps: float = 30.0,
        trace: float | None = 2.0,
        reactions: bool = False,
        energy: bool = False,
        horizon: float | None = None,
        beside: bool = False,
    ) -> FuncAnimation:
        """Return matplotlib's animation of the run, in true time; keep it while it is to move.

        The parameters are those of `to_video`. In a notebook ``HTML(sol.animate().to_jshtml())``
        shows it; `to_video` writes it far faster than ``animation.save``.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> animation = sol.animate(energy=True)
        >>> len([*animation.new_frame_seq()])  # 5 s at 30 frames a second
        151
        """
        given = Choices(
            speed=speed, fps=fps, trace=trace, reactions=reactions, energy=energy,
            horizon=horizon, beside=beside,
        )  # fmt: skip
        return animate((self, *others), _names((self, *others), names), given)

    def to_video(
        self,
        path: str | os.PathLike[str],
        *others: RunResult,
        names: tuple[str, ...] | None = None,
        speed: float = 1.0,
        fps: float = 30.0,
        trace: float | None = 2.0,
        reactions: bool = False,
        energy: bool = False,
        horizon: float | None = None,
        beside: bool = False,
        size: tuple[int, int] | None = None,
        progress: Progress = None,
    ) -> Path:
        """Write a film of the run, in true time; return where it is.

        A run without dense output is simulated anew for it, or refused in the words of ``sol(t)``.

        Parameters
        ----------
        path : path
            Ends with ``.mp4`` (takes ffmpeg, or the package imageio-ffmpeg; without either, a GIF
            is written, and a warning says so) or with ``.gif``. The file is complete or absent.
        *others : Solution
            More runs in the same film: on top of this one, or with ``beside`` next to it.
        names : tuple of str, optional
            What the legend calls the runs. Default: their own names, if there are several.
        speed : float
            How fast time passes; 1 is true time, 0.25 slow motion.
        fps : float
            Frames a second.
        trace : float, optional
            s of the run that the trace of the tip shows; None draws none.
        reactions : bool
            Whether arrows show the force on each link at its joint; the longest is that of the
            largest force in the film.
        energy : bool
            Whether a strip below shows the energies of this run.
        horizon : float, optional
            rad; a run is drawn pale past the time until which its error is below this
            (`Solution.valid_until`, which takes further runs).
        beside : bool
            Whether several runs are drawn side by side.
        size : (int, int), optional
            Width and height in pixels, even. Default: (1920, 1080), for a GIF (640, 360).
        progress : as in `simulate`

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.to_video("swing.gif", speed=2).name
        'swing.gif'
        """
        given = Choices(
            speed=speed, fps=fps, trace=trace, reactions=reactions, energy=energy,
            horizon=horizon, beside=beside,
        )  # fmt: skip
        runs = self, *others
        return to_video(runs, _names(runs, names), path, given, size, progress)

    def to_html(self, path: str | os.PathLike[str], *, title: str | None = None) -> Path:
        """Write the run as one page with the core inside, which opens from disk; return its path.

        The page simulates by itself, with the bits of this run, and says so by both hashes. Its
        reader drags links, changes every parameter, adds effects, chooses method and tolerance, and
        sees reactions, energies, until when the run can be trusted, and what accuracy costs. Its
        address holds the run that it shows. Pages of scenes with functions of one's own, and pages
        made by an install without the core for browsers, play back what was computed here, and say
        so. The file is complete or absent.

        Parameters
        ----------
        path : path
        title : str, optional
            The headline. Default: the name of the run.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.to_html("run.html").name
        'run.html'
        """
        if Path(path).suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"path = {os.fspath(path)!r}: must end with .html")
        page = page_of(self, title)
        with whole_file(path) as file:
            file.write_text(page, encoding="utf-8")
        return Path(path)

    def page(self, *, height: int = 900) -> NotebookPage:
        """Return the page of `to_html` as a notebook shows it: alive, in exported notebooks, too.

        ``height`` is in pixels. A notebook grows by the size of the page.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.page()._repr_html_()[:15]  # a notebook calls this
        '<iframe srcdoc='
        """
        pixels = whole_number("height", height)
        return NotebookPage(page_of(self), pixels)

    def widget(self, *, height: int = 900) -> Any:
        """Return the same page as an anywidget (which takes that package).

        Its attribute ``case`` is the case that the page shows now, named as in a case file: what
        its reader has dragged and set can be read in Python.

        Examples
        --------
        >>> widget = pc.Case.textbook().simulate().widget()
        >>> widget.case is None  # until a notebook shows it
        True
        """
        pixels = whole_number("height", height)
        return widget_of(page_of(self), pixels)


def _names(runs: tuple[RunResult, ...], given: tuple[str, ...] | None) -> tuple[str, ...]:
    """Return what the legend calls the runs; nothing for one that is alone."""
    for one in runs:
        if not isinstance(one, RunResult):
            raise TypeError(f"{one!r}: must be a Solution, to be shown beside this one")
    if given is None:
        return tuple(one.name if len(runs) > 1 else "" for one in runs)
    if isinstance(given, str) or len(given) != len(runs):
        raise ValueError(f"names = {given!r}: must be {len(runs)}, one for each run")
    return tuple(
        text(f"names[{k}]", "" if one is None else str(one)) for k, one in enumerate(given)
    )
