"""What is derived in symbols is what the compiled core computes, for any numbers.

The expressions are evaluated in forty digits: what differs is the core's rounding, or a mistake.
"""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

import mpmath
import numpy as np
import numpy.typing as npt
import pendcore as pc
import pytest
import sympy
from described_scenes import rig_of
from pendcore._scene.effect_description import effects
from pendcore.derive import Derivation
from pendcore.derive.chain import of_differences
from pendcore.derive.laws import LAWS
from reference.arithmetic import multiple_precision
from reference.rig import balance
from symbolic_scenes import (
    DIGITS,
    SETS,
    SMOOTH,
    Evaluated,
    derived,
    named_in_order,
    scene,
    states,
)

pytestmark = pytest.mark.unsanitized

TOLERANCE = 1e-13
CASES = [(name, n) for n in (1, 2, 3) for name in SETS]
SEEDS = range(1, 5)

every_chain = pytest.mark.parametrize(("name", "n"), CASES)


def assert_close(computed: npt.ArrayLike, exact: Any) -> None:
    """Compare the components, with errors relative to the largest of them."""
    exact = np.array(exact, dtype=float)
    error = np.max(np.abs(np.asarray(computed) - exact))
    assert error <= TOLERANCE * np.max(np.abs(exact)), (computed, exact)


@cache
def evaluated(name: str, n: int) -> tuple[Evaluated, Evaluated]:
    """Return the accelerations in both forms, and all that follows from them."""
    derivation = derived(name, n)
    s, holding = derivation.symbols, derivation.holding_couples
    left = (derivation.mass_matrix * sympy.Matrix(s.qdd) - derivation.forcing).as_mutable()
    for joint, couple in holding.items():  # of a lock, on both links
        left[joint - 1] -= couple
        if joint > 1:
            left[joint - 2] += couple
    both = [*derivation.accelerations, *named_in_order(derivation)]
    energies = [derivation.kinetic_energy, derivation.potential_energy]
    rest = [*sum(derivation.reactions, ()), *energies, *derivation.mass_matrix, *left]
    return Evaluated(derivation, both), Evaluated(derivation, [*rest, *derivation.forcing])


def test_every_kind_with_a_law_is_looked_at() -> None:
    assert sorted(SMOOTH) == sorted(LAWS)


@pytest.mark.few_cases
@every_chain
def test_what_is_derived_is_what_the_core_computes(name: str, n: int) -> None:
    derivation, (solved, follows) = derived(name, n), evaluated(name, n)
    assert derivation.mass_matrix == derivation.mass_matrix.T
    assert sorted(derivation.holding_couples) == sorted(derivation.equations.locked)
    for seed in SEEDS:
        drawn = scene(name, n, seed)
        for state in states(drawn, seed):
            now = pc.simulate(drawn, (state.t, state.t), state.q, state.qd, store="steps")
            forms = solved(drawn, state)
            for form in (forms[:n], forms[n:]):
                assert_close(now.accelerations()[0], form)
            found = np.array(follows(drawn, state, forms[:n]), dtype=object)
            forces, energies, mass, left, forcing = np.split(found, np.cumsum([2 * n, 2, n * n, n]))
            assert_close(now.reactions()[0].ravel(), forces)
            energy = now.energy()
            assert_close([energy.kinetic[0], energy.potential[0]], energies)
            assert_close(drawn.mass_matrix(state.q).ravel(), mass)
            size = max(1.0, *map(abs, [*left, *forcing]))
            assert all(abs(x) <= 10 ** (5 - DIGITS) * size for x in left)


@pytest.mark.few_cases
@every_chain
def test_the_energy_changes_by_the_powers_exactly(name: str, n: int) -> None:
    assert derived(name, n).energy_rate() == 0


@pytest.mark.parametrize("n", [1, 2, 3])
def test_the_energy_s_rate_is_found_the_long_way_too(n: int) -> None:
    derivation = derived("all", n)
    s, known = derivation.symbols, derivation.definitions
    pivot = derivation.chain.path
    total = derivation.kinetic_energy + derivation.potential_energy
    rate = total.diff(s.t) + sum(
        total.diff(x) * xd for x, xd in zip([*s.q, *s.qd], [*s.qd, *s.qdd], strict=True)
    )
    balance = rate.xreplace(known).xreplace(pivot) - sum(derivation.powers.values())
    of_balance = Evaluated(derivation, [balance, rate])
    solved, _ = evaluated("all", n)
    drawn = scene("all", n, 3)
    for state in states(drawn, 3):
        left, size = of_balance(drawn, state, solved(drawn, state)[:n])
        assert abs(left) <= 10 ** (5 - DIGITS) * max(1, abs(size))
        assert abs(size) > 0.01


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize(
    "kind", [one.kind for one in effects() if one.kind in SMOOTH and one.account != "none"]
)
def test_the_powers_are_those_of_the_reference(kind: str, n: int) -> None:
    derivation = derived(kind, n)
    of_powers = Evaluated(derivation, [sum(derivation.powers.values())])
    solved, _ = evaluated(kind, n)
    drawn = scene(kind, n, 4)
    rig = rig_of(drawn, multiple_precision(DIGITS))
    for state in states(drawn, 4):
        (power,) = of_powers(drawn, state, solved(drawn, state)[:n])
        shares = rig.shares(state.t, list(state.q), list(state.qd))
        assert abs(power - balance(shares)) <= 10 ** (8 - DIGITS) * abs(power)
        assert abs(power) > 1e-6


