"""The equations of motion derived in symbols, as the textbook derives them, with SymPy.

    import pendcore as pc

    derivation = pc.derive.Derivation.textbook()
    print(derivation)                    # every step, from the positions to the first-order form
    derivation.accelerations             # sympy expressions
    print(derivation.to_octave())        # RR.m

The derivation takes nothing from the compiled core, and so it checks the core.
"""

from __future__ import annotations

try:
    import sympy  # noqa: F401
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        f"pendcore.derive needs {error.name}, which is not installed: pip install {error.name}",
        name=error.name,
    ) from None

from pendcore.derive.derivation import Derivation
from pendcore.derive.notation import Notation, Parameter
from pendcore.derive.step import Equation, Formula, Step

__all__ = ["Derivation", "Equation", "Formula", "Notation", "Parameter", "Step"]
