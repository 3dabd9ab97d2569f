"""Lyapunov exponents over time, drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pendcore.messages.arguments import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D


def plot_exponents(
    t: Floats, exponents: Floats, ax: Axes | None = None, **line_properties: Any
) -> list[Line2D]:
    """Draw finite-time exponents over time, a line each, on the axes or on new ones of pyplot's."""
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.figure(figsize=(6.4, 4.0), layout="constrained").subplots()
    lines = ax.plot(t, exponents, **{"color": "k", "linewidth": 1.2, **line_properties})
    ax.set_xlabel("t (s)")
    ax.set_ylabel("finite-time Lyapunov exponents (1/s)")
    ax.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
    ax.margins(x=0)
    ax.grid(True, alpha=0.4)
    return lines
