"""Impacts in fifty digits: kinetic energy does not grow, and the ledger books what was lost.

The rates that a run stores are doubles. Rounding them changes the kinetic energy by up to
eps sum |p_i qd_i|, with p the momenta of the links. In chains of light and heavy links this sum is
larger than the energy, and no run can do better.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from mpmath import mp, mpf  # type: ignore[import-untyped]
from pendcore import effects as fx

EPS = float(np.finfo(float).eps)
Rates = Any


def momenta(scene: pc.Scene, q: Rates, qd: Rates) -> list[Any]:
    """Return M qd, from the velocities of the mass centres and back."""
    vx = vy = mpf(0)
    own, n = [], len(scene.links)
    for link, a, w in zip(scene.links, q, qd, strict=True):
        nx, ny = -mp.sin(mpf(float(a))), mp.cos(mpf(float(a)))
        c, length, w = mpf(link.center), mpf(link.length), mpf(float(w))
        own.append((nx, ny, mpf(link.mass) * (vx + c * w * nx), mpf(link.mass) * (vy + c * w * ny)))
        vx, vy = vx + length * w * nx, vy + length * w * ny
    px = py = mpf(0)
    for e in scene.effects:
        if isinstance(e, fx.Payload):
            px, py = px + mpf(e.mass) * vx, py + mpf(e.mass) * vy
    p = [mpf(0)] * n
    for i in reversed(range(n)):
        link, (nx, ny, mx, my) = scene.links[i], own[i]
        c, length = mpf(link.center), mpf(link.length)
        p[i] += nx * (c * mx + length * px) + ny * (c * my + length * py)
        p[i] += mpf(link.inertia) * mpf(float(qd[i]))
        px, py = px + mx, py + my
    for e in scene.effects:
        if isinstance(e, fx.RotorInertia):
            j = e.joint - 1
            turned = mpf(e.armature) * (mpf(float(qd[j])) - (mpf(float(qd[j - 1])) if j else 0))
            p[j] += turned
            if j:
                p[j - 1] -= turned
    return p


def energy(scene: pc.Scene, q: Rates, qd: Rates) -> tuple[Any, float]:
    """Return the kinetic energy, and how much rounding the rates may change it."""
    with mp.workdps(50):
        terms = [p * mpf(float(w)) for p, w in zip(momenta(scene, q, qd), qd, strict=True)]
        return sum(terms) / 2, EPS * float(sum(map(abs, terms)))


def check_impact(scene: pc.Scene, q: Rates, before: Rates, after: Rates, booked: float) -> None:
    (t_before, rounding_before), (t_after, rounding_after) = (
        energy(scene, q, qd) for qd in (before, after)
    )
    rounding = 4 * len(q) * (rounding_before + rounding_after)
    change = float(t_after - t_before)
    assert change <= rounding
    assert abs(change + booked) <= rounding + EPS * abs(booked)


def chain(n: int, seed: int, *, locked: bool) -> tuple[pc.Scene, Any, Any]:
    """Links of 1e-8 to 1 kg, all at stops of any restitution, and rates into and out of them."""
    random = np.random.default_rng([n, seed])
    links = []
    for _ in range(n):
        mass, length = 10.0 ** random.uniform(-8, 0), random.uniform(0.1, 1.2)
        center = random.choice([0.5, 1.0, random.uniform(-0.1, 1)]) * length
        inertia = mass * length**2 * random.choice([1 / 12, 0.01, 1e-4])
        links.append(pc.Link(mass=mass, length=length, center=center, inertia=inertia))
    phi, phid = random.uniform(-2.5, 2.5, n), random.uniform(-10, 10, n)
    q = np.cumsum(phi)
    relative = q - np.append(0.0, q[:-1])
    effects: list[Any] = []
    for j in range(n):
        kind = random.integers(6)
        if kind == 0 and locked:
            phid[j] = 0.0
            effects.append(fx.Lock(joint=j + 1))
        elif kind < 5:
            ends = (-np.inf, relative[j]) if phid[j] > 0 else (relative[j], np.inf)
            e = float(random.choice([1.0, 1.0, random.uniform(0, 1), 0.0]))
            effects.append(fx.JointStop(joint=j + 1, range=ends, restitution=e))
    if random.integers(2):
        effects.append(fx.Payload(mass=float(10 ** random.uniform(-3, 0.5))))
    if random.integers(2):
        effects.append(fx.RotorInertia(joint=n, armature=float(10 ** random.uniform(-6, -1))))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(links=links, gravity=9.81, effects=effects), q, np.cumsum(phid)


@pytest.mark.whole
@pytest.mark.parametrize("locked", [False, True])
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_impacts_of_light_links_add_no_energy(n: int, locked: bool) -> None:
    impacts = 0
    for seed in range(40):
        scene, q, qd = chain(n, seed, locked=locked)
        sol = pc.simulate(scene, q0=q, qd0=qd, t_span=(0, 1e-9), ledger=True, max_steps=2000)
        if len(sol.t) < 2 or sol.t[1] != 0.0:
            continue  # no joint moves into its stop
        booked = sol.energy().ledger.impact
        check_impact(scene, sol.q[0], sol.qd[0], sol.qd[1], float(booked[1] - booked[0]))
        impacts += 1
    assert impacts > 15


LIGHT = [
    (0.004153867995145253, 0.1540605035852616, 0.0770302517926308, 9.972185831214259e-08),
    (0.0017836104437221416, 0.781798133737217, 0.781798133737217, 4.046137348234437e-06),
    (0.8572833361555214, 0.8739487255936321, 0.8739487255936321, 0.1908212002770477),
    (1.9706102896914783, 1.0551158274772479, 0.3131691735876163, 0.3089022972760414),
    (0.008573711557304875, 0.36574615200077115, -0.02129176133770479, 0.0002991960656077291),
]


def test_links_of_grams_under_links_of_kilograms_bounce_without_gaining_energy() -> None:
    """The condition of M is 1.5e4; 1.8e-8 J of 123 J came from nowhere."""
    effects = [
        fx.JointStop(
            joint=1, range=(1.1896105221836761, 1.733729180362782), restitution=0.8561857708925686
        ),
        fx.DryJointFriction(joint=1, coulomb=0.01268716898686413),
        fx.JointStop(joint=2, range=(0.0, 0.11620058999823993), restitution=0.9500191914089275),
        fx.JointStop(joint=3, range=(-0.04247839887157079, 0.5861685774576292), restitution=1.0),
        fx.DryJointFriction(joint=3, coulomb=1.597522864070949),
        fx.JointStop(joint=4, range=(-0.46578557888684347, 0.7732057781880676), restitution=1.0),
        fx.JointStop(joint=5, range=(0.0, 0.6168923916223623), restitution=1.0),
    ]
    links = [pc.Link(mass=m, length=length, center=c, inertia=i) for m, length, c, i in LIGHT]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        scene = pc.Scene(links=links, gravity=9.807, effects=effects)
    q = [1.1896105221836761, 1.305811112181916, 1.7884018699391542, 2.5616076481272216, 3.17850003]
    qd = [1.512648075168805, -2.7298521238442603, -7.468426526689257, -14.67869747, -10.9402457]
    sol = pc.simulate(scene, q0=q, qd0=qd, t_span=(0, 0.2), ledger=True, max_steps=100_000)
    booked = sol.energy().ledger.impact
    rows = np.flatnonzero(np.diff(sol.t) == 0)
    assert len(rows) > 5
    for k in rows:
        check_impact(scene, sol.q[k], sol.qd[k], sol.qd[k + 1], float(booked[k + 1] - booked[k]))
        before, after = (float(energy(scene, sol.q[k], w)[0]) for w in sol.qd[k : k + 2])
        assert after <= before * (1 + 1e-13)
