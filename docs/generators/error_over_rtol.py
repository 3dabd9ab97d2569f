"""Measures `error_over_rtol` of a method's descriptor: the typical largest error, over rtol.

    python docs/generators/error_over_rtol.py bs23

For each rtol it prints the median over 400 random regular scenes, those whose seeds served to
choose the numbers in `pendcore._accuracy.method_choice`. The descriptor has one number for all.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from tqdm import tqdm

sys.path += [str(Path(__file__).parents[2] / "tests" / folder) for folder in ("", "models")]
from regular_scenes import regular

SEEDS = range(200, 600)
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)


def main(method: str) -> None:
    scenes = [regular(seed) for seed in tqdm(SEEDS, unit="scene", disable=None)]
    for rtol in TOLERANCES:
        runs = [(one, one.run(method=method, rtol=rtol, atol=rtol / 1000)) for one in scenes]
        errors = [one.error_of(run) for one, run in runs if run.success]
        print(f"rtol {rtol:.0e}: median error / rtol {np.median(errors) / rtol:.2g}")


if __name__ == "__main__":
    main(*sys.argv[1:])
