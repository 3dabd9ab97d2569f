"""What accuracy costs on a scene: methods and tolerances swept, errors and times measured."""

from __future__ import annotations

from pendcore.cost.accuracy_cost import AccuracyCost
from pendcore.cost.point import Point
from pendcore.cost.sweep import accuracy_cost

__all__ = ["AccuracyCost", "Point", "accuracy_cost"]
