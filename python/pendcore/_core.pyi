"""The compiled core: scenes, runs and methods as numbers and arrays, for the package alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

_Floats: TypeAlias = npt.NDArray[np.float64]

__version__: str

def scene(
    links: list[tuple[float, float, float, float]], gravity: float, effects: list[tuple[str, Any]]
) -> Scene: ...

class AnyScene:
    """A scene of the core; all that Python makes are `Scene`."""

class Scene(AnyScene):
    n: Final[int]
    warnings: Final[list[str]]
    def run_warnings(self, q0: Sequence[float], t0: float, t_end: float) -> list[str]: ...
    def accelerations(self, t: _Floats, q: _Floats, qd: _Floats) -> _Floats: ...
    def acceleration_of_state(
        self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike
    ) -> _Floats | None: ...
    def jacobian(self, t: _Floats, q: _Floats, qd: _Floats) -> tuple[_Floats, _Floats]: ...
    def mass_matrix(self, q: _Floats) -> _Floats: ...
    def positions(self, t: _Floats, q: _Floats) -> _Floats: ...
    def mass_centers(self, t: _Floats, q: _Floats) -> _Floats: ...
    def velocities(self, t: _Floats, q: _Floats, qd: _Floats) -> _Floats: ...
    def linearize(
        self, t: object, q: object, qd: object, inputs: tuple[int | str, ...], torques: object
    ) -> tuple[_Floats, _Floats, _Floats, _Floats] | None: ...
    def trim(self, t: float, q: Sequence[float], joints: tuple[int | str, ...]) -> _Floats: ...
    def inverse_dynamics(self, t: _Floats, q: _Floats, qd: _Floats, qdd: _Floats) -> _Floats: ...
    def reactions(self, t: _Floats, q: _Floats, qd: _Floats) -> _Floats: ...
    def energy(self, t: _Floats, q: _Floats, qd: _Floats) -> tuple[_Floats, _Floats]: ...
    def costs(self) -> list[tuple[str, int | None, float]]: ...
    def mobility(self) -> tuple[int, int, int, int]: ...

def matrix_exponential(matrix: _Floats) -> _Floats: ...

class Run:
    t: Final[_Floats]
    states: Final[_Floats]
    ledger: Final[dict[str, _Floats]]
    found: Final[list[tuple[int, float, int, _Floats, _Floats | None]]]
    t_reached: Final[float]
    y_reached: Final[_Floats]
    status: Final[str]
    message: Final[str]
    success: Final[bool]
    method: Final[str]
    last_method: Final[str]
    store: Final[str]
    statistics: Final[dict[str, Any]]
    arguments: Final[dict[str, Any]]
    def take_error(self) -> BaseException | None: ...
    fingerprint: Final[str]
    def evaluate(self, t: _Floats) -> _Floats: ...
    def ledger_at(self, t: _Floats) -> dict[str, _Floats]: ...
    step_starts: Final[_Floats]
    dense_degree: Final[int]
    def defect(self, first: int, end: int, angles: _Floats) -> tuple[_Floats, _Floats, _Floats]: ...
    def resume(
        self,
        t_end: float,
        t_eval: npt.ArrayLike | None,
        max_steps: int,
        time_limit: float | None,
        progress: Callable[[float], object] | None,
    ) -> Run: ...
    def __getstate__(self) -> dict[str, Any]: ...
    def __setstate__(self, state: dict[str, Any]) -> None: ...

def simulate(
    scene: Scene,
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike,
    t0: float,
    t_end: float,
    options: Mapping[str, Any],
    progress: Callable[[float], object] | None,
    warn: Callable[[str], object],
    watch: Watch | None = None,
) -> Run: ...

class Watch: ...

class Sensitivities(Watch):
    values: Final[_Floats]
    refusal: Final[str]
    def __init__(self, scene: Scene, names: list[str]) -> None: ...

class DefectCorrection(Watch):
    def __init__(
        self, neighbours: Sequence[tuple[Scene, npt.ArrayLike, Sequence[int]]]
    ) -> None: ...
    t: Final[_Floats]
    errors: Final[_Floats]
    errors_at_end: Final[_Floats]
    agreement: Final[tuple[float, float, float, float]]
    nfev: Final[int]

def has_defect_correction(scene: Scene) -> bool: ...
def lyapunov(
    scene: Scene,
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike,
    t0: float,
    t_end: float,
    count: int | None,
    rtol: float,
    atol: float,
    since: float,
    t_eval: npt.ArrayLike,
    max_step: float,
    max_steps: int,
    time_limit: float | None,
    progress: Callable[[float], object] | None,
    warn: Callable[[str], object],
) -> dict[str, Any]: ...
def ensemble(
    scene: Scene,
    shape: Sequence[int],
    q0: _Floats,
    qd0: _Floats,
    names: Sequence[str],
    values: Sequence[_Floats],
    t0: float,
    t_end: float,
    options: Mapping[str, Any],
    workers: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
    sensitivity_names: Sequence[str],
    status: npt.NDArray[np.uint8],
    t: _Floats,
    states: _Floats,
    first_found: _Floats | None,
    extremes: _Floats | None,
    energy_drift: _Floats | None,
    largest_exponent: _Floats | None,
    sensitivities: _Floats | None,
) -> tuple[str, dict[str, Any], BaseException | None]: ...
def methods_with_lanes(scene: Scene) -> tuple[str, ...]: ...
def parameters(scene: Scene) -> list[tuple[str, str, float]]: ...
def first_in_degrees(angles: _Floats) -> int | None: ...
def warning_of_degrees(name: str, angle: float) -> str: ...
def check_parameter_names(scene: Scene, names: Sequence[str]) -> None: ...

member_statuses: tuple[str, ...]
member_successes: tuple[bool, ...]

def effect_descriptors() -> list[dict[str, Any]]: ...
def part_descriptors() -> list[dict[str, Any]]: ...
def accounts() -> dict[str, bool]: ...
def check_effect(where: str, kind_and_values: tuple[str, Any]) -> None: ...
def check_part(where: str, name: str, values: dict[str, Any]) -> None: ...
def check_event(where: str, kind_and_values: tuple[str, dict[str, Any]]) -> None: ...
def run_options() -> list[dict[str, Any]]: ...
def methods() -> list[dict[str, Any]]: ...
def tableau(method: str) -> dict[str, Any]: ...
def nearest_double(numerator: int, denominator: int, root: int) -> float: ...
def sine_cosine(x: _Floats) -> tuple[_Floats, _Floats]: ...

compiler: str

def instruction_set() -> str: ...
