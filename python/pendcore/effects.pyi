"""What acts on a chain besides gravity: a class for each effect that the core has.

Written by docs/generators/write_effects.py from what the core says of each effect.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Final, Literal

import numpy.typing as npt

from pendcore._scene.effect_class import Effect as Effect
from pendcore._scene.effect_class import OwnEffect, PythonEffect
from pendcore._scene.effect_class import Part as Part

def kinds() -> dict[str, type[Effect]]:
    """Return the class of every kind of effect, the kind as in case files."""

def parts() -> dict[str, type[Part]]:
    """Return the class of every part of an effect, such as the sinusoid of a motor, by its name."""

class Sinusoid(Part):
    """amplitude sin(angular_frequency t + phase); the amplitude has the unit of what it drives."""

    __match_args__: Final = ("amplitude", "angular_frequency", "phase")
    def __init__(self, amplitude: float, angular_frequency: float, phase: float = ...) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        amplitude: float = ...,
        angular_frequency: float = ...,
        phase: float = ...,
    ) -> Sinusoid: ...
    @property
    def amplitude(self) -> float: ...
    @property
    def angular_frequency(self) -> float: ...
    @property
    def phase(self) -> float: ...

class Table(Part):
    """Torque at given times, linear between them or held; the run ends where the table ends."""

    __match_args__: Final = ("t", "torque", "hold")
    def __init__(self, t: npt.ArrayLike, torque: npt.ArrayLike, hold: bool = ...) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        t: npt.ArrayLike = ...,
        torque: npt.ArrayLike = ...,
        hold: bool = ...,
    ) -> Table: ...
    @property
    def t(self) -> tuple[float, ...]: ...
    @property
    def torque(self) -> tuple[float, ...]: ...
    @property
    def hold(self) -> bool: ...

class PD(Part):
    """A controller that holds the joint at an angle: kp (reference - phi) - kd w."""

    __match_args__: Final = ("kp", "kd", "reference")
    def __init__(self, kp: float, kd: float, reference: float) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        kp: float = ...,
        kd: float = ...,
        reference: float = ...,
    ) -> PD: ...
    @property
    def kp(self) -> float: ...
    @property
    def kd(self) -> float: ...
    @property
    def reference(self) -> float: ...

class Spline(Part):
    """Natural cubic splines x(t) and y(t) through given points; the run ends where they end."""

    __match_args__: Final = ("t", "x", "y")
    def __init__(self, t: npt.ArrayLike, x: npt.ArrayLike, y: npt.ArrayLike) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        t: npt.ArrayLike = ...,
        x: npt.ArrayLike = ...,
        y: npt.ArrayLike = ...,
    ) -> Spline: ...
    @property
    def t(self) -> tuple[float, ...]: ...
    @property
    def x(self) -> tuple[float, ...]: ...
    @property
    def y(self) -> tuple[float, ...]: ...

class ViscousJoint(Effect):
    """Viscous damping in a joint, with a linear, a quadratic and a cubic term."""

    kind: ClassVar[Literal["viscous_joint"]]
    __match_args__: Final = ("joint", "damping", "damping2", "damping3")
    def __init__(
        self,
        joint: int,
        damping: float,
        damping2: float = ...,
        damping3: float = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        damping: float = ...,
        damping2: float = ...,
        damping3: float = ...,
    ) -> ViscousJoint: ...
    @property
    def joint(self) -> int: ...
    @property
    def damping(self) -> float: ...
    @property
    def damping2(self) -> float: ...
    @property
    def damping3(self) -> float: ...

class DryJointFriction(Effect):
    """Dry friction in a joint, Coulomb's with a static peak (Stribeck)."""

    kind: ClassVar[Literal["dry_joint_friction"]]
    __match_args__: Final = ("joint", "coulomb", "static", "stribeck_velocity", "exponent")
    def __init__(
        self,
        joint: int,
        coulomb: float,
        static: float | None = ...,
        stribeck_velocity: float = ...,
        exponent: float = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        coulomb: float = ...,
        static: float | None = ...,
        stribeck_velocity: float = ...,
        exponent: float = ...,
    ) -> DryJointFriction: ...
    @property
    def joint(self) -> int: ...
    @property
    def coulomb(self) -> float: ...
    @property
    def static(self) -> float | None: ...
    @property
    def stribeck_velocity(self) -> float: ...
    @property
    def exponent(self) -> float: ...

class RodDrag(Effect):
    """Air drag on a link, along the whole rod, quadratic in the speed across it."""

    kind: ClassVar[Literal["rod_drag"]]
    __match_args__: Final = ("link", "drag_coefficient", "diameter", "air_density", "wind")
    def __init__(
        self,
        link: int,
        drag_coefficient: float,
        diameter: float,
        air_density: float = ...,
        wind: npt.ArrayLike = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        link: int = ...,
        drag_coefficient: float = ...,
        diameter: float = ...,
        air_density: float = ...,
        wind: npt.ArrayLike = ...,
    ) -> RodDrag: ...
    @property
    def link(self) -> int: ...
    @property
    def drag_coefficient(self) -> float: ...
    @property
    def diameter(self) -> float: ...
    @property
    def air_density(self) -> float: ...
    @property
    def wind(self) -> tuple[float, float]: ...

