"""What cannot be derived in symbols is refused with the effect, the reason and what to do."""

from __future__ import annotations

import subprocess
import sys

import pendcore as pc
import pytest
from pendcore.derive import Derivation
from pendcore.derive.derivation import WRITTEN_OUT
from pendcore.derive.laws import LAWS, WITHOUT_LAW
from symbolic_scenes import derivation

pytestmark = pytest.mark.unsanitized

fx = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)


def derive(*effects: object, n: int = 2) -> Derivation:
    return Derivation(pc.Scene(links=[ROD] * n, effects=effects))


def test_every_kind_has_a_law_or_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not LAWS.keys() & WITHOUT_LAW.keys()
    assert LAWS.keys() | WITHOUT_LAW.keys() <= fx.kinds().keys()
    monkeypatch.delitem(LAWS, "payload")  # as if the effect were new
    with pytest.raises(ValueError, match=r"^effect 1, Payload\(mass=0\.5\): .* nobody has written"):
        derive(fx.Payload(mass=0.5))


REFUSED = [
    (fx.DryJointFriction(joint=2, coulomb=0.1), ("jumps with the sign", "use ViscousJoint")),
    (fx.JointStop(joint=1, range=(-1, 1)), ("the rates jump", "TorsionalSpring")),
    (fx.User(lambda t, q, qd: 0 * q), ("User(", "no symbols", "has a law in symbols")),
    (fx.CompiledUser(1), ("CompiledUser(address=<at 0x1>)", "no symbols")),
    (
        fx.Motor(joint=1, table=fx.Table([0.0, 1.0], [0.0, 1.0])),
        ("Motor(joint=1, table=", "corner", "constant, sinusoid or pd"),
    ),
    (
        fx.Motor(joint=2, pd=fx.PD(kp=1.0, kd=1.0, reference=0.0), limit=2.0),
        ("limit = 2.0", "corner at +-limit", "leave limit out"),
    ),
    (
        fx.Motor(joint=1, constant=-3.0, limit=2.0),
        ("limit = 2.0", "3.0 N m is clipped", "give the torque that is left"),
    ),
    (
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(3.0, 1.0), limit=2.0),
        ("limit = 2.0", "3.0 N m is clipped", "leave limit out"),
    ),
    (
        fx.DrivenPivot(spline=fx.Spline([0.0, 1.0, 2.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1])),
        ("DrivenPivot(spline=", "given by points", "sinusoids"),
    ),
]


@pytest.mark.parametrize(("effect", "said"), REFUSED, ids=[e.kind for e, _ in REFUSED])
def test_what_is_not_smooth_is_refused(effect: pc.effects.Effect, said: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"^effect 2, ") as refused:
        derive(fx.ViscousJoint(joint=1, damping=0.1), effect)
    message = str(refused.value)
    for words in (repr(effect), "cannot be derived in symbols: ", *said):
        assert words in message
    assert message.endswith("or leave it to pendcore.simulate")


def test_a_limit_that_is_never_passed_is_none() -> None:
    for drive in ({"constant": -2.0}, {"sinusoid": fx.Sinusoid(-2.0, 1.0)}):
        assert len(derive(fx.Motor(joint=1, limit=2.0, **drive)).powers) == 1


def test_long_chains_are_refused_for_what_was_measured() -> None:
    derive(n=5)
    with pytest.raises(ValueError, match=r"^scene: 6 links: at most 5") as refused:
        derive(n=6)
    message = str(refused.value)
    assert "5, 137, 1 207, 10 190, 90 219 operations" in message
    assert "pendcore.simulate takes any number, by an O(n) recursion" in message


@pytest.mark.few_cases
@pytest.mark.parametrize("n", range(1, len(WRITTEN_OUT) + 1))
def test_the_growth_is_what_the_message_says(n: int) -> None:
    made = derivation(pc.Scene(links=[ROD] * n))
    assert sum(a.count_ops() for a in made.accelerations) == WRITTEN_OUT[n - 1]
    shared = [*(value for _, value in made.shared), *made.shared_accelerations]
    assert sum(value.count_ops() for value in shared) < 10 * n**3  # polynomial, not exponential


def test_a_report_is_of_a_case_of_its_scene(tmp_path: object) -> None:
    other = pc.Case(scene=pc.Scene(links=[ROD]), q0=0.1, t_span=(0, 1))
    with pytest.raises(ValueError, match="case: has another scene"):
        derivation(pc.Scene.textbook()).report(other, tmp_path)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("assert 'sympy' not in sys.modules; pc.derive; assert 'sympy' in sys.modules", ""),
        ("sys.modules['sympy'] = None; from pendcore import *; simulate", ""),
        (
            "sys.modules['sympy'] = None; pc.derive",
            "ModuleNotFoundError: pendcore.derive needs sympy, which is not installed: "
            "pip install sympy",
        ),
        ("pc.derived", "AttributeError: module 'pendcore' has no attribute 'derived'"),
    ],
    ids=["lazy", "all the rest", "install", "unknown"],
)
def test_sympy_is_loaded_when_it_is_asked_for(code: str, said: str) -> None:
    command = [sys.executable, "-c", f"import sys, pendcore as pc; {code}"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.stderr.strip().splitlines() or [""])[-1].startswith(said)
    assert done.returncode == bool(said)
