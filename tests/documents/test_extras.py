"""Extras import `pendcore` as a user would: with everything private hidden they are whole."""

from __future__ import annotations

import subprocess
import sys

EXTRAS = ["plotting", "explanation", "page", "cost", "derive", "orbits", "cli"]
PROGRAM = """
import importlib, pkgutil, sys
import pendcore
for found in pkgutil.iter_modules(pendcore.__path__):
    if not found.ispkg and not found.name.startswith("_"):
        importlib.import_module(f"pendcore.{found.name}")  # a name that users import

class Hidden:
    def find_spec(self, name, *_):
        if name.startswith("pendcore._"):
            raise ImportError(f"{name} is private")

for name in dir(pendcore):
    getattr(pendcore, name)  # some are loaded when they are asked for
extras = tuple(f"pendcore.{name}" for name in sys.argv[1:])
for name in [name for name in sys.modules if name.startswith(("pendcore._", *extras))]:
    del sys.modules[name]
    vars(pendcore).pop(name.split(".")[1], None)
sys.meta_path.insert(0, Hidden())
for name in sys.argv[1:]:
    package = importlib.import_module(f"pendcore.{name}")
    for found in pkgutil.walk_packages(package.__path__, f"pendcore.{name}."):
        importlib.import_module(found.name)
"""


def imported(*names):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *names], capture_output=True, text=True, check=False
    )
    return done.stderr


def test_extras_stand_on_public_names_alone():
    assert imported(*EXTRAS) == ""


def test_what_imports_a_private_name_is_seen():
    assert "pendcore._horizon is private" in imported("_horizon")