@pytest.mark.parametrize(
    ("kind", "part", "wrong"),
    [
        ("viscous_joint", "power", lambda law: lambda *_: sympy.Integer(0)),
        ("rod_drag", "load", lambda law: law.load._replace(moment=-law.load.moment)),
    ],
)
def test_a_power_or_a_torque_that_is_not_the_law_s_is_found(
    kind: str, part: str, wrong: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = LAWS[kind]

    def changed(*given: Any) -> Any:
        law = right(*given)
        return dataclasses.replace(law, **{part: wrong(law)})

    monkeypatch.setitem(LAWS, kind, changed)
    assert Derivation(scene(kind, 2, 0)).energy_rate() != 0


@pytest.mark.parametrize("n", [1, 2, 3])
def test_lagrange_s_equations_are_the_same_exactly(n: int) -> None:
    derivation = derived("none", n)
    s, chain = derivation.symbols, derivation.chain
    kinetic, potential = derivation.kinetic_energy, derivation.potential_energy
    for i, (q, qd) in enumerate(zip(s.q, s.qd, strict=True)):
        lagrange = chain.rate(kinetic.diff(qd)) - kinetic.diff(q) + potential.diff(q)
        newton_euler = derivation.mass_matrix[i, :].dot(s.qdd) - derivation.forcing[i]
        assert of_differences(lagrange - newton_euler) == 0


def test_two_equal_rods_have_the_accelerations_forces_and_frequencies_that_are_known() -> None:
    """They are let go from the horizontal, or swing slightly about the vertical."""
    derivation = Derivation.textbook()
    s, w2 = derivation.symbols, sympy.Symbol("w2")
    m, length, g = s.masses[0], s.lengths[0], s.gravity
    equal = {s.masses[1]: m, s.lengths[1]: length} | dict.fromkeys(s.qd, 0)
    start, rest = (equal | dict.fromkeys(s.q, angle) for angle in (0, sympy.pi / 2))
    found = [sympy.simplify(a.subs(start)) for a in derivation.accelerations]
    assert found == [9 * g / (7 * length), -3 * g / (7 * length)]
    start |= dict(zip(s.qdd, found, strict=True))
    forces = [[sympy.simplify(x.subs(start)) for x in force] for force in derivation.reactions]
    assert forces == [[0, -2 * m * g / 7], [0, m * g / 14]]
    stiffness = -derivation.forcing.jacobian(s.q).subs(rest)
    roots = sympy.roots((stiffness - w2 * derivation.mass_matrix.subs(rest)).det(), w2)
    found = {sympy.simplify(sympy.nsimplify(sympy.simplify(x * length / g))) for x in roots}
    assert found == {3 - 6 * sympy.sqrt(7) / 7, 3 + 6 * sympy.sqrt(7) / 7}


def test_a_uniform_rod_keeps_its_formulas_and_another_link_its_symbols() -> None:
    rods, others = derived("none, uniform rods", 2).symbols, derived("none", 2).symbols
    m, length = rods.masses[0], rods.lengths[0]
    assert rods.centers[0] == length / 2
    assert rods.inertias[0] == m * length**2 / 12
    assert [p.symbol.name for p in rods.parameters] == ["m1", "m2", "L1", "L2", "g"]
    assert str(others.centers[0]) == "c1"
    assert str(others.inertias[1]) == "I_C2"


def test_two_of_a_kind_in_one_joint_have_symbols_of_their_own() -> None:
    damper = pc.effects.ViscousJoint(joint=1, damping=0.25)
    rod = pc.Link(mass=1.0, length=1.0)
    one = Derivation(pc.Scene(links=[rod], effects=[damper]))
    two = Derivation(pc.Scene(links=[rod], effects=[damper, damper.replace(damping=0.5)]))
    assert [s.name for s in two.values if s not in one.values] == ["b_1_2"]
    assert len(two.powers) == 2
    same = Derivation(pc.Scene(links=[rod], effects=[damper, damper]))
    assert len(same.powers) == 1  # equal effects share one key
    assert same.energy_rate() == 0


def test_the_drag_of_a_rod_at_rest_is_zero() -> None:
    drag = pc.effects.RodDrag(link=1, drag_coefficient=1.0, diameter=0.1)
    derivation = Derivation(pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], effects=[drag]))
    s = derivation.symbols
    function = sympy.lambdify([s.t, *s.q, *s.qd, *s.values], derivation.accelerations[0])
    at_rest = function(0.0, 0.0, 0.0, *s.values.values())
    assert at_rest == pytest.approx(1.5 * 9.807, rel=1e-15)
    with mpmath.workdps(15):
        assert function(0.0, 0.0, 1.0, *s.values.values()) < at_rest
