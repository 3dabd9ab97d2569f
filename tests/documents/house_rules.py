"""The house rules that a machine can check: `python tests/documents/house_rules.py` checks them.

A rule takes the root of a source tree and yields one sentence for each breach that it finds.
"""

from __future__ import annotations

import ast
import json
import re
import statistics
import sys
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

Rule = Callable[[Path], Iterator[str]]

CODE = {".hpp", ".cpp", ".py", ".pyi", ".cmake", ".sh"}
FOLDERS = ["cpp", "python", "tests", "bench", "examples", "docs", "setup"]

# Data flows one way. Each stage of the C++ core is a folder that may include those named here.
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
    "ensemble": {
        *("arithmetic", "text", "effects", "scene", "dynamics", "integrate", "simulate"),
        "analysis",
    },
}
ALL_OF_IT = "pendcore.hpp"
"""The header that includes the whole door: for users, and for WebAssembly."""

# Each of the door's headers belongs to a stage.
STAGE_OF_PUBLIC_HEADER = {
    **dict.fromkeys(["descriptor.hpp"], "text"),
    **dict.fromkeys(["vector.hpp"], "arithmetic"),
    **dict.fromkeys(["effects.hpp"], "effects"),
    **dict.fromkeys(["scene.hpp", "parameters.hpp"], "scene"),
    **dict.fromkeys(["equations.hpp", "mechanics.hpp"], "dynamics"),
    **dict.fromkeys(["status.hpp", "methods.hpp", "events.hpp"], "integrate"),
    **dict.fromkeys(["options.hpp", "solution.hpp", "simulate.hpp"], "simulate"),
    **dict.fromkeys(["lyapunov.hpp"], "analysis"),
    **dict.fromkeys(["ensemble.hpp"], "ensemble"),
}
MOST_PUBLIC_HEADERS = 30

# Python's layers, each above those that it may import: the folders of the package, the compiled
# core below them. The package's own files, the names that users import, are `pendcore` itself; the
# extras above it stand on these names alone.
PYTHON_LAYERS = [
    "_core",
    "_messages",
    "_scene",
    "_run",
    "_accuracy",
    "_horizon",
    "_cases",
    "_ensemble",
    "_api",
    "pendcore",
    "plotting",
    "explanation",
    "page",
    "cost",
    "derive",
    "orbits",
    "cli",
]
LAYER_OF_PUBLIC_MODULE = {
    "effects": "_scene",
    **dict.fromkeys(("events", "methods", "options"), "_run"),
    **dict.fromkeys(("reducers", "sampling"), "_ensemble"),
}
"""Where the package's own files are more than names of what stands elsewhere."""
EXTRAS = PYTHON_LAYERS[PYTHON_LAYERS.index("pendcore") + 1 :]

# The classes that users hold, the package, and `simulate`. They lead to other rooms when they are
# asked to, and load these then.
HELD_BY_USERS = {
    f"python/pendcore/{name}.py"
    for name in (
        *("_scene/scene", "_run/solution", "_cases/case", "_ensemble/ensemble"),
        *("__init__", "_api/simulate", "_horizon/lyapunov", "derive/derivation"),
    )
}

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


def stage_of(header: str) -> str:
    """Return the stage of a header by its place in the door or in cpp/src."""
    first = header.partition("/")[0]
    return STAGE_OF_PUBLIC_HEADER.get(first, first)


def includes_follow_the_flow(root: Path) -> Iterator[str]:
    cpp = root / "cpp"
    for base in (cpp / "include/pendcore", cpp / "src"):
        for path in files(base, {".hpp", ".cpp"}, ""):
            place = path.relative_to(base)
            stage = stage_of(str(place))
            if place.name == ALL_OF_IT:
                continue
            if stage not in CPP_FLOW:
                yield f"{path.relative_to(root)} stands in no folder of the flow"
                continue
            for mark, name in includes_of(path):
                included = stage_of(name.removeprefix("pendcore/"))
                if included in CPP_FLOW:
                    if included not in CPP_FLOW[stage] | {stage}:
                        yield f"{path.relative_to(root)} ({stage}) includes {name}"
                elif mark == '"':
                    yield f"{path.relative_to(root)} includes {name}, not by its place"


