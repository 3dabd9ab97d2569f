"""Which tests run a line of the package, as coverage.py tells: the others cannot notice it."""

from __future__ import annotations

import ast
import json
from pathlib import Path

from coverage import CoverageData

SETTINGS = """\
[run]
core = ctrace
data_file = {data}
source = {source}
parallel = true
patch = subprocess
"""
"""A line that runs in a process of its own counts as run outside a test."""

TestsOfLines = dict[str, dict[int, list[str]]]
"""By file and line, the tests that run it."""
OUTSIDE = ""
"""The name for what runs outside a test."""


def told(data_file: Path, source: Path) -> TestsOfLines:
    """Return what a run of all tests with `SETTINGS` left."""
    data = CoverageData(str(data_file))
    data.read()
    tests: TestsOfLines = {}
    for file in data.measured_files():
        by_line = data.contexts_by_lineno(file)
        tests[str(Path(file).relative_to(source))] = {
            line: sorted({name_of(context) for context in contexts})
            for line, contexts in by_line.items()
        }
    return tests


def name_of(context: str) -> str:
    """Return the test of a context as pytest takes it, without its parameters."""
    return context.partition("|")[0].partition("[")[0]


def tests_that_run(tests: TestsOfLines, path: str, source: str, line: int) -> list[str]:
    """Return the tests that run the statement on a line."""
    of_file = tests.get(path, {})
    begin, end = statement_at(source, line)
    return sorted({test for one in range(begin, end + 1) for test in of_file.get(one, [])})


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


def saved(tests: TestsOfLines, path: Path) -> None:
    path.write_text(json.dumps(tests))


def loaded(path: Path) -> TestsOfLines:
    return {
        file: {int(line): names for line, names in lines.items()}
        for file, lines in json.loads(path.read_text()).items()
    }
