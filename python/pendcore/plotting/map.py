"""Figures of an ensemble: a curve over one axis of members, a map over two."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore import Ensemble
from pendcore.messages import Floats
from pendcore.plotting.axes import legend_above, one_axes, require_name, whole_names
from pendcore.plotting.style import applied, as_drawn, keep_ticks, theme_of
from pendcore.reducers import FirstEvent, Reducer

WIDE = 30.0
"""The ratio of the largest to the least value from which a scale is logarithmic."""
MAP_SIZE = (6.4, 5.2)
"""inches"""

Mask = npt.NDArray[np.bool_]


class Shown(NamedTuple):
    """What a figure shows: a text with its unit, values, and whether their scale is logarithmic.

    ``blanks`` are the members without a value, by why they have none.
    """

    label: str
    values: Floats
    blanks: dict[str, Mask]
    is_log: bool = False


class Axis(NamedTuple):
    """An axis of a figure: a text with its unit, and the values along it."""

    label: str
    values: Floats

    @classmethod
    def of(cls, name: str, unit: str, values: Floats) -> Axis:
        name = in_symbols(name)
        return cls(f"{name} ({unit})" if unit else name, values)


def in_symbols(name: str) -> str:
    """Return the name of an angle or a rate, such as qd0[2], in LaTeX; others stay."""
    kind, _, link = name.removesuffix("]").partition("[")
    letter = {"q": "q", "qd": r"\dot q"}.get(kind.removesuffix("0"))
    return f"${letter}_{{{link}}}{'(0)' * kind.endswith('0')}$" if letter and link else name


def plot(
    found: Ensemble, what: str | None, ax: Any, resolved: Any, properties: dict[str, Any]
) -> list[Any]:
    """Draw a reducer's values, or a component of the end state; see `Ensemble.plot`."""
    from matplotlib.collections import QuadMesh
    from matplotlib.lines import Line2D

    reducers = found.request.reducers
    if what is None:
        what = next((x for x, one in reducers.items() if not one.axes), "q[1]")
    shown = shown_of(values_of(found, what), what, reducers.get(what), ~found.success)
    if len(found.shape) not in (1, 2):
        raise ValueError(
            f"the ensemble has the shape {found.shape}: a figure needs one axis or two: "
            "draw found.q or found[name] yourself"
        )
    mask = None if resolved is None else np.asarray(resolved, dtype=bool)
    if mask is not None and mask.shape != found.shape:
        raise ValueError(f"resolved: shape {mask.shape}: must be {found.shape}")
    axes = [axis_of(found, k) for k in range(len(found.shape))]
    if len(axes) == 1:
        given = whole_names(Ensemble.plot, Line2D, properties)
        return _draw_curve(one_axes(ax, MAP_SIZE), axes[0], shown, mask, given)
    given = whole_names(Ensemble.plot, QuadMesh, properties, ("vmin", "vmax"))
    return draw_map(one_axes(ax, MAP_SIZE), axes[0], axes[1], shown, mask, given)


def values_of(found: Ensemble, what: str) -> Floats:
    """Return the values of a reducer, or of a component of the end state, of each member."""
    require_name(what)
    reducers, n = found.request.reducers, len(found.members.scene.links)
    if what in reducers:
        if reducers[what].axes:
            raise ValueError(f"what = {what!r}: has several numbers for each member: draw them")
        return found[what]
    if found.request.t_eval is not None:
        raise ValueError(
            'keep="times" keeps states at several times, which are not one number for each member: '
            "draw found.q or found.qd yourself"
        )
    known = [f"{x}[{i}]" for x in ("q", "qd") for i in range(1, n + 1)]
    if what not in known:
        raise ValueError(f"what = {what!r}: must be one of {', '.join([*reducers, *known])}")
    kind, _, number = what.partition("[")
    values: Floats = getattr(found, kind)[..., int(number[:-1]) - 1]
    return values


