"""Chains whose joints strike their stops in turn, ever faster, in many digits.

`python tests/models/corner_impacts.py` computes anew what tests/data/corner_impacts.json holds,
from its starts, event by event (reference/stopped_rods.py). With `--scan 200` it draws two hundred
scenes and prints which of them the core ends elsewhere, and how far.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
from pendcore import effects as fx
from reference.many_digit_contacts import Stop
from reference.stopped_rods import StoppedRods
from reference.taylor_series import RodChain
from tqdm import tqdm

DATA = Path(__file__).parents[1] / "data/corner_impacts.json"
GRAVITY = 9.807
TIMES = (0.5, 1.0, 1.5, 2.0)
DIGITS = (60, 90)
"""Each case is computed twice; the difference is the accuracy of the record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerCase:
    """Rods with two stops in some joints, where they begin, and what becomes of them."""

    seed: int
    masses: list[float]
    lengths: list[float]
    stops: list[list[Any]]
    """Joint (from 0), its lower and its upper end, restitution, capture speed."""
    q0: list[float]
    qd0: list[float]
    q: list[list[float]]
    """Angles at TIMES, rad."""
    disagreement: float = 0.0
    impacts: int = 0

    @property
    def scene(self) -> pc.Scene:
        found = [
            fx.JointStop(joint=joint + 1, range=(low, high), restitution=e, capture_speed=slow)
            for joint, low, high, e, slow in self.stops
        ]
        links = [pc.Link(mass=m, length=x) for m, x in zip(self.masses, self.lengths, strict=True)]
        return pc.Scene(links=links, gravity=GRAVITY, effects=found)

    def simulate(self, start: float = 0.0, **options: Any) -> pc.Solution:
        """Run the core from that time on: nothing here depends on it."""
        ends = (start, start + TIMES[-1])
        return pc.simulate(
            self.scene, q0=self.q0, qd0=self.qd0, t_span=ends, max_steps=100_000, **options
        )

    def off(self, sol: pc.Solution, start: float = 0.0) -> float:
        """How far the core is from the record, at worst, rad."""
        angles = sol(start + np.array(TIMES))[: len(self.masses)].T
        return float(np.abs(angles - np.array(self.q)).max())

    def rods(self, digits: int) -> StoppedRods:
        stops = [
            Stop(joint, at, side, e, slow)
            for joint, low, high, e, slow in self.stops
            for at, side in ((low, -1), (high, 1))
        ]
        chain = RodChain(self.masses, self.lengths, GRAVITY)
        return StoppedRods(chain=chain, stops=stops, digits=digits)

    def computed(self, digits: Sequence[int] = DIGITS) -> CornerCase:
        n, answers, impacts = len(self.masses), [], 0
        for precision in digits:
            rods = self.rods(precision)
            answers.append([row[:n] for row in rods.run(self.q0, self.qd0, TIMES)])
            impacts = rods.impacts
        apart = float(np.abs(np.array(answers[-1]) - np.array(answers[0])).max())
        made = {**asdict(self), "q": answers[-1], "disagreement": apart, "impacts": impacts}
        return CornerCase(**made)


def drawn(seed: int) -> CornerCase:
    """Two or three rods; nine in ten joints have stops, some of them reached at once."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 4))
    masses, lengths = random.uniform(0.3, 3, n), random.uniform(0.3, 1.5, n)
    phi = random.uniform(-1, 1, n)
    if random.random() < 0.5:
        phi[0] = random.uniform(0.3, 2.8)
    stops: list[list[Any]] = []
    for j in range(n):
        if random.random() >= 0.9:
            continue
        low, high = phi[j] - random.uniform(0, 0.6), phi[j] + random.uniform(0.02, 0.6)
        e = random.choice([0, 0.3, 0.6, 0.9, random.uniform(0, 1)])
        beyond = masses[j + 1 :].sum()
        moment = (masses[j] / 2 + beyond) * lengths[j] * GRAVITY
        inertia = (masses[j] / 3 + beyond) * lengths[j] ** 2
        slow = 1e-9 * np.sqrt(moment / inertia)  # as if it were left out
        stops.append([j, float(low), float(high), float(e), float(slow)])
    rates = random.uniform(-4, 4, n) * random.integers(2)
    return CornerCase(
        seed=seed, masses=masses.tolist(), lengths=lengths.tolist(), stops=stops,
        q0=np.cumsum(phi).tolist(), qd0=np.cumsum(rates).tolist(), q=[],
    )  # fmt: skip


@cache
def corner_cases() -> list[CornerCase]:
    """Read them."""
    return [CornerCase(**case) for case in json.loads(DATA.read_text(encoding="utf-8"))]


def record() -> None:
    """Compute all anew, from the starts that stand in the file."""
    cases = [case.computed() for case in tqdm(corner_cases())]
    rows = ",\n".join(json.dumps(asdict(case)) for case in cases)
    DATA.write_text(f"[\n{rows}\n]\n", encoding="utf-8")


def scan(count: int, digits: int = 40) -> None:
    """Print the scenes whose end is more than 1e-9 rad off in the core."""
    apart = []
    for seed in tqdm(range(count)):
        case = drawn(seed).computed([digits])
        sol = case.simulate(rtol=1e-13, atol=1e-15)
        apart.append(case.off(sol))
        if not apart[-1] <= 1e-9:
            tqdm.write(f"{seed}: {apart[-1]:.1e} rad, {case.impacts} impacts; {sol.message}")
    print(f"median {np.median(apart):.1e} rad; {sum(x > 1e-6 for x in apart)} above 1e-6 rad")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scan", type=int, metavar="COUNT")
    count = parser.parse_args().scan
    if count is None:
        record()
    else:
        scan(count)
