"""The house rules that a machine can check.

A rule takes the root of a source tree and yields one sentence for each breach that it finds.
"""

from __future__ import annotations

import ast
import re
import statistics
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path

import pendcore

Rule = Callable[[Path], Iterator[str]]

CODE = {".hpp", ".cpp", ".py", ".pyi", ".cmake", ".sh"}
FOLDERS = ["cpp", "python", "tests", "bench", "examples", "docs", "setup"]

# Data flows one way. Each stage of the C++ core is a folder, and may include what is named here.
# dynamics and integrate know nothing of each other; they meet in simulate.
CPP_FLOW = {
    "arithmetic": set[str](),
    "text": set[str](),
    "effects": {"arithmetic", "text"},
    "scene": {"arithmetic", "text", "effects"},
    "dynamics": {"arithmetic", "text", "effects", "scene"},
    "integrate": {"arithmetic", "text"},
    "simulate": {"arithmetic", "text", "effects", "scene", "dynamics", "integrate"},
    "analysis": {"arithmetic", "text", "effects", "scene", "dynamics", "integrate", "simulate"},
}
ALL_OF_IT = "pendcore.hpp"
"""The header that includes the whole core: for users, and for the bindings."""

# The same for Python: modules in the order of the flow; each may import those above it, with the
# exceptions that are named below.
PYTHON_FLOW = [
    "_core",
    "methods",
    "warning",
    "arguments",
    "angles",
    "progress",
    "whole_file",
    "toml_text",
    "effect_description",
    "effect_class",
    "effects",
    "events",
    "link",
    "scene",
    "explanation",
    "energy",
    "defect",
    "largest_reactions",
    "statistics",
    "run_error",
    "solution",
    "accuracy",
    "horizon",
    "simulate",
    "cost",
    "case",
    "case_file",
    "archive",
    "views",
    "derive",
    "cli",
]
# The methods of a solution (plot, save, ...) and of a scene (explain) call what comes later, but
# only when they are called.
LATE_IMPORTS = {
    "scene": {"explanation"},
    "run_error": {"solution"},
    "solution": {"accuracy", "horizon", "case", "archive", "views"},
    "horizon": {"views"},
    "cost": {"views"},
}
NOT_FOR_VIEWS = {"simulate", "archive", "case", "case_file", "toml_text"}

FORBIDDEN_NAMES = {"util", "utils", "helper", "helpers", "common", "misc", "impl"}
LIBM = (
    "sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|"
    "exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot"
)
KERNELS = ["arithmetic", "effects", "dynamics", "integrate", "simulate", "analysis"]


def files(root: Path, suffixes: set[str], *folders: str) -> Iterator[Path]:
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in suffixes and "__pycache__" not in path.parts:
                yield path


def without_comments(text: str) -> str:
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)


def without_texts(code: str) -> str:
    return re.sub(r'"(?:\\.|[^"\\\n])*"', '""', code)


def includes_follow_the_flow(root: Path) -> Iterator[str]:
    cpp = root / "cpp"
    for base in (cpp / "include/pendcore", cpp / "src"):
        for path in files(base, {".hpp", ".cpp"}, ""):
            place = path.relative_to(base)
            stage = place.parts[0]
            if place.name == ALL_OF_IT:
                continue
            if stage not in CPP_FLOW:
                yield f"{path.relative_to(root)} stands in no folder of the flow"
                continue
            for mark, name in includes_of(path):
                inside = name.removeprefix("pendcore/")
                if inside == name and mark == '"':
                    yield f"{path.relative_to(root)} includes {name}, not by its place in pendcore/"
                elif inside != name and inside.partition("/")[0] not in CPP_FLOW[stage] | {stage}:
                    yield f"{path.relative_to(root)} ({stage}) includes {name}"


def includes_of(path: Path) -> list[tuple[str, str]]:
    return re.findall(r'^#include (["<])([^">]+)', path.read_text(), re.MULTILINE)


def sources_stand_where_their_headers_do(root: Path) -> Iterator[str]:
    """cpp/src has the folders of the headers."""
    cpp = root / "cpp"
    for path in files(cpp / "src", {".cpp"}, ""):
        place = path.relative_to(cpp / "src")
        folder = cpp / "include/pendcore" / place.parent
        if not folder.is_dir():
            yield f"{path.relative_to(root)}: cpp/include/pendcore has no folder {place.parent}"
        elsewhere = list((cpp / "include/pendcore").rglob(f"{path.stem}.hpp"))
        if elsewhere and not (folder / f"{path.stem}.hpp").is_file():
            yield f"{path.relative_to(root)} stands in another folder than {elsewhere[0].name}"