def shown_of(
    values: Floats, what: str, reducer: Reducer | None, other: Mask, why: str = "the run failed"
) -> Shown:
    """Return how values are shown; those that are missing where ``other`` is have a reason."""
    name, unit = f"{in_symbols(what)} at the end", "rad" if what.startswith("q[") else "rad/s"
    is_log, usual, blank = False, "no value", ~np.isfinite(values)
    if reducer is not None:
        name, unit = as_drawn(what.replace("_", " ")), reducer.unit
        some = values[~blank & (values > 0)]
        is_log = reducer.is_log_if_wide and some.size > 0 and some.max() > WIDE * some.min()
        usual = "did not happen" if isinstance(reducer, FirstEvent) else usual
    return Shown(f"{name} ({unit})", values, {usual: blank & ~other, why: blank & other}, is_log)


def axis_of(found: Ensemble, k: int) -> Axis:
    """Return an axis of the members: the first start or parameter that changes along it alone."""
    members = found.members
    units, given = members.scene.parameter_units(), dict(members.vary)
    for name, starts, unit in (("q0", members.q0, "rad"), ("qd0", members.qd0, "rad/s")):
        for i in range(starts.shape[-1]):
            given[f"{name}[{i + 1}]"], units[f"{name}[{i + 1}]"] = starts[..., i], unit
    for name, values in given.items():
        if not values.size:
            break
        along = np.moveaxis(values, k, 0).reshape(values.shape[k], -1)
        first = along[:, 0]
        steps = np.diff(first)
        is_monotone = len(first) > 1 and ((steps > 0).all() or (steps < 0).all())
        if is_monotone and (along == first[:, None]).all():
            return Axis.of(name, units[name], np.asarray(first))
    return Axis(f"member along axis {k}", np.arange(found.shape[k], dtype=float))


def draw_map(
    axis: Any, x: Axis, y: Axis, shown: Shown, resolved: Mask | None, properties: dict[str, Any]
) -> list[Any]:
    """Draw values (n_x, n_y), and mark what is not resolved, and what has no value."""
    from matplotlib.patches import Patch, PathPatch
    from matplotlib.path import Path

    theme = theme_of(axis)
    mesh: dict[str, Any] = {"shading": "nearest", "rasterized": True, "cmap": "viridis"}
    scale = {"norm": "log"} if shown.is_log else {}
    values = np.ma.masked_where(shown.is_log & ~(shown.values > 0), shown.values)
    image = axis.pcolormesh(x.values, y.values, values.T, **(mesh | scale | properties))
    axis.set(xlabel=x.label, ylabel=y.label)
    with applied():
        keep_ticks(axis.figure.colorbar(image, ax=axis, label=shown.label).ax)
    grounds = zip(shown.blanks.items(), (theme.ground, theme.line, theme.quiet), strict=False)
    marks = [(name, mask, color, "") for (name, mask), color in grounds]
    if resolved is not None:  # hatched, as print without colours has no red
        marks.append(("not resolved", ~resolved, theme.red, "//////"))
    corners = image.get_coordinates()  # (n_y + 1, n_x + 1, 2)
    sides = (corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1])
    pixels = np.stack(sides, axis=2)
    drawn, patches = [image], []
    for name, mask, color, hatch in marks:
        if mask.any():
            ours: dict[str, Any] = {"facecolor": color, "hatch": hatch}
            ours["edgecolor"] = theme.ground if hatch else theme.quiet
            together = Path.make_compound_path_from_polys(pixels[mask.T])
            drawn.append(axis.add_patch(PathPatch(together, lw=0, rasterized=True, **ours)))
            patches.append(Patch(label=f"{name}: {mask.mean():.2%}", **ours))
    legend_above(axis, patches)
    return drawn


def _draw_curve(
    axis: Any, x: Axis, shown: Shown, resolved: Mask | None, properties: dict[str, Any]
) -> list[Any]:
    ours = {"marker": ".", "color": theme_of(axis).ink}
    artists = list(axis.plot(x.values, shown.values, **(ours | properties)))
    if resolved is not None:
        marks = {"marker": "x", "linestyle": "none", "color": theme_of(axis).red}
        at = ~resolved
        artists += axis.plot(x.values[at], shown.values[at], label="not resolved", **marks)
        legend_above(axis)
    axis.set(xlabel=x.label, ylabel=shown.label)
    if shown.is_log:
        axis.set_yscale("log", nonpositive="mask")
    return artists
