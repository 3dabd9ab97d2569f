"""A module shows the names that it offers, and none that it needs itself."""

from __future__ import annotations

from importlib import import_module

import pytest

MODULES = ("effects", "events", "methods", "options", "reducers", "sampling")


@pytest.mark.parametrize("name", MODULES)
def test_dir_shows_what_the_module_offers(name):
    module = import_module(f"pendcore.{name}")
    assert dir(module) == sorted(module.__all__)
    assert all(hasattr(module, one) for one in module.__all__)
