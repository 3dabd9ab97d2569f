"""Where the textbook prints something else; docs/errata.md shows each by computation."""

from __future__ import annotations

UPWARD = "as if y pointed upward; downward, as chosen, the weight is positive."

REMARKS = {
    "2.2": f"The textbook prints -m1 g L1/2 cos q1, {UPWARD}",
    "y of 2.5": f"The textbook prints -m2 g, {UPWARD}",
    "2.5": "The textbook prints m for m2.",
    "2.7": f"The textbook prints -m2 g, {UPWARD}",
    "2.8": "The textbook prints both terms with the opposite sign, which is not what the "
    "determinant in (2.5) gives.",
    "2.9": "As the textbook prints it: right for y downward, though it does not follow from the "
    "(2.7) printed there.",
    "2.10": "The textbook prints m2 L1^2/3 on the left, for m1 L1^2/3, and -m1 g L1/2 cos q1.",
    "2.11": "The textbook prints the right side with the opposite sign, which comes from (2.8).",
}
