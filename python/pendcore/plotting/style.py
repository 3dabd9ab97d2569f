"""The house style of everything drawn: its colours, letters and lines, each of them written here.

Figures and films take it as matplotlib's settings, pages as variables of CSS. The page on style in
docs shows it; tests hold the colours to what is said of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Theme:
    """The colours on one ground.

    The six with names of colours can be told apart on ``ground``, also by eyes that lack one kind
    of cone; the first three also in grey print. Texts are ``ink``, or ``quiet`` if they matter
    less; what cannot be trusted any more is ``lost``.
    """

    ground: str
    panel: str
    ink: str
    quiet: str
    line: str
    lost: str
    red: str
    blue: str
    green: str
    purple: str
    ochre: str
    teal: str

    @property
    def links(self) -> tuple[str, ...]:
        """The colours of links and of their curves; red and blue are the book's."""
        return self.red, self.blue, self.green, self.purple, self.ochre, self.teal

    @property
    def parts(self) -> tuple[str, ...]:
        """The colours of what makes up a sum, such as energies; the sum itself is ink."""
        return self.ochre, self.teal, self.purple, self.green, self.blue, self.red

    @property
    def runs(self) -> tuple[str, ...]:
        """The colours of one run after another where a run has one colour."""
        return self.ink, self.ochre, self.teal, self.purple, self.green, self.red

    def link(self, i: int) -> str:
        """Return the colour of a link, counted from 0; the seventh has that of the first."""
        return self.links[i % len(self.links)]

    def run(self, k: int) -> str:
        """Return the colour of a run among several, counted from 0."""
        return self.runs[k % len(self.runs)]

    # What drawings of mechanisms are coloured by: forces at joints, weights, couples, angles that
    # are measured, and other loads, such as drag.
    force = property(attrgetter("purple"))
    weight = property(attrgetter("quiet"))
    couple = property(attrgetter("teal"))
    angle = property(attrgetter("blue"))
    load = property(attrgetter("red"))


LIGHT = Theme(
    ground="#ffffff", panel="#f4f6f8", ink="#1b1f24", quiet="#59626d", line="#d5dae0",
    lost="#b4bbc3", red="#c93f32", blue="#1b4583", green="#12a063", purple="#7d35b8",
    ochre="#b07d00", teal="#0f6f73",
)  # fmt: skip
DARK = Theme(
    ground="#14171a", panel="#1c2024", ink="#e8eaed", quiet="#a3acb6", line="#363d44",
    lost="#59616a", red="#f4604f", blue="#a3c2fa", green="#8fe9a6", purple="#b380ea",
    ochre="#f2cd6a", teal="#43b0aa",
)  # fmt: skip

DASHES = ("-", "--", "-.", ":")
"""For one solution after another on the same axes."""
SIZES = {"small": 0.85, "title": 1.15}
"""The sizes of letters, in those of the text."""


def sheet(theme: Theme = LIGHT) -> dict[str, Any]:
    """Return matplotlib's settings, for ``matplotlib.pyplot.style.use``."""
    from cycler import cycler

    ticks = {"color": theme.line, "labelcolor": theme.quiet, "labelsize": "small"}
    return {
        "figure.facecolor": theme.ground,
        "axes.facecolor": theme.ground,
        "savefig.facecolor": theme.ground,
        "text.color": theme.ink,
        "axes.labelcolor": theme.ink,
        "axes.edgecolor": theme.quiet,
        "axes.prop_cycle": cycler(color=theme.links),
        "font.size": 10.0,
        "axes.titlesize": "medium",
        "axes.titlelocation": "left",
        "legend.fontsize": "small",
        "legend.frameon": False,
        "legend.handlelength": 1.4,
        "legend.columnspacing": 1.4,
        "legend.handletextpad": 0.5,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.axisbelow": True,
        "grid.color": theme.line,
        "grid.linewidth": 0.6,
        "lines.solid_capstyle": "round",
        "lines.solid_joinstyle": "round",
        "image.cmap": "cividis",
        **{f"{axis}tick.{name}": value for axis in "xy" for name, value in ticks.items()},
    }


