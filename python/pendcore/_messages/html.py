"""Small tables and drawings in HTML, as notebooks show objects; numbers only, no style sheet."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from pendcore._messages.arguments import Floats

_LEFT = "text-align: left; vertical-align: top"
_WIDTH = 180
"""Pixels, of a drawing."""


def table(rows: Iterable[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return a table; without a head, the first cell of each row names it."""

    def line(first: str, others: str, row: Sequence[str]) -> str:
        kinds = [first, *[others] * (len(row) - 1)]
        cells = (f"<{x} style='{_LEFT}'>{escape(y)}</{x}>" for x, y in zip(kinds, row, strict=True))
        return f"<tr>{''.join(cells)}</tr>"

    lines = [line("th", "th", head)] if head else []
    lines += [line("td" if head else "th", "td", row) for row in rows]
    return f"<table>{''.join(lines)}</table>"


def beside(*parts: str) -> str:
    """Return parts side by side."""
    inner = "".join(f"<div style='margin-right: 1.5em'>{part}</div>" for part in parts)
    return f"<div style='display: flex; flex-wrap: wrap; align-items: flex-start'>{inner}</div>"


def drawing(poses: Iterable[Floats], path: Floats | None, title: str = "") -> str:
    """Return chains, (n+1, 2) places in m each, as a drawing; y points down, as in SVG itself.

    The last pose is the plainest, those before it are the fainter the earlier. ``path``, (k, 2), is
    a line behind them.
    """
    shown = [np.asarray(pose) for pose in poses]
    if path is not None:
        path = path[np.isfinite(path).all(axis=1)]
    every = np.concatenate([*shown, *([] if path is None else [path])])
    low, high = every.min(axis=0), every.max(axis=0)
    size = max(float((high - low).max()), 1e-12)
    scale = 0.84 * _WIDTH / size
    shift = _WIDTH / 2 - scale * (low + high) / 2

    def drawn(line: Floats, stroke: str, width: int, opacity: float) -> str:
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in scale * line + shift)
        how = f"fill='none' stroke='{stroke}' stroke-width='{width}' opacity='{opacity:.2f}'"
        return f"<polyline points='{points}' {how} stroke-linecap='round' stroke-linejoin='round'/>"

    lines = [] if path is None else [drawn(path, "#1f5fa8", 1, 0.6)]
    for k, pose in enumerate(shown, 1):
        opacity = 1.0 if k == len(shown) else 0.15 + 0.45 * k / len(shown)
        lines.append(drawn(pose, "currentColor", 3, opacity))
    return (
        f"<svg width='{_WIDTH}' height='{_WIDTH}' role='img'><title>{escape(title)}</title>"
        f"{''.join(lines)}</svg>"
    )
