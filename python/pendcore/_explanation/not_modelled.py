"""What a scene does not simulate: effects that it does not have, and physics without an effect."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from pendcore._scene.effect_class import OwnEffect
from pendcore._scene.scene import Scene
from pendcore.effects import KINDS

NOT_MODELLED = {
    "bending": "Bending of the links: they are rigid.",
    "play": "Play in the joints: they are perfect hinges.",
    "third_dimension": "Motion out of the plane.",
}
"""Physics that no effect models yet."""


class Absence(NamedTuple):
    """Something that is not simulated.

    Attributes
    ----------
    kind : str
        The kind of an effect that the scene could have, or a word for physics without an effect.
    sentence : str
        What would be simulated.
    available : bool
        Whether there is such an effect.
    """

    kind: str
    sentence: str
    available: bool


def absent(scene: Scene) -> Iterator[Absence]:
    """Tell what a scene does not simulate."""
    present = {effect.kind for effect in scene.effects}
    for kind, cls in KINDS.items():
        if kind not in present and not issubclass(cls, OwnEffect):
            yield Absence(kind, cls.description.sentence, True)
    for word, sentence in NOT_MODELLED.items():
        if word not in KINDS:
            yield Absence(word, sentence, False)