def applied(others: Mapping[str, Any] | None = None) -> AbstractContextManager[None]:
    """Make figures in the house's style, with some settings changed.

    What the user has set in matplotlib otherwise stays; where that is a dark ground, so is ours.
    """
    import matplotlib as mpl
    from matplotlib.colors import to_rgb

    set_now: Any = mpl.rcParams  # matplotlib's types want each name as a literal
    usual: Any = mpl.rcParamsDefault
    is_dark = sum(to_rgb(set_now["axes.facecolor"])) < 1.5
    house = sheet(DARK if is_dark else LIGHT)
    asked: Any = {**house, **(others or {})}
    ours = {name for name in asked if set_now[name] in (usual[name], house.get(name))}
    return mpl.rc_context({name: asked[name] for name in ours})


def keep_style(axes: Axes) -> None:
    """Fix the style of ticks by what is set now, at multiples of 1, 2 and 5.

    Those of 2.5 take more room than constrained layout knows.
    """
    keep_ticks(axes)
    axes.locator_params(steps=[1, 2, 5, 10])


def keep_ticks(axes: Axes) -> None:
    """Fix how ticks look, which matplotlib makes when it draws, by what is set now."""
    import matplotlib as mpl

    of: Any = mpl.rcParams
    for name in ("x", "y"):
        own: Any = {key: of[f"{name}tick.{key}"] for key in ("color", "labelcolor", "labelsize")}
        getattr(axes, f"{name}axis").set_tick_params(which="both", **own)


def theme_of(axes: Axes) -> Theme:
    """Return the colours that can be seen on the ground of these axes."""
    from matplotlib.colors import to_rgb, to_rgba

    figure: Any = axes.get_figure(root=True)
    *own, alpha = to_rgba(axes.get_facecolor())
    shown = alpha * np.array(own) + (1 - alpha) * np.array(to_rgb(figure.get_facecolor()))
    return LIGHT if shown.sum() > 1.5 else DARK


BY_SYSTEM = "@media (prefers-color-scheme: dark)"
"""When a page is dark that follows its reader's system."""


def css_variables(when_dark: str = BY_SYSTEM) -> str:
    """Return the style as variables of CSS, dark where a selector says so; "" is always light."""
    told = _rule(":root", LIGHT, {f"size-{name}": f"{size}rem" for name, size in SIZES.items()})
    if when_dark == BY_SYSTEM:
        return f"{told}{BY_SYSTEM} {{\n{_rule(':root', DARK)}}}\n"
    return told + _rule(when_dark, DARK) if when_dark else told


def _rule(selector: str, theme: Theme, others: Mapping[str, str] | None = None) -> str:
    """Return a rule of CSS that sets the variables of a theme, and before them others."""
    links = {f"link-{k}": color for k, color in enumerate(theme.links, 1)}
    parts = {f"part-{k}": color for k, color in enumerate(theme.parts, 1)}
    named = {**(others or {}), **vars(theme), **links, **parts, "force": theme.force}
    lines = [f"  --{name}: {value};" for name, value in named.items()]
    return "\n".join([f"{selector} {{", *lines, "}", ""])


def as_drawn(text: str) -> str:
    """Return a user's text as matplotlib has to be told it, so that any can be drawn.

    What stands between dollars is mathematics where matplotlib can read it, else it stays as it is.
    """
    from matplotlib.cbook import is_math_text
    from matplotlib.mathtext import MathTextParser

    if is_math_text(text):
        try:
            MathTextParser("path").parse(text)
        except ValueError:
            return text.replace("$", r"\$")
    return text


def in_legend(name: str) -> str:
    """Return a user's name for a legend, which leaves out what begins with an underscore."""
    return as_drawn(f" {name}" if name.startswith("_") else name)
