"""The constants of a chain in exact fractions, from the doubles of its scene.

In absolute angles q, with the links' and the payload's bodies summed over,

    M_ij = K_ij cos(q_i - q_j),   K_ij = sum_bodies m arm_i arm_j (+ I_i where i = j),
    static moment of link i:  h_i = sum_bodies m arm_i,

where arm_i is the distance along link i at which a body hangs: the whole length of link i for the
bodies beyond it.
"""

from __future__ import annotations

from fractions import Fraction

import pendcore as pc

Parameters = dict[str, Fraction]
"""The parameters of a compiled system, by the names that `equations` gives."""


def inertia(scene: pc.Scene) -> Parameters:
    """Return K_ij, h_i, gravity and the inertia of rotors, J_j."""
    n = len(scene.links)
    zero = Fraction(0)
    lengths = [Fraction(link.length) for link in scene.links]
    bodies = [
        (
            Fraction(link.mass),
            [*lengths[:k], Fraction(link.center), *[zero] * (n - k - 1)],
        )
        for k, link in enumerate(scene.links)
    ]
    about_center = [Fraction(link.inertia) for link in scene.links]
    values = {f"J{j}": zero for j in range(n)}
    for effect in scene.effects:
        if effect.kind == "payload":
            bodies.append((Fraction(effect.mass), lengths))
            about_center[-1] += Fraction(effect.inertia)
        elif effect.kind == "rotor_inertia":
            values[f"J{effect.joint - 1}"] += Fraction(effect.armature)
    for i in range(n):
        for j in range(i, n):
            values[f"K{i}{j}"] = sum((m * arm[i] * arm[j] for m, arm in bodies), zero)
        values[f"K{i}{i}"] += about_center[i]
        values[f"h{i}"] = sum((m * arm[i] for m, arm in bodies), zero)
    values["g"] = Fraction(scene.gravity)
    return values


def smooth_torques(scene: pc.Scene) -> Parameters:
    """Return the parameters of all that acts without a kink: see `equations` for their names."""
    n = len(scene.links)
    values = dict.fromkeys(
        [f"{name}{j}" for j in range(n) for name in ("c", "k", "b", "b3", "A", "o", "p")]
        + [axis + name for axis in "xy" for name in ("A", "o", "p")],
        Fraction(0),
    )

    def add(name: str, value: Fraction) -> None:
        values[name] += value

    def drive(amplitude: str, where: str, sinusoid: pc.effects.Sinusoid, factor: Fraction) -> None:
        if values[amplitude]:
            raise NotImplementedError(f"two sinusoids at {where}: one is all that is compiled")
        values[amplitude] = factor * Fraction(sinusoid.amplitude)
        values[where + "o" if where in "xy" else "o" + where] = Fraction(sinusoid.angular_frequency)
        values[where + "p" if where in "xy" else "p" + where] = Fraction(sinusoid.phase)

    for effect in scene.effects:
        j = str(effect.joint - 1) if hasattr(effect, "joint") else ""
        if effect.kind == "viscous_joint":
            add("b" + j, Fraction(effect.damping))
            add("b3" + j, Fraction(effect.damping3))
        elif effect.kind == "torsional_spring":
            add("k" + j, Fraction(effect.stiffness))
            add("c" + j, Fraction(effect.stiffness) * Fraction(effect.rest_angle))
        elif effect.kind == "motor":
            if effect.constant is not None:
                add("c" + j, Fraction(effect.constant))
            if effect.sinusoid is not None:
                drive("A" + j, j, effect.sinusoid, Fraction(1))
            if effect.pd is not None and effect.limit == float("inf"):
                add("k" + j, Fraction(effect.pd.kp))
                add("b" + j, Fraction(effect.pd.kd))
                add("c" + j, Fraction(effect.pd.kp) * Fraction(effect.pd.reference))
        elif effect.kind == "driven_pivot":
            for axis in "xy":
                if (sinusoid := getattr(effect, axis)) is not None:
                    drive(axis + "A", axis, sinusoid, -(Fraction(sinusoid.angular_frequency) ** 2))
    return values
