"""Which tests can notice a mutant: those that run its line; first those that speak of its file."""

from __future__ import annotations

import ast
import json
import re
from functools import cache
from math import log, sqrt
from pathlib import Path

SETTINGS = """\
[run]
core = ctrace
data_file = {data}
source = {source}
parallel = true
patch = subprocess
[json]
show_contexts = true
"""
"""A line that runs in a process of its own counts as run outside a test."""

Contexts = dict[str, list[str]]
"""By the number of a line, what ran it: a test and one of its phases, or nothing outside tests."""


def told(report: Path) -> dict[str, Contexts]:
    """Return what ran the lines of each file, as coverage's report has it."""
    files = json.loads(report.read_text())["files"]
    return {file: of_file["contexts"] for file, of_file in files.items()}


def tests_that_run(contexts: Contexts, source: str, line: int) -> list[str]:
    """Return the tests, without their parameters, that run the statement on a line of a file."""
    begin, end = statement_at(source, line)
    found = {one for number in range(begin, end + 1) for one in contexts.get(str(number), [])}
    return sorted({one.partition("|")[0].partition("[")[0] for one in found} - {""})


def statement_at(source: str, line: int) -> tuple[int, int]:
    """Return the first and the last line of the smallest statement, or head of one, on a line."""
    spans = [(line, line)]
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            if node.lineno <= line <= max(end, node.lineno):
                spans.append((node.lineno, max(end, node.lineno)))
    return max(spans[1:] or spans, key=lambda span: span[0])


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
