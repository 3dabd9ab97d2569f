"""A warning is shown once for each line of a program and each kind, and filters do as they say."""

from __future__ import annotations

import subprocess
import sys
import warnings

import numpy as np
import pendcore as pc
import pytest

HEAVY = 123456.0


def scene(mass):
    return pc.Scene(links=[pc.Link(mass=mass, length=1.0), pc.Link(mass=2 * mass, length=1.0)])


def short(k):
    pc.simulate(pc.Scene.textbook(), q0=[0.5, 0.1 * k], t_span=(0, 5 + k), max_steps=5 + k)


def in_degrees(k):
    pc.simulate(pc.Scene.textbook(), q0=[45.0, 60.0 + 5 * k], t_span=(0, 0.1))


def members(k):
    pc.ensemble(pc.Scene.textbook(), q0=np.zeros((k + 1, 2)), t_span=(0, 5), max_steps=2)


def wave(k):
    driven = pc.effects.Motor(1, table=pc.effects.Table(t=[0, 0.5 + k], torque=[1, 2]))
    one = pc.Scene.textbook().replace(effects=[driven])
    pc.simulate(one, q0=0.3, t_span=(0, 1 + k), on_failure="ignore")


LOOPS = {
    "scenes with two odd links": (lambda k: scene(HEAVY + k), 2),
    "runs that end early": (short, 1),
    "starts in degrees": (in_degrees, 1),
    "ensembles that fail": (members, 1),
    "tables that end": (wave, 1),
}


@pytest.fixture
def shown():
    """Record what Python shows by its own filters."""
    with warnings.catch_warnings(record=True) as told:
        warnings.resetwarnings()
        yield told


@pytest.mark.parametrize("loop", LOOPS)
def test_a_loop_hears_of_each_kind_once(loop, shown):
    call, kinds = LOOPS[loop]
    for k in range(5):
        call(k)
    assert len(shown) == kinds
    assert all(one.filename == __file__ for one in shown)
    assert any(c.isdigit() for c in str(shown[0].message))  # the text itself has its values


def test_another_line_and_code_without_a_module_hear_of_it_too(shown):
    for k in range(50):
        scene(HEAVY + k)
    pc.Scene(links=[pc.Link(mass=HEAVY, length=1.0)])
    exec("pc.Scene(links=[pc.Link(mass=1e5, length=1)])", {"pc": pc})
    assert len(shown) == 4
    assert shown[2].lineno > shown[0].lineno
    # What was shown takes no memory for each text.
    noted = [key for key in globals()["__warningregistry__"] if isinstance(key, tuple)]
    assert sum("osmium" in key[0] for key in noted) == 3


@pytest.mark.parametrize("action", ["always", "ignore", "error", "once", "module", "default"])
def test_filters_do_as_they_say(action, shown):
    for k in range(3):  # the kinds are noted as shown
        scene(HEAVY + k)
    shown.clear()
    warnings.simplefilter(action, pc.PendcoreWarning)
    if action == "error":
        for k in range(3):
            with pytest.raises(pc.PendcoreWarning, match="osmium"):
                scene(HEAVY + k)
        return
    for k in range(3):
        scene(HEAVY + k)
    assert len(shown) == {"always": 6, "ignore": 0}.get(action, 2)


def test_what_the_package_does_in_silence_leaves_pythons_filters_alone(tmp_path, shown):
    sol = pc.simulate(scene(HEAVY), q0=0.5, t_span=(0, 0.1))
    sol.save(tmp_path / "run.npz")
    varied = {"link[1].mass": [HEAVY, 2 * HEAVY]}
    found = pc.ensemble(sol.scene, q0=[0.5, 0.5], t_span=(0, 0.1), vary=varied)
    assert len(shown) == 2
    for k in range(3):
        scene(HEAVY + k)
        pc.load(tmp_path / "run.npz")
        found.energy()
    assert len(shown) == 2


def test_pytest_warns_sees_each_whatever_was_shown_before(shown):
    for k in range(3):
        with pytest.warns(pc.PendcoreWarning, match=r"link 2: mass = 24691\d\.0"):
            scene(HEAVY + k)


@pytest.mark.outside_build
def test_what_is_typed_by_hand_is_answered_each_time():
    """Each input has line 1 of a file of one name."""
    lines = "import pendcore as pc\n" + "".join(
        f"pc.Scene(links=[pc.Link(mass={mass}, length=1)])\n" for mass in (123456, 234567, 123456)
    )
    loop = "for m in (345678, 456789): _ = pc.Scene(links=[pc.Link(mass=m, length=1)])\n\n"
    ran = subprocess.run(
        [sys.executable, "-i", "-q"], input=lines + loop, text=True, capture_output=True, check=True
    )
    told = [line.partition("mass = ")[2][:8] for line in ran.stderr.splitlines() if "osm" in line]
    assert told == ["123456.0", "234567.0", "345678.0"]
