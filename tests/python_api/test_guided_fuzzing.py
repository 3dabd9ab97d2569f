"""A few hundred inputs of `make fuzz-readers`: its readers run, from seeds that hold it all."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from fuzz.readers import READERS, whole_solutions

TESTS = Path(__file__).parents[1]
RUNS = 500


def test_the_seeds_hold_every_method_events_stops_and_compensated_steps() -> None:
    seeds = whole_solutions()
    runs = [solution._run for solution in seeds]
    pairs = {"dopri5-radau5", "dop853-radau5", "taylor-radau5"}
    assert {run.method for run in runs} == {"dopri5", "radau5", *pairs}
    assert {solution.status for solution in seeds} >= {"finished", "event", "max_steps"}
    assert sum(len(solution.events) > 0 for solution in seeds) > 2
    kinds = {effect.kind for solution in seeds for effect in solution.scene.effects}
    assert kinds >= {"joint_stop", "dry_joint_friction", "viscous_joint", "motor", "driven_pivot"}
    assert {run.arguments["compensated"] for run in runs} == {False, True}


@pytest.mark.outside_build
@pytest.mark.parametrize("reader", READERS)
def test_what_coverage_damages_is_refused_in_words_or_used(reader: str, tmp_path: Path) -> None:
    if importlib.util.find_spec("atheris") is None:
        pytest.skip("atheris is missing: make fuzz-readers installs it")
    if reader == "store":
        pytest.importorskip("zarr", exc_type=ImportError)
    paths = [str(TESTS), str(TESTS / "models")]
    done = subprocess.run(
        [
            sys.executable, "-m", "fuzz.guided", reader, tmp_path / "corpus", f"-runs={RUNS}",
            "-seed=1", f"-artifact_prefix={tmp_path}/",
        ],
        cwd=TESTS, env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)}, capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    told = done.stdout + done.stderr
    assert done.returncode == 0, told
    made = re.search(r"Done (\d+) runs", told)
    assert made
    assert int(made[1]) >= RUNS  # seeds count as well
    assert not [*tmp_path.glob("crash-*"), *tmp_path.glob("timeout-*"), *tmp_path.glob("oom-*")]
