"""How everything drawn looks: colours, dashes, and texts of the user's."""

from __future__ import annotations

from typing import Any

COLORS = ("r", "b", "g", "m", "c", "k")
"""The colours of links and of curves; red and blue are the book's."""
DASHES = ("-", "--", "-.", ":")
"""For one solution after another on the same axes."""
SUM: dict[str, Any] = {"color": "0.4", "linewidth": 1.0}
"""How a curve looks that is made of those beside it."""
OUTSIDE: dict[str, Any] = {
    "loc": "center left",
    "bbox_to_anchor": (1.0, 0.5),
    "fontsize": "small",
    "frameon": False,
}
"""Where the legend of many curves is."""
SHADE: dict[str, Any] = {
    "facecolor": "0.85",
    "edgecolor": "0.45",
    "hatch": "//",
    "linewidth": 0,
    "zorder": 0,
}
"""What lies over the times past the horizon."""
PALE: dict[str, Any] = {"color": "0.75", "linewidth": 0.8, "zorder": 1}
"""How a curve in a plane looks past the horizon."""
FORCES = {
    "joint": ("r", "force at a joint"),
    "weight": ("0.35", "weight"),
    "other": ("g", "other forces on the link"),
}
"""The colour and the name of each kind of force on a free body."""
UNRESOLVED, RESOLVED = "0.75", "tab:green"
"""The colours of what a map does not resolve, and of what it does."""
CHAINS = ("0.1", "tab:red", "tab:blue", "tab:green", "tab:purple", "tab:brown")
"""The colours of one run after another in a film."""
LOST = "0.72"
"""The colour of a run in a film past the time until which it can be trusted."""
REACTION = "tab:orange"
"""The colour of the forces in a film."""


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
