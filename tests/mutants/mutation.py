"""Mistakes that a hand makes: an operator, a constant, a condition, a line left out.

A parser says where they can be made, so that comments, texts and types stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import tree_sitter_cpp
import tree_sitter_python
from tree_sitter import Language, Node, Parser

PARSERS = {
    ".py": Parser(Language(tree_sitter_python.language())),
    ".cpp": Parser(Language(tree_sitter_cpp.language())),
    ".hpp": Parser(Language(tree_sitter_cpp.language())),
}
PAIRS = (
    "+ -, * /, += -=, *= /=, < <=, > >=, == !=, and or, && ||, is is_not, in not_in, ++ --, "
    "true false, True False"
)
OTHER_OPERATOR = {"**": "*", "//": "/", "%": "*"}
for one, other in (pair.replace("_", " ").split(" ", 1) for pair in PAIRS.split(", ")):
    OTHER_OPERATOR |= {one: other, other: one}
WITH_OPERATOR = {
    "binary_operator", "comparison_operator", "boolean_operator", "augmented_assignment",
    "binary_expression", "assignment_expression", "update_expression",
}  # fmt: skip
NEGATIONS = {"not_operator", "unary_operator", "unary_expression"}
NUMBERS = {"integer", "float", "number_literal"}
STATEMENTS = {
    "expression_statement", "raise_statement", "throw_statement", "break_statement",
    "continue_statement", "delete_statement",
}  # fmt: skip
NOT_ASKED = {"switch_statement", "preproc_if", "preproc_elif"}
"""Their conditions are no question to a run."""
LEFT_ALONE = {
    "type", "comment", "import_statement", "import_from_statement", "future_import_statement",
    "static_assert_declaration", "attribute_declaration", "attribute_specifier",
    "pure_virtual_clause", "preproc_include", "preproc_call",
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """A mistake: `after` replaces `before`, which the bytes from `start` to `end` of a file are."""

    path: str
    line: int
    kind: str
    start: int
    end: int
    before: str
    after: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.kind}: {self.before!r} -> {self.after!r}"

    def applied(self, source: bytes) -> bytes:
        return source[: self.start] + self.after.encode() + source[self.end :]


class Add(Protocol):
    """Notes a mutant of a kind: a node, and what is written in its place."""

    def __call__(self, kind: str, node: Node, after: str) -> None: ...


def mutants(path: str, source: bytes) -> list[Mutant]:
    """Return all mutants of a file in Python or C++."""
    found = []

    def add(kind: str, node: Node, after: str) -> None:
        line = node.start_point.row + 1
        place = (node.start_byte, node.end_byte)
        found.append(Mutant(path, line, kind, *place, text(node), after))

    is_python = path.endswith(".py")
    for node in nodes(PARSERS[Path(path).suffix].parse(source).root_node):
        mutate(node, is_python, add)
    return found


def mutate(node: Node, is_python: bool, add: Add) -> None:
    """Note the mutants that begin with a node."""
    if node.type in WITH_OPERATOR:
        for child in node.children:
            if not child.is_named and text(child) in OTHER_OPERATOR:
                add("operator", child, OTHER_OPERATOR[text(child)])
    elif node.type in NEGATIONS and text(node)[0] in "-!n":
        add("operator", node, text(node.children[-1]))
    elif node.type in NUMBERS and (changed := other_number(text(node))):
        add("constant", node, changed)
    elif node.type in ("true", "false"):
        add("constant", node, OTHER_OPERATOR[text(node)])
    elif node.type in STATEMENTS and not only_names_something(node):
        add("left out", node, "pass" if is_python else ";")
    condition = node.child_by_field_name("condition")
    if condition is not None and node.type not in NOT_ASKED:
        asked = text(condition)
        if "=" not in asked.replace("==", "").replace("<=", "").replace(">=", "").replace("!=", ""):
            add("condition", condition, f"not ({asked})" if is_python else negated(asked))


def nodes(node: Node) -> Iterator[Node]:
    """Return the nodes in which mistakes are made."""
    if node.type in LEFT_ALONE:
        return
    yield node
    for child in node.children:
        yield from nodes(child)


def only_names_something(statement: Node) -> bool:
    """Whether a statement of Python is a text, or the name of a value: any use would miss it."""
    if not statement.named_children:
        return False
    inner = statement.named_children[0]
    if inner.type != "assignment":
        return inner.type in ("string", "concatenated_string")
    return text(inner).partition("=")[0].partition(":")[0].strip().isidentifier()


def negated(condition: str) -> str:
    """Return a condition of C++ negated; that of `if` and `while` is in parentheses."""
    return f"(!{condition})" if condition.startswith("(") else f"!({condition})"


def other_number(number: str) -> str:
    """Return a whole number increased by one, another one doubled; 0.0 becomes 1.0."""
    try:
        return str(int(number) + 1)
    except ValueError:
        pass
    try:
        return repr(2 * float(number) or 1.0)
    except ValueError:
        return ""  # has a suffix, or another base


def text(node: Node) -> str:
    return (node.text or b"").decode()
