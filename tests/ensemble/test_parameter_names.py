"""Names of parameters that the scene does not have: what was meant is told."""

from __future__ import annotations

import pendcore as pc
import pytest
from test_ensemble import BOOK, DAMPED

E = pc.effects


def test_a_parameter_of_another_part_is_named():
    with pytest.raises(ValueError, match=r'did you mean "effect\[1\].damping"'):
        DAMPED.with_parameters({"link[1].damping": 0.1})
    shaken = BOOK.replace(effects=[E.DrivenPivot(x=E.Sinusoid(0.1, 9.0))])
    with pytest.raises(ValueError, match=r'did you mean "effect\[1\].x.amplitude"'):
        shaken.with_parameters({"effect[1].x": 0.1})


def test_a_name_that_is_no_text_is_refused():
    with pytest.raises(TypeError, match="parameter 1: must be a name, such as"):
        pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 1), vary={1: [1.0]})
    with pytest.raises(TypeError, match="parameter 1: must be a name, such as"):
        BOOK.with_parameters({1: 1.0})
