"""An ensemble as xarray knows it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import _core
from pendcore._ensemble.coordinates import coordinates, member_axes
from pendcore._ensemble.ensemble import Ensemble

if TYPE_CHECKING:
    import xarray as xr


def to_xarray(found: Ensemble) -> xr.Dataset:
    """Return q, qd, t, status and reducers over the members' axes; see `Ensemble.to_xarray`."""
    try:
        import xarray as xr
    except ImportError:
        raise ImportError("to_xarray() needs xarray: pip install xarray") from None
    axes = member_axes(found.shape)
    members, request = found.members, found.request
    data: dict[str, Any] = {}
    coords: dict[str, Any] = {
        one.name: (one.axes, one.values, {"units": one.unit}) for one in coordinates(members)
    }
    for one in request.variables(len(members.scene.links)):
        values = np.asarray(found.arrays[one.name][...])
        if one.name == "status":
            values = np.array(_core.member_statuses)[values]
        data[one.name] = ([*axes, *one.labels], values, {"units": one.unit} if one.unit else {})
        coords |= {axis: list(labels) for axis, labels in one.labels.items()}
    if request.t_eval is not None:
        coords["time"] = ("time", request.t_eval, {"units": "s"})
    told = {"scene": repr(members.scene), "t_span": list(request.t_span),
            "pendcore": _core.__version__}  # fmt: skip
    return xr.Dataset(data, coords=coords, attrs=told)
