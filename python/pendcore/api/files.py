"""Functions that read solutions and cases from files."""

from __future__ import annotations

import os

from pendcore.api.scene import Scene
from pendcore.api.solution import Case, Solution
from pendcore.api.solve import result_as
from pendcore.cases import archive
from pendcore.cases.case_file import case_from
from pendcore.messages.arguments import known_keywords
from pendcore.scene.scene import SceneData


@known_keywords
def load(path: str | os.PathLike[str]) -> Solution:
    """Read a solution that `Solution.save` wrote.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    Solution
        With every number of the saved one to the last bit; it evaluates and resumes as that did.

    Raises
    ------
    ValueError
        If the file is no such solution.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> sol = pc.Case.textbook().simulate()
    >>> sol.save("run.npz")
    >>> longer = pc.load("run.npz").resume(10.0)
    >>> f"to {longer.t[-1]:.0f} s"
    'to 10 s'
    """
    result = archive.load(path)
    result.scene = _public(result.scene)
    return result_as(Solution, result)


@known_keywords
def read_case(source: str | os.PathLike[str]) -> Case:
    """Read a case from TOML.

    Parameters
    ----------
    source : path or str
        A file, or the text itself: a string with a line break is text.

    Returns
    -------
    Case

    Raises
    ------
    ValueError
        If the text is not TOML, a key is unknown or missing, or a value is not what its key asks
        for. The message names the line and, for an unknown key, the nearest known one.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> with open("textbook.toml", "w") as file:
    ...     size = file.write(pc.Case.textbook().to_toml())
    >>> pc.read_case("textbook.toml") == pc.Case.textbook()
    True
    """
    case = case_from(source)
    return Case(
        scene=_public(case.scene), q0=case.q0, qd0=case.qd0, t_span=case.t_span, name=case.name,
        options=case.options,
    )  # fmt: skip


def _public(scene: SceneData) -> Scene:
    return Scene._unpickled(scene.links, scene.gravity, scene.effects)
