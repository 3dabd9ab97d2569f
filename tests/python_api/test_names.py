"""Names may be any text that a file can hold; half a character is refused where it is given."""

from __future__ import annotations

import pendcore as pc
import pytest

HALF = "swing\udce9"  # what Python makes of a file's name that is not UTF-8
BOOK = pc.Case.textbook()
SHORT = {"scene": BOOK.scene, "q0": BOOK.q0, "t_span": (0.0, 0.2)}
KEPT = {HALF: pc.reducers.EnergyDrift()}
DOORS = {
    "a case": lambda sol, path: pc.Case(**SHORT, name=HALF),
    "a case file": lambda sol, path: pc.read_case(BOOK.to_toml().replace("double pendulum", HALF)),
    "a solution": lambda sol, path: setattr(sol, "name", HALF),
    "the title of a page": lambda sol, path: sol.to_html(path / "a.html", title=HALF),
    "a film": lambda sol, path: sol.to_video(path / "a.gif", sol, names=("a", HALF)),
    "an animation": lambda sol, path: sol.animate(names=(HALF,)),
    "the label in a figure": lambda sol, path: sol.plot(label=HALF),
    "a comparison": lambda sol, path: pc.accuracy_cost(**SHORT, methods="dopri5", name=HALF),
    "a reducer": lambda sol, path: pc.ensemble(**SHORT | {"q0": [BOOK.q0]}, keep=KEPT),
}


@pytest.mark.every_value("door")
@pytest.mark.parametrize("door", DOORS)
def test_half_a_character_is_refused_at_the_door(door, tmp_path):
    sol = pc.Case(**SHORT, name="kept").simulate()
    with pytest.raises(ValueError, match=r"holds '\\udce9', half a character.*: leave it out"):
        DOORS[door](sol, tmp_path)
    assert [*tmp_path.iterdir()] == []
    assert sol.name == "kept"


CONTROLS = ["\n", "\0\x1f\x7f\x80", "\u2028"]
TEXTS = ["θ sweep", "摆", "\U0001f600", "\U0001d11e", 'a "b" \\ c\n</script>\x7f', "#[=]", ""]


@pytest.mark.parametrize("name", [*CONTROLS, *TEXTS])
def test_any_other_name_comes_back_from_a_file(name, tmp_path):
    sol = pc.Case(**SHORT, name=name).simulate()
    sol.save(tmp_path / "run.npz")
    assert pc.load(tmp_path / "run.npz").name == name
    (tmp_path / "case.toml").write_text(sol.case().to_toml(), encoding="utf-8")
    assert pc.read_case(tmp_path / "case.toml").name == name
    assert sol.to_html(tmp_path / "run.html").read_bytes().decode("utf-8")