def the_door_is_small(root: Path) -> Iterator[str]:
    """The public headers are few, and include no header that is not installed."""
    door = root / "cpp/include/pendcore"
    headers = list(files(door, {".hpp"}, ""))
    if len(headers) > MOST_PUBLIC_HEADERS:
        yield f"{len(headers)} public headers: more than {MOST_PUBLIC_HEADERS}"
    for path in headers:
        for mark, name in includes_of(path):
            if mark == '"' and not (
                name.startswith("pendcore/") and (door.parent / name).is_file()
            ):
                yield f"{path.relative_to(root)} includes {name}, which is not public"


def includes_of(path: Path) -> list[tuple[str, str]]:
    return re.findall(r'^#include (["<])([^">]+)', path.read_text(), re.MULTILINE)


def sources_stand_where_their_headers_do(root: Path) -> Iterator[str]:
    """A private header and the source of its name are neighbours."""
    src = root / "cpp/src"
    for path in files(src, {".cpp"}, ""):
        elsewhere = list(src.rglob(f"{path.stem}.hpp"))
        if elsewhere and not path.with_suffix(".hpp").is_file():
            yield f"{path.relative_to(root)} stands in another folder than {elsewhere[0].name}"


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text())


def imports_of(tree: ast.AST, where: str = "") -> Iterator[tuple[str, str]]:
    """Yield the package's modules that a file imports, and where, if not in the open."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level:
            names = ["pendcore.(relative)"]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield from imports_of(node, " in a function")
            continue
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            yield from imports_of(node, " for types alone")
            continue
        else:
            yield from imports_of(node, where)
            continue
        yield from ((name, where) for name in names if name.split(".")[0] == "pendcore")


def layer_of(module: str) -> str:
    """Return the layer of a module or of a name in it; what is in no folder is `pendcore`."""
    first, *names = module.split(".")
    place = LAYER_OF_PUBLIC_MODULE.get(names[0], names[0]) if names else first
    return place if place in PYTHON_LAYERS else first


def modules_of(root: Path) -> dict[str, Path]:
    """Return the package's files by the names under which they are imported."""
    found = {}
    for path in files(root, {".py"}, "python/pendcore"):
        names = path.relative_to(root / "python").with_suffix("").parts
        found[".".join(names).removesuffix(".__init__")] = path
    return found


def imports_go_down(root: Path) -> Iterator[str]:
    for module, path in modules_of(root).items():
        place = path.relative_to(root)
        if len(place.parts) > 3 and place.parts[2] not in PYTHON_LAYERS:
            yield f"{place} is in no layer"
            continue
        # `python -m pendcore` is the command, though Python wants it here.
        layer = "cli" if module == "pendcore.__main__" else layer_of(module)
        for name, where in imports_of(parsed(path)):
            if where and str(place) in HELD_BY_USERS:
                continue
            if where:
                yield f"{place} imports {name}{where}"
            if name == "pendcore.(relative)":
                yield f"{place} has a relative import"
            elif PYTHON_LAYERS.index(layer_of(name)) > PYTHON_LAYERS.index(layer):
                yield f"{place} ({layer}) imports {name}, which is above it"
        # Only the package's own files may load a module by its name, because SymPy is an extra.
        if layer != "pendcore" and re.search(r"\b(import_module|__import__)\b", path.read_text()):
            yield f"{place} imports a module by its name"


def imports_form_no_circle(root: Path) -> Iterator[str]:
    modules = modules_of(root)
    graph = {
        module: {
            name if name in modules else name.rpartition(".")[0]
            for name, where in imports_of(parsed(path))
            if not where and layer_of(name) != "_core"
        }
        for module, path in modules.items()
    }
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        yield f"a circle of imports: {' <- '.join(error.args[1])}"


