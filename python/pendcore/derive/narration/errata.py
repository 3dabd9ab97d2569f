"""Where the textbook prints something else; docs/reference/errata.md shows each by computation."""

from __future__ import annotations

UPWARD = "as if $y$ pointed upward. It points downward, and the weight is positive."

REMARKS = {
    "2.2": f"The textbook prints $-m_{{1}} g L_{{1}}/2 \\cos q_{{1}}$, {UPWARD}",
    "y of 2.5": f"The textbook prints $-m_{{2}} g$, {UPWARD}",
    "2.5": "The textbook prints $m$ for $m_{2}$.",
    "2.7": f"The textbook prints $-m_{{2}} g$, {UPWARD}",
    "2.8": "The textbook prints both terms with the opposite sign, which is not what the "
    "determinant in (2.5) gives.",
    "2.9": "The textbook prints the same. It is right for $y$ downward, but does not follow from "
    "the (2.7) printed there.",
    "2.10": "The textbook prints $m_{2} L_{1}^{2}/3$ on the left, for $m_{1} L_{1}^{2}/3$, and "
    "$-m_{1} g L_{1}/2 \\cos q_{1}$.",
    "2.11": "The textbook prints the right side with the opposite sign, which it has from (2.8).",
}
