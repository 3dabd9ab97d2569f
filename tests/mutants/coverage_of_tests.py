"""Which tests run a line of the package, as coverage.py tells: the others cannot notice it."""

from __future__ import annotations

import ast
import json
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
