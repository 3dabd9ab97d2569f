"""Which tests speak of a file: they run first, so that most mutants die in seconds."""

from __future__ import annotations

import re
from functools import cache
from math import log, sqrt
from pathlib import Path


def related_first(root: Path, path: str) -> list[str]:
    """Return all files of tests, first those that share most rare words with a file."""
    tests = words_of_tests(root)
    if not path:
        return sorted(tests)
    words = words_of((root / path).read_text() + path.replace("_", " "))
    held = [words & of_test for of_test in tests.values()]
    weight = {
        word: log(len(tests) / sum(word in one for one in held)) for one in held for word in one
    }

    def likeness(test: str) -> float:
        return sum(weight[word] for word in words & tests[test]) / sqrt(len(tests[test]))

    return sorted(tests, key=likeness, reverse=True)


@cache
def words_of_tests(root: Path) -> dict[str, frozenset[str]]:
    files = sorted((root / "tests").rglob("test_*.py"))
    # Those are about what pip installs, and a workshop installs nothing.
    files = [file for file in files if file.parent.name != "packaging"]
    return {str(file.relative_to(root)): words_of(file.read_text()) for file in files}


def words_of(text: str) -> frozenset[str]:
    return frozenset(re.findall(r"[A-Za-z_]{4,}", text))
