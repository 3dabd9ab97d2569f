"""Writes the pages of the C++ reference: one for each folder of headers, from their comments.

A header begins with a comment that says what it is for; declarations have their own. Both are shown
as they are written, because their equations are laid out as text.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

ABOUT = re.compile(r"\A/// \\file\n((?:///.*\n)+)")
DIRECTIVE = re.compile(r"^#(?:.*\\\n)*.*\n", re.MULTILINE)
TITLES = {
    "scene": "Scenes", "effects": "Effects", "simulate": "Runs", "integrate": "Integrators",
    "dynamics": "Equations of motion", "analysis": "Analysis", "arithmetic": "Arithmetic",
    "text": "Messages",
}  # fmt: skip


def write(headers: Path, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, title in TITLES.items():
        found = sorted((headers / name).rglob("*.hpp"))
        text = [f"# {title}", "", f"Headers in `pendcore/{name}`.", ""]
        for header in found:
            text += section(headers / name, header)
        (folder / f"{name}.md").write_text("\n".join(text) + "\n")
    program = (headers.parents[2] / "tests/consumer/end_angles.cpp").read_text()
    about = INTRODUCTION.replace("{program}", program)
    lines = ["# C++", "", about, "", ":::{toctree}", ":maxdepth: 1", "", *TITLES, ":::"]
    (folder / "index.md").write_text("\n".join(lines) + "\n")


def section(home: Path, header: Path) -> list[str]:
    text = header.read_text()
    about = ABOUT.match(text)
    lines = [f"## {header.relative_to(home)}", ""]
    if about:
        lines += ["```text", *(line[4:] for line in about.group(1).splitlines()), "```", ""]
    code = text[about.end() :] if about else text
    code = DIRECTIVE.sub("", code)
    return [*lines, ":::{dropdown} Declarations", "```cpp", code.strip(), "```", ":::", ""]


INTRODUCTION = """The wheel and a clone install a C++20 library as well: headers, a static
library and a package for CMake. A project of yours needs five lines in its CMakeLists.txt:

```cmake
cmake_minimum_required(VERSION 3.25)
project(end_angles LANGUAGES CXX)
find_package(pendcore REQUIRED)
add_executable(end_angles end_angles.cpp)
target_link_libraries(end_angles PRIVATE pendcore::pendcore)
```

```cpp
{program}```

CMake finds the package that Python installed when it is told where:

```sh
python -c "import pendcore; print(pendcore.__path__[0])"   # the folder for the next line
cmake -B build -Dpendcore_ROOT=FOLDER
cmake --build build
build/end_angles   # 0x1.1543db799e83fp+0 0x1.13b11ee0b2be5p-1, the bits of Python
```
"""
