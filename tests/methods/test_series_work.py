"""docs/generators/series_work.py measures the cost of a series of taylor with every kind of effect.

An effect that is added must be drawn there, or `pendcore._accuracy.method_choice.series_work` knows
nothing of it. That the forecast grows with the digits, and never falls to nothing, is counted here.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore._run.work import series_work
from pendcore._scene.effect_class import OwnEffect

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))
from series_work import EFFECTS, NOT_CARRIED, TOGETHER, scenes

KINDS = pc.effects.kinds()


def test_every_kind_of_effect_is_considered():
    own = {kind for kind, cls in KINDS.items() if issubclass(cls, OwnEffect)}
    missing = set(KINDS) - own - set(EFFECTS)
    assert not missing, (
        f"{missing}: what does a series of taylor cost beside a right-hand side with it? Add "
        "one to EFFECTS of docs/generators/series_work.py, and see by `make asked-errors` that "
        "series_work in pendcore._accuracy.method_choice.py still holds"
    )


def test_what_is_named_are_kinds_of_effects():
    assert set(EFFECTS) | NOT_CARRIED <= set(KINDS)
    assert all(effect.kind == kind for kind, effect in EFFECTS.items())


@pytest.mark.parametrize("kind", EFFECTS)
def test_it_is_measured_where_taylor_carries_it_and_only_there(kind):
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * 2, effects=[EFFECTS[kind]])
    assert (kind in TOGETHER) != (kind in NOT_CARRIED)
    if kind in TOGETHER:
        assert pc.simulate(scene, q0=[0.7, 0.8], t_span=(0, 0.1), method="taylor").success
    else:
        with pytest.raises(ValueError, match="taylor"):
            pc.simulate(scene, q0=[0.7, 0.8], t_span=(0, 0.1), method="taylor")


def test_more_digits_take_longer_series():
    for name, scene in scenes():
        works = [series_work(scene, rtol) for rtol in (1e-2, 1e-6, 1e-10, 1e-14)]
        assert works == sorted(set(works)), name
        assert works[0] > 1, name


@pytest.mark.parametrize(
    ("name", "scene"), [x for x in scenes() if 3 <= len(x[1].links) <= 4], ids=str
)
def test_the_series_of_few_links_is_forecast_where_it_is(name, scene):
    """A rotor between links, though it weighs nothing, calls for the series of any chain."""

    def last_state(effects):
        start = ((0, 1), 0.5)
        return pc.simulate(scene.replace(effects=effects), *start, method="taylor").y[:, -1]

    weightless = pc.effects.RotorInertia(joint=2, armature=0.0)
    of_any_chain = last_state([*scene.effects, weightless])
    has_it = not np.array_equal(last_state(scene.effects), of_any_chain)
    assert (series_work(scene, 1e-3) < 10) == has_it, name