def extras_stand_on_public_names(root: Path) -> Iterator[str]:
    """Extras import nothing private, and touch no private attribute of what the package gives."""
    trees = {name: parsed(path) for name, path in modules_of(root).items()}
    private = {
        node.attr
        for name, tree in trees.items()
        for node in ast.walk(tree)
        if layer_of(name) not in EXTRAS
        and isinstance(node, ast.Attribute)
        and is_private(node.attr)
    } - {"_asdict", "_replace", "_fields"}
    for name, tree in trees.items():
        if layer_of(name) not in EXTRAS:
            continue
        for imported, _ in imports_of(tree):
            if any(map(is_private, imported.split("."))) and layer_of(imported) not in EXTRAS:
                yield f"{name} imports {imported}, which is private"
        for node in ast.walk(tree):
            if not isinstance(node, ast.Attribute) or node.attr not in private:
                continue
            if not (isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")):
                yield f"{name} uses {ast.unparse(node)}, which is private"


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def names_say_what_a_file_holds(root: Path) -> Iterator[str]:
    for path in files(root, CODE | {".md", ".mjs", ".txt"}, *FOLDERS):
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
        # A stub is written by a program, and a class that users hold stands in one file.
        if len(lines) > 400 and path.suffix != ".pyi" and str(relative) not in HELD_BY_USERS:
            yield f"{relative} has {len(lines)} lines: more than 400"
        for number, line in enumerate(lines, start=1):
            if len(line) > 100:
                yield f"{relative}:{number} has {len(line)} columns: more than 100"
    if lengths and statistics.median(lengths.values()) > 120:
        yield "half of the files have more than 120 lines"
    if sum(length > 300 for length in lengths.values()) > len(lengths) / 20:
        yield "more than one file in twenty has more than 300 lines"


def shown_code(path: Path) -> str:
    """Return the lines of code that a reader of a page, an example or a notebook sees."""
    text = path.read_text()
    if path.suffix == ".md":
        return "".join(re.split(r"^ *```.*$", text, flags=re.MULTILINE)[1::2])
    if path.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        return "\n".join("".join(x["source"]) for x in cells if x["cell_type"] == "code")
    return text


def shown_code_is_narrow(root: Path) -> Iterator[str]:
    examples = files(root, {".py", ".cpp", ".toml", ".ipynb"}, "examples")
    for path in [*sorted(root.glob("*.md")), *files(root, {".md"}, "docs"), *examples]:
        for line in shown_code(path).splitlines():
            if len(line) > 88:
                yield f"{path.relative_to(root)} shows more than 88 columns: {line.strip()}"


def kernels_call_no_libm(root: Path) -> Iterator[str]:
    """Only what is correctly rounded (sqrt, fma, ...) gives the same bits on every machine."""
    call = re.compile(rf"(?<![\w.>:])(?:std::|::|__builtin_)?(?:{LIBM})[fl]?\s*\(")
    cpp = root / "cpp"
    for base in (cpp / "include/pendcore", cpp / "src"):
        for path in files(base, {".hpp", ".cpp"}, ""):
            if stage_of(str(path.relative_to(base))) not in KERNELS:
                continue
            for found in call.findall(without_texts(without_comments(path.read_text()))):
                yield f"{path.relative_to(root)} calls {found}...)"


def matrices_own_memory_of_malloc(root: Path) -> Iterator[str]:
    """Aligned memory is allocated and freed as -march says, and users choose their own."""
    aligned = re.compile(r"(?<!Map<const )(?<!Map<)Eigen::(?:Matrix|Vector|RowVector|Array)X\w+")
    for path in files(root, {".hpp", ".cpp"}, "cpp"):
        code = without_comments(path.read_text())
        if "#define Eigen " in code:  # a namespace of its own shares nothing with a program
            continue
        for found in aligned.findall(code):
            yield f"{path.relative_to(root)} has a {found}: use the types of vector.hpp"


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


def workflows_are_pinned(root: Path) -> Iterator[str]:
    """A tag of an action can be moved to other code, and what is not forbidden is allowed."""
    for path in sorted((root / ".github/workflows").glob("*.yml")):
        text = path.read_text()
        for action in re.findall(r"uses: (?!\./)(\S+(?: #.*)?)", text):
            if not re.fullmatch(r"\S+@[0-9a-f]{40} # v\d\S*", action):
                yield f"{path.relative_to(root)} uses {action}, not a commit and its version"
        if not re.search(r"^permissions:\n  contents: read$", text, re.MULTILINE):
            yield f"{path.relative_to(root)} does not begin with the permission to read alone"


RULES: list[Rule] = [
    includes_follow_the_flow,
    the_door_is_small,
    sources_stand_where_their_headers_do,
    imports_go_down,
    imports_form_no_circle,
    extras_stand_on_public_names,
    names_say_what_a_file_holds,
    files_are_short,
    shown_code_is_narrow,
    kernels_call_no_libm,
    matrices_own_memory_of_malloc,
    builds_use_no_flag_that_changes_bits,
    version_is_the_same_everywhere,
    workflows_are_pinned,
]

if __name__ == "__main__":
    root = Path(__file__).parents[2]
    sys.exit("\n".join(breach for rule in RULES for breach in rule(root)) or None)
