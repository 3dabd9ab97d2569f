"""The options of a run: name, type, unit, range, default and a sentence for each.

    import pendcore.options

    pendcore.options.OPTIONS["rtol"].default

The core has a descriptor of each option that it knows (cpp/include/pendcore/options.hpp); the four
that only Python knows stand here. The signature and docstring of `pendcore.simulate`, the checks of
cases, and the tables in the documentation are made from them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from inspect import Parameter, signature
from textwrap import fill
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict, TypeVar

import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import require_known
from pendcore._messages.progress import Progress
from pendcore.events import Event
from pendcore.methods import sentences

Function = TypeVar("Function", bound=Callable[..., Any])
OnFailure: TypeAlias = Literal["warn", "raise", "ignore"]


class RunKeywords(TypedDict, total=False):
    """What `pendcore.simulate` takes by name, for type checkers and editors.

    docs/generators/write_options.py writes them from the descriptors.
    """

    method: str
    rtol: npt.ArrayLike
    atol: npt.ArrayLike
    t_eval: npt.ArrayLike | None
    store: str | None
    first_step: float | None
    max_step: float
    step: float | None
    max_steps: int
    time_limit: float | None
    events: Iterable[Event]
    ledger: bool
    compensated: bool
    error: float | None
    sensitivities: Iterable[str] | None
    on_failure: OnFailure
    progress: Progress


class RunOption(NamedTuple):
    """The descriptor of an option."""

    name: str
    annotation: str
    """The keyword, and how Python annotates what may be given."""
    sentence: str
    """What it is, in reStructuredText."""
    default: Any = None
    """What holds if it is not given."""
    if_none: str = ""
    """What a run does where that is None."""
    type: str = ""
    """What docstrings say may be given; empty where it is the annotation."""
    unit: str = ""
    range: str = ""
    """The unit and the allowed range of a number; either may be empty."""
    chosen_for_error: bool = False
    """Whether ``simulate(error=...)`` chooses it."""
    limits_every_method: bool = False
    """Whether a comparison of methods gives it to each of them."""


ERROR = RunOption(
    "error",
    "float | None",
    "The largest allowed error of the positions, as a share of the total length. It takes the "
    "place of ``method``, ``rtol``, ``atol`` and ``step``: pendcore chooses these and verifies the "
    "run, from its defect or by better runs. The error is the largest distance of a joint or the "
    "tip from its true place, over the whole curve of a run with dense output, otherwise over the "
    "times that the run keeps. ``sol.accuracy`` says what was reached and what it cost; "
    "``docs/background/accuracy_cost.md`` says what is promised.",
    range="> 0 and < 1",
    if_none="no error is verified",
)
SENSITIVITIES = RunOption(
    "sensitivities",
    "Iterable[str] | None",
    'Names of what the run depends on: ``"q0[1]"``, ``"qd0[2]"``, ``"torque[1]"``, ``"pivot.x"`` '
    "(a constant acceleration, m/s^2), or any of `Scene.parameters`. ``sol.sensitivities`` has the "
    "derivatives of the states by them, from the variational equations along the run, through "
    "impacts, stick and release, or NaN from where there are none on, with a warning that says "
    "why; a `pendcore.effects.User` is differentiated by central differences, to some ten digits.",
    type="iterable of str",
    if_none="no derivatives are found",
)
ON_FAILURE = RunOption(
    "on_failure",
    "OnFailure",
    "What to do if the run does not reach its end, or if the time limit is up before the ``error`` "
    "is verified: warn, raise a `RunError`, or say nothing, and then look at ``sol.success``.",
    default="warn",
    type='{"warn", "raise", "ignore"}',
)
PROGRESS = RunOption(
    "progress",
    "Progress",
    "Whether to show a bar, at once or never.\nA callable receives the fraction done, from 0 to 1.",
    type="bool or callable",
    if_none="a bar after a second, on a terminal",
)
_EVERY = [RunOption(**told) for told in _core.run_options()]
_EVERY += [ERROR, SENSITIVITIES, ON_FAILURE, PROGRESS]
OPTIONS = {one.name: one for one in _EVERY}
"""By name, in the order of the signature."""
RUN_DEFAULTS = {name: option.default for name, option in OPTIONS.items()}


def atol_beside(rtol: float) -> float:
    """Return the absolute tolerance, rad and rad/s, of runs of which rtol alone is chosen."""
    return float(f"{rtol / 1000:g}")


def require_options(given: Iterable[str], function: Callable[..., Any]) -> None:
    """Raise a TypeError for a keyword that is none of a function's, whose options are shown."""
    require_known(function.__name__, given, signature(function).parameters)


def with_options(
    wanted: Callable[[RunOption], bool] = lambda option: True,
) -> Callable[[Function], Function]:
    """Show the options in the signature of a function, and for ``{options}`` in its docstring.

    The function takes them as ``**options``; ``wanted`` says which.
    """
    listed = [option for option in OPTIONS.values() if wanted(option)]

    def described(function: Function) -> Function:
        own = signature(function)
        first = [one for one in own.parameters.values() if one.kind is not Parameter.VAR_KEYWORD]
        by_name = partial(Parameter, kind=Parameter.KEYWORD_ONLY)
        options = [by_name(x.name, default=x.default, annotation=x.annotation) for x in listed]
        shown: Any = function
        shown.__signature__ = own.replace(parameters=[*first, *options])
        if function.__doc__ is not None:  # python -OO has none
            before = function.__doc__.partition("{options}")[0]
            margin = " " * (len(before) - len(before.rstrip(" ")))
            lines = "\n".join(_documented(listed, margin)).lstrip()
            function.__doc__ = function.__doc__.replace("{options}", lines)
        return function

    return described


def _documented(options: list[RunOption], margin: str) -> Iterator[str]:
    inner = margin + "    "
    for one in options:
        type_text = one.type or one.annotation.removesuffix(" | None")
        yield f"{margin}{one.name} : {type_text}{', optional' * (one.default is None)}"
        about = ", ".join(filter(None, (one.unit, one.range)))
        about = f"{about}. " if about else ""
        if_none = f" Default: {one.if_none}." if one.default is None else ""
        for paragraph in f"{about}{one.sentence}{if_none}".split("\n"):
            for text in sentences() if paragraph == "{methods}" else [paragraph]:
                yield fill(text, 100, initial_indent=inner, subsequent_indent=inner)


__all__ = [
    "OPTIONS",
    "RUN_DEFAULTS",
    "OnFailure",
    "RunKeywords",
    "RunOption",
    "atol_beside",
    "require_options",
    "with_options",
]
__dir__ = __all__.copy