class TorsionalSpring(Effect):
    """A linear torsional spring in a joint."""

    kind: ClassVar[Literal["torsional_spring"]]
    __match_args__: Final = ("joint", "stiffness", "rest_angle")
    def __init__(self, joint: int, stiffness: float, rest_angle: float = ...) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        stiffness: float = ...,
        rest_angle: float = ...,
    ) -> TorsionalSpring: ...
    @property
    def joint(self) -> int: ...
    @property
    def stiffness(self) -> float: ...
    @property
    def rest_angle(self) -> float: ...

class Motor(Effect):
    """A motor in a joint: constant torque, sinusoid, table or PD controller."""

    kind: ClassVar[Literal["motor"]]
    __match_args__: Final = ("joint", "constant", "sinusoid", "table", "pd", "limit")
    def __init__(
        self,
        joint: int,
        constant: float | None = ...,
        sinusoid: Sinusoid | None = ...,
        table: Table | None = ...,
        pd: PD | None = ...,
        limit: float = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        constant: float | None = ...,
        sinusoid: Sinusoid | None = ...,
        table: Table | None = ...,
        pd: PD | None = ...,
        limit: float = ...,
    ) -> Motor: ...
    @property
    def joint(self) -> int: ...
    @property
    def constant(self) -> float | None: ...
    @property
    def sinusoid(self) -> Sinusoid | None: ...
    @property
    def table(self) -> Table | None: ...
    @property
    def pd(self) -> PD | None: ...
    @property
    def limit(self) -> float: ...

class RotorInertia(Effect):
    """The inertia of a rotor that turns with a joint."""

    kind: ClassVar[Literal["rotor_inertia"]]
    __match_args__: Final = ("joint", "armature")
    def __init__(self, joint: int, armature: float) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        armature: float = ...,
    ) -> RotorInertia: ...
    @property
    def joint(self) -> int: ...
    @property
    def armature(self) -> float: ...

class Payload(Effect):
    """A rigid body at the tip, fixed to the last link."""

    kind: ClassVar[Literal["payload"]]
    __match_args__: Final = ("mass", "inertia")
    def __init__(self, mass: float, inertia: float = ...) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        mass: float = ...,
        inertia: float = ...,
    ) -> Payload: ...
    @property
    def mass(self) -> float: ...
    @property
    def inertia(self) -> float: ...

class Lock(Effect):
    """A joint locked at an angle: one degree of freedom less. It may join massless links."""

    kind: ClassVar[Literal["lock"]]
    __match_args__: Final = ("joint", "angle")
    def __init__(self, joint: int, angle: float | None = ...) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        angle: float | None = ...,
    ) -> Lock: ...
    @property
    def joint(self) -> int: ...
    @property
    def angle(self) -> float | None: ...

class JointStop(Effect):
    """Stops at the ends of the range of a joint, with restitution."""

    kind: ClassVar[Literal["joint_stop"]]
    __match_args__: Final = ("joint", "range", "restitution", "capture_speed")
    def __init__(
        self,
        joint: int,
        range: npt.ArrayLike,
        restitution: float = ...,
        capture_speed: float | None = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        joint: int = ...,
        range: npt.ArrayLike = ...,
        restitution: float = ...,
        capture_speed: float | None = ...,
    ) -> JointStop: ...
    @property
    def joint(self) -> int: ...
    @property
    def range(self) -> tuple[float, float]: ...
    @property
    def restitution(self) -> float: ...
    @property
    def capture_speed(self) -> float | None: ...

class DrivenPivot(Effect):
    """A pivot that is moved: a sinusoid for each axis, or a spline."""

    kind: ClassVar[Literal["driven_pivot"]]
    __match_args__: Final = ("x", "y", "spline")
    def __init__(
        self,
        x: Sinusoid | None = ...,
        y: Sinusoid | None = ...,
        spline: Spline | None = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        x: Sinusoid | None = ...,
        y: Sinusoid | None = ...,
        spline: Spline | None = ...,
    ) -> DrivenPivot: ...
    @property
    def x(self) -> Sinusoid | None: ...
    @property
    def y(self) -> Sinusoid | None: ...
    @property
    def spline(self) -> Spline | None: ...

class CompiledUser(OwnEffect):
    """An effect of the user's own, as a compiled function of t, q and qd."""

    kind: ClassVar[Literal["compiled_user"]]
    __match_args__: Final = ("address", "data", "breaks")
    def __init__(self, address: Any, data: Any = ..., breaks: npt.ArrayLike = ...) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        address: Any = ...,
        data: Any = ...,
        breaks: npt.ArrayLike = ...,
    ) -> CompiledUser: ...
    @property
    def address(self) -> int: ...
    @property
    def data(self) -> int: ...
    @property
    def breaks(self) -> tuple[float, ...]: ...

class User(PythonEffect):
    """An effect of the user's own, as a Python function of t, q and qd."""

    kind: ClassVar[Literal["user"]]
    __match_args__: Final = ("function", "breaks")
    def __init__(
        self,
        function: Callable[..., npt.ArrayLike],
        breaks: npt.ArrayLike = ...,
    ) -> None: ...
    def replace(  # type: ignore[override]
        self,
        *,
        function: Callable[..., npt.ArrayLike] = ...,
        breaks: npt.ArrayLike = ...,
    ) -> User: ...
    @property
    def breaks(self) -> tuple[float, ...]: ...
