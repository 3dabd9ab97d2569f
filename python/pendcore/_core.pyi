"""The compiled core: scenes, runs and methods as numbers and arrays, for the package alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

__version__: str

class Scene:
    def __init__(
        self,
        links: list[tuple[float, float, float, float]],
        gravity: float,
        effects: list[tuple[str, Any]],
    ) -> None: ...
    @property
    def n(self) -> int: ...
    @property
    def warnings(self) -> list[str]: ...
    def run_warnings(self, q0: Sequence[float], t0: float, t_end: float) -> list[str]: ...
    def accelerations(
        self,
        t: npt.NDArray[np.float64],
        q: npt.NDArray[np.float64],
        qd: npt.NDArray[np.float64],
    ) -> npt.NDArray[np.float64]: ...
    def acceleration_of_state(
        self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike
    ) -> npt.NDArray[np.float64] | None: ...
    def jacobian(
        self,
        t: npt.NDArray[np.float64],
        q: npt.NDArray[np.float64],
        qd: npt.NDArray[np.float64],
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
    def mass_matrix(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]: ...
    def positions(
        self, t: npt.NDArray[np.float64], q: npt.NDArray[np.float64]
    ) -> npt.NDArray[np.float64]: ...
    def mass_centers(
        self, t: npt.NDArray[np.float64], q: npt.NDArray[np.float64]
    ) -> npt.NDArray[np.float64]: ...
    def reactions(
        self,
        t: npt.NDArray[np.float64],
        q: npt.NDArray[np.float64],
        qd: npt.NDArray[np.float64],
    ) -> npt.NDArray[np.float64]: ...
    def energy(
        self,
        t: npt.NDArray[np.float64],
        q: npt.NDArray[np.float64],
        qd: npt.NDArray[np.float64],
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
    def costs(self) -> list[tuple[str, int | None, float]]: ...
    def mobility(self) -> tuple[int, int, int, int]: ...

class Run:
    @property
    def t(self) -> npt.NDArray[np.float64]: ...
    @property
    def states(self) -> npt.NDArray[np.float64]: ...
    @property
    def ledger(self) -> dict[str, npt.NDArray[np.float64]]: ...
    @property
    def found(
        self,
    ) -> list[tuple[int, float, int, npt.NDArray[np.float64], npt.NDArray[np.float64] | None]]: ...
    @property
    def t_reached(self) -> float: ...
    @property
    def y_reached(self) -> npt.NDArray[np.float64]: ...
    @property
    def status(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def success(self) -> bool: ...
    @property
    def method(self) -> str: ...
    @property
    def last_method(self) -> str: ...
    @property
    def store(self) -> str: ...
    @property
    def statistics(self) -> dict[str, Any]: ...
    @property
    def arguments(self) -> dict[str, Any]: ...
    @property
    def error(self) -> BaseException | None: ...
    @property
    def fingerprint(self) -> str: ...
    def evaluate(self, t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]: ...
    @property
    def step_starts(self) -> npt.NDArray[np.float64]: ...
    @property
    def dense_degree(self) -> int: ...
    def defect(
        self, first: int, end: int, angles: npt.NDArray[np.float64]
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
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
) -> Run: ...
def lyapunov(
    scene: Scene,
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike,
    t0: float,
    t_end: float,
    count: int | None,
    rtol: float,
    atol: float,
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
    q0: npt.NDArray[np.float64],
    qd0: npt.NDArray[np.float64],
    names: Sequence[str],
    values: Sequence[npt.NDArray[np.float64]],
    t0: float,
    t_end: float,
    options: Mapping[str, Any],
    workers: int,
    time_limit: float,
    progress: Callable[[float], object] | None,
    status: npt.NDArray[np.uint8],
    t: npt.NDArray[np.float64],
    states: npt.NDArray[np.float64],
    first_found: npt.NDArray[np.float64] | None,
    extremes: npt.NDArray[np.float64] | None,
    energy_drift: npt.NDArray[np.float64] | None,
    largest_exponent: npt.NDArray[np.float64] | None,
) -> tuple[str, dict[str, Any], BaseException | None]: ...
def methods_with_lanes(scene: Scene) -> tuple[str, ...]: ...
def parameters(scene: Scene) -> list[tuple[str, str, float]]: ...
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
def sine_cosine(
    x: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...

compiler: str

def instruction_set() -> str: ...
