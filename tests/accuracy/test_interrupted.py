"""An interrupt within a user's law hands over what was found, and no run that nobody asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest


@pytest.fixture(autouse=True)
def no_figure_left_over() -> Iterator[None]:
    yield
    plt.close("all")


class Law:
    """A law that does nothing, and is interrupted after so many more calls."""

    left = np.inf

    def __call__(self, t: float, q: Any, qd: Any) -> Any:
        self.left -= 1
        if self.left < 0:
            raise KeyboardInterrupt
        return 0 * q


def scene_of(law: Law) -> pc.Scene:
    return pc.Scene.textbook().replace(effects=[pc.effects.User(law)])


MEASURES: dict[str, tuple[Callable[..., Any], float, str, Callable[[Any], int]]] = {
    "accuracy_cost": (pc.accuracy_cost, 2000, "accuracy_cost", len),
    "horizon_work": (pc.horizon_work, 3000, "work", lambda found: len(found.points)),
}


@pytest.mark.parametrize("name", MEASURES)
def test_a_measurement_hands_over_itself_alone(name: str) -> None:
    measure, calls, attribute, count = MEASURES[name]
    law = Law()
    law.left = calls
    with pytest.raises(KeyboardInterrupt) as caught:
        measure(scene_of(law), (0, 10), [-1.2, -0.6])
    assert [*vars(caught.value)] == [attribute]
    assert count(getattr(caught.value, attribute)) == 0


ASKED: dict[str, Callable[[pc.Solution], Any]] = {
    "estimate_error": lambda run: run.estimate_error(),
    "valid_until": lambda run: run.valid_until(0.1),
    "plot": lambda run: run.plot(horizon=0.1),
}


@pytest.mark.parametrize("calls", [3, 500], ids=["at once", "within a second run"])
@pytest.mark.parametrize("name", ASKED)
def test_what_is_asked_of_a_run_hands_over_that_run(name: str, calls: float) -> None:
    law = Law()
    run = pc.simulate(scene_of(law), q0=[1.0, 1.0], t_span=(0, 2))
    law.left = calls
    with pytest.raises(KeyboardInterrupt) as caught:
        ASKED[name](run)
    assert caught.value.solution is run  # type: ignore[attr-defined]