def imports_of(tree: ast.Module) -> Iterator[tuple[str, bool]]:
    """The package's modules that a file imports, and whether in a function or for types alone."""
    late = {
        id(node)
        for outer in ast.walk(tree)
        if isinstance(outer, ast.FunctionDef | ast.AsyncFunctionDef)
        or (isinstance(outer, ast.If) and ast.unparse(outer.test) == "TYPE_CHECKING")
        for node in ast.walk(outer)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level:
            names = ["pendcore.(relative)"]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            if name.startswith("pendcore."):
                yield name.split(".")[1], id(node) in late


def imports_follow_the_flow(root: Path) -> Iterator[str]:
    package = root / "python/pendcore"
    for path in files(root, {".py"}, "python/pendcore"):
        if path == package / "__init__.py":
            continue
        relative = path.relative_to(package)
        module = relative.parts[0].removesuffix(".py").replace("__main__", "cli")
        if module not in PYTHON_FLOW:
            yield f"{path.relative_to(root)} has no place in the flow"
            continue
        allowed = {*PYTHON_FLOW[: PYTHON_FLOW.index(module) + 1]}
        if module == "views":
            allowed -= NOT_FOR_VIEWS
        for name, late in imports_of(ast.parse(path.read_text())):
            if name not in allowed | (LATE_IMPORTS.get(module, set()) if late else set()):
                yield f"{path.relative_to(root)} imports {name}"


def names_say_what_a_file_holds(root: Path) -> Iterator[str]:
    for path in files(root, CODE | {".md", ".txt"}, *FOLDERS):
        relative = path.relative_to(root)
        words = set(re.split(r"[/_.\-]", str(relative).lower()))
        for word in sorted(words & FORBIDDEN_NAMES):
            yield f"{relative}: {word!r} names no thing of physics or numerics"


def files_are_short(root: Path) -> Iterator[str]:
    lengths = {}
    for path in files(root, CODE, *FOLDERS):
        lines = path.read_text().splitlines()
        lengths[path] = len(lines)
        relative = path.relative_to(root)
        if len(lines) > 400:
            yield f"{relative} has {len(lines)} lines: more than 400"
        for number, line in enumerate(lines, start=1):
            if len(line) > 100:
                yield f"{relative}:{number} has {len(line)} columns: more than 100"
    if lengths and statistics.median(lengths.values()) > 120:
        yield "half of the files have more than 120 lines"
    if sum(length > 300 for length in lengths.values()) > len(lengths) / 20:
        yield "more than one file in twenty has more than 300 lines"


def comments_have_a_subject(root: Path) -> Iterator[str]:
    """A comment that begins with "Of" leaves it to the reader what is meant."""
    beginning = re.compile(r'(?://+<?|#|^\s*""")\s*Of\s')
    for path in files(root, CODE, *FOLDERS):
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            if beginning.search(line):
                yield f'{path.relative_to(root)}:{number} begins with "Of"'


def kernels_call_no_libm(root: Path) -> Iterator[str]:
    """Only what is correctly rounded (sqrt, fma, ...) gives the same bits on every machine."""
    call = re.compile(rf"(?<![\w.>:])(?:std::|::|__builtin_)?(?:{LIBM})[fl]?\s*\(")
    cpp = root / "cpp"
    for base in (cpp / "include/pendcore", cpp / "src"):
        for path in files(base, {".hpp", ".cpp"}, ""):
            if path.relative_to(base).parts[0] not in KERNELS:
                continue
            for found in call.findall(without_texts(without_comments(path.read_text()))):
                yield f"{path.relative_to(root)} calls {found}...)"


def builds_use_no_flag_that_changes_bits(root: Path) -> Iterator[str]:
    places = [*root.glob("CMake*"), *files(root, {".cmake", ".txt"}, "cpp", "tests/cpp")]
    for path in places:
        text = re.sub(r"#[^\n]*", "", path.read_text())
        for flag in re.findall(
            r"(?<![\w-])-(?:march=\S+|ffast-math|Ofast|ffp-contract=fast)", text
        ):
            yield f"{path.relative_to(root)} passes {flag}"


def version_is_the_same_everywhere(root: Path) -> Iterator[str]:
    version = tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"]
    cited = re.findall(r"^version: (\S+)$", (root / "CITATION.cff").read_text(), re.MULTILINE)
    if cited != [version]:
        yield f"CITATION.cff has version {', '.join(cited)}, pyproject.toml {version}"
    if pendcore.__version__ != version:
        yield f"the built core has version {pendcore.__version__}, pyproject.toml {version}"


RULES: list[Rule] = [
    includes_follow_the_flow,
    sources_stand_where_their_headers_do,
    imports_follow_the_flow,
    names_say_what_a_file_holds,
    files_are_short,
    comments_have_a_subject,
    kernels_call_no_libm,
    builds_use_no_flag_that_changes_bits,
    version_is_the_same_everywhere,
]
