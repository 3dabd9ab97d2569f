"""An ensemble as xarray knows it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import _core
from pendcore.ensemble.result import EnsembleResult

if TYPE_CHECKING:
    import xarray as xr


def to_xarray(found: EnsembleResult) -> xr.Dataset:
    """Return q, qd, t, status and reducers over the members' axes; see `Ensemble.to_xarray`."""
    try:
        import xarray as xr
    except ImportError:
        raise ImportError('to_xarray() needs xarray: pip install "pendcore[export]"') from None
    axes = [f"member_{k}" for k in range(len(found.shape))]
    of_state = [*axes, "link"] if found.t_eval is None else [*axes, "time", "link"]
    names = np.array(_core.member_statuses)
    data: dict[str, Any] = {
        "q": (of_state, found.q, {"units": "rad"}),
        "qd": (of_state, found.qd, {"units": "rad/s"}),
        "t_reached": (axes, found._t, {"units": "s"}),
        "status": (axes, names[found.codes]),
    }
    data |= {name: (axes, found[name], {"units": "s"}) for name in found.reducers}
    links = range(1, len(found.members.scene.links) + 1)
    units = {name: unit for name, unit, _ in _core.parameters(found.members.scene._compiled)}
    coords: dict[str, Any] = {
        "link": list(links),
        "q0": ([*axes, "link"], found.members.q0, {"units": "rad"}),
        "qd0": ([*axes, "link"], found.members.qd0, {"units": "rad/s"}),
    }
    if found.t_eval is not None:
        coords["time"] = ("time", found.t_eval, {"units": "s"})
    coords |= {
        name: (axes, values, {"units": units[name]}) for name, values in found.members.vary.items()
    }
    about = {"scene": repr(found.members.scene), "t_span": list(found.t_span),
             "pendcore": _core.__version__}  # fmt: skip
    return xr.Dataset(data, coords=coords, attrs=about)
