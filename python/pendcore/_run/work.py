"""What series and corrections of the error cost, in right-hand sides of dop853."""

from __future__ import annotations

from pendcore._scene.scene import Scene


def series_work(scene: Scene, rtol: float) -> float:
    """Return how many right-hand sides take as long as the series of one step of ``taylor``.

    The order of the series, and so its work, grows with the digits asked for. The ratio is large
    where the right-hand side has a closed form and the series has none.
    docs/generators/series_work.py measures it for every kind of effect.
    """
    n, free = len(scene.links), scene._compiled.mobility()[-1]
    moving, waves = _is_driven(scene), _waves(scene)
    is_simple = not (moving or waves > 2 or free < n)  # others take the series of longer chains
    if n == 1:  # the sines of the time are most of a right-hand side
        base, exponent = (14.2, 0.035) if moving or waves else (26.0, 0.036)
    elif n == 2:
        base, exponent = (11.5, 0.024) if is_simple else (20.0, 0.037)
    elif n <= 4 and is_simple and not _may_hold_or_couple(scene):
        base, exponent = 6.0, 0.030  # the series of few links
    else:
        base, exponent = 12.2, 0.040
    if free < n:
        base *= 1.5
    return float(base * (1e-3 / rtol) ** exponent)


def correction_work(scene: Scene) -> float:
    """Return how many right-hand sides take as long as one in a correction of the error.

    The dense output at its point and the sums that belong to it are counted
    (`pendcore._accuracy.defect_correction`). They weigh most where the right-hand side has a closed
    form and no sine of the time. docs/generators/series_work.py measures it for every effect.
    """
    if len(scene.links) > 2:
        return 1.3
    return 1.4 if _is_driven(scene) or _waves(scene) else 1.8


def _is_driven(scene: Scene) -> bool:
    return any(effect.description.moves_pivot for effect in scene.effects)


def _waves(scene: Scene) -> int:
    return sum(getattr(effect, "sinusoid", None) is not None for effect in scene.effects)


def _may_hold_or_couple(scene: Scene) -> bool:
    """Whether a joint may be held, or a rotor couples two links."""
    return any(
        effect.description.jumps_or_sticks
        or (effect.kind == "rotor_inertia" and getattr(effect, "joint", 1) > 1)
        for effect in scene.effects
    )
