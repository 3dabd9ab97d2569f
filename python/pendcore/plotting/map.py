"""Figures of an ensemble: a curve over one axis of members, a map over two."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore import Ensemble
from pendcore.messages import Floats
from pendcore.plotting.axes import (
    NewFigure,
    checked_axes,
    figure_of_pyplot,
    require_name,
    whole_names,
)
from pendcore.plotting.style import RESOLVED, UNRESOLVED, as_drawn

WIDE = 30.0
"""The ratio of the largest to the least value from which a scale is logarithmic."""

Mask = npt.NDArray[np.bool_]


class Shown(NamedTuple):
    """What a figure shows: a text with its unit, values, and whether their scale is logarithmic."""

    label: str
    values: Floats
    is_log: bool = False


class Axis(NamedTuple):
    """An axis of a figure: a text with its unit, and the values along it."""

    label: str
    values: Floats


def plot(
    found: Ensemble, what: str | None, ax: Any, resolved: Any, properties: dict[str, Any]
) -> list[Any]:
    """Draw a reducer's values, or a component of the end state; see `Ensemble.plot`."""
    from matplotlib.collections import QuadMesh
    from matplotlib.lines import Line2D

    shown = shown_of(found, what)
    dimensions = len(found.shape)
    if dimensions not in (1, 2):
        raise ValueError(
            f"the ensemble has the shape {found.shape}: a figure needs one axis or two: "
            "draw found.q or found[name] yourself"
        )
    mask = None if resolved is None else np.asarray(resolved, dtype=bool)
    if mask is not None and mask.shape != found.shape:
        raise ValueError(f"resolved: shape {mask.shape}: must be {found.shape}")
    count = 1 if dimensions == 1 or mask is None else 2
    if dimensions == 1:
        given = whole_names(Ensemble.plot, Line2D, properties)
    else:
        given = whole_names(Ensemble.plot, QuadMesh, properties, ("shading", "vmin", "vmax"))
    which = "for the values and for what is resolved"
    axes = new_axes(count) if ax is None else checked_axes(ax, (count,), which)
    if dimensions == 1:
        return _draw_curve(axes[0], axis_of(found, 0), shown, mask, given)
    return draw_map(axes, axis_of(found, 0), axis_of(found, 1), shown, mask, given)


def new_axes(count: int, new_figure: NewFigure = figure_of_pyplot) -> list[Any]:
    """Return so many axes of a new figure, side by side."""
    figure = new_figure(layout="constrained", figsize=(6.0 * count, 4.8))
    return list(np.atleast_1d(figure.subplots(1, count, sharex=True, sharey=True)))


def shown_of(found: Ensemble, what: str | None) -> Shown:
    """Return what is drawn of an ensemble for a name."""
    reducers = found.request.reducers
    if what is None:
        what = next((x for x, one in reducers.items() if not one.labels(1)), "q[1]")
    require_name(what)
    if what in reducers:
        reducer = reducers[what]
        if reducer.labels(1):
            raise ValueError(f"what = {what!r}: has several numbers for each member: draw them")
        label = as_drawn(f"{what.replace('_', ' ')} ({reducer.unit})")
        is_log = reducer.is_log_if_wide and is_wide(found[what])
        return Shown(label, found[what], is_log)
    if found.request.t_eval is not None:
        raise ValueError(
            'keep="times" keeps states at several times, which are not one number for each member: '
            "draw found.q or found.qd yourself"
        )
    n = len(found.members.scene.links)
    known = [f"{x}[{i}]" for x in ("q", "qd") for i in range(1, n + 1)]
    if what not in known:
        raise ValueError(f"what = {what!r}: must be one of {', '.join([*reducers, *known])}")
    kind, _, number = what.partition("[")
    values = getattr(found, kind)[..., int(number[:-1]) - 1]
    return Shown(f"{what} at the end ({'rad' if kind == 'q' else 'rad/s'})", values)


def is_wide(values: Floats) -> bool:
    """Return whether positive values span so much that a logarithm shows them better."""
    some = values[np.isfinite(values) & (values > 0)]
    return some.size > 0 and bool(some.max() > WIDE * some.min())


def axis_of(found: Ensemble, k: int) -> Axis:
    """Return an axis of the members: the first start or parameter that changes along it alone."""
    members = found.members
    units, given = members.scene.parameter_units(), dict(members.vary)
    for name, starts, unit in (("q0", members.q0, "rad"), ("qd0", members.qd0, "rad/s")):
        for i in range(starts.shape[-1]):
            given[f"{name}[{i + 1}]"], units[f"{name}[{i + 1}]"] = starts[..., i], unit
    for name, values in given.items():
        along = np.moveaxis(values, k, 0).reshape(values.shape[k], -1)
        first = along[:, 0] if along.size else along.ravel()
        steps = np.diff(first)
        is_monotone = len(first) > 1 and ((steps > 0).all() or (steps < 0).all())
        if is_monotone and (along == first[:, None]).all():
            unit = units[name]
            return Axis(f"{name} ({unit})" if unit else name, np.asarray(first))
    return Axis(f"member along axis {k}", np.arange(found.shape[k], dtype=float))


def draw_map(
    axes: list[Any], x: Axis, y: Axis, shown: Shown, mask: Mask | None, properties: dict[str, Any]
) -> list[Any]:
    """Draw values (n_x, n_y), and in a second one of the axes which of them are resolved."""
    from matplotlib.colors import ListedColormap

    values = np.ma.masked_invalid(shown.values)
    if shown.is_log:
        values = np.ma.masked_where(~(values > 0), values)
        properties = {"norm": "log"} | properties
    for ax in axes:
        ax.set_xlabel(x.label)
        ax.set_ylabel(y.label)
    image = axes[0].pcolormesh(
        x.values, y.values, values.T, **({"shading": "nearest", "rasterized": True} | properties)
    )
    axes[0].figure.colorbar(image, ax=axes[0], label=shown.label)
    if mask is None:
        return [image]
    trust = axes[1].pcolormesh(
        x.values, y.values, mask.T.astype(float), cmap=ListedColormap([UNRESOLVED, RESOLVED]),
        vmin=0, vmax=1, shading="nearest", rasterized=True,
    )  # fmt: skip
    bar = axes[1].figure.colorbar(trust, ax=axes[1], ticks=[0.25, 0.75])
    bar.ax.set_yticklabels(["not\nresolved", "resolved"])
    axes[1].set_title(f"resolved: {mask.mean():.1%}")
    return [image, trust]


def _draw_curve(
    ax: Any, x: Axis, shown: Shown, mask: Mask | None, properties: dict[str, Any]
) -> list[Any]:
    artists = list(ax.plot(x.values, shown.values, **({"marker": "."} | properties)))
    if mask is not None:
        known = {"color": UNRESOLVED, "marker": "x", "linestyle": "none", "label": "not resolved"}
        artists += ax.plot(x.values[~mask], shown.values[~mask], **known)
        ax.legend()
    ax.set(xlabel=x.label, ylabel=shown.label)
    if shown.is_log:
        ax.set_yscale("log", nonpositive="mask")
    return artists
