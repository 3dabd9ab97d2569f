"""A case in a file: read it, run it, keep the solution, read that back, go on.

From the shell the same is: pendcore run 03_case_file.toml
"""

from __future__ import annotations

from pathlib import Path

import pendcore as pc

case = pc.read_case(Path(__file__).with_suffix(".toml"))
sol = case.simulate()
print(case.name)
print(sol)

sol.save("swing.npz")
longer = pc.load("swing.npz").resume(t_end=20.0)
print(longer.case().to_toml())
