"""Solutions as pandas, xarray and spreadsheets know them."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

from pendcore._run.solution import Solution

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_HINT = "needs {0}: pip install {0}"


def to_pandas(solution: Solution) -> pd.DataFrame:
    """See `Solution.to_pandas`."""
    try:
        import pandas as pd
    except ImportError:
        raise ImportError("to_pandas() " + _HINT.format("pandas")) from None
    links = range(1, len(solution.scene.links) + 1)
    units = {f"q_{i}": "rad" for i in links} | {f"qd_{i}": "rad/s" for i in links}
    index = pd.Index(solution.t.copy(), name="time")
    frame = pd.DataFrame(solution.y.T.copy(), columns=list(units), index=index)
    frame.attrs = {"units": {"time": "s", **units}, **_case(solution)}
    return frame


def to_xarray(solution: Solution) -> xr.Dataset:
    """See `Solution.to_xarray`."""
    try:
        import xarray as xr
    except ImportError:
        raise ImportError("to_xarray() " + _HINT.format("xarray")) from None
    links = range(1, len(solution.scene.links) + 1)
    angle = {"units": "rad", "long_name": "absolute angle, from +x (right) towards +y (down)"}
    rate = {"units": "rad/s", "long_name": "angular rate"}
    data: dict[str, Any] = {
        "q": (("time", "link"), solution.q.copy(), angle),
        "qd": (("time", "link"), solution.qd.copy(), rate),
    }
    coords: dict[str, Any] = {"time": ("time", solution.t.copy(), {"units": "s"})}
    coords["link"] = list(links)
    if solution.sensitivities is not None:  # with the axes of `pendcore.reducers.Sensitivities`
        units = {"units": "rad, rad/s per unit of each name"}
        data["sensitivities"] = (("time", "component", "by"), solution.sensitivities, units)
        coords["component"] = [f"{name}_{i}" for name in ("q", "qd") for i in links]
        coords["by"] = list(solution.sensitivity_names)
    return xr.Dataset(data, coords=coords, attrs=_case(solution))


def _case(solution: Solution) -> dict[Hashable, Any]:
    """Return the case as TOML, or nothing if an effect or an event is a function."""
    return {} if solution.has_own_functions else {"case": solution.case().to_toml()}
