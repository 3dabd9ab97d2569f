"""The one class of warning that pendcore gives."""

from __future__ import annotations


class PendcoreWarning(UserWarning):
    """Something is allowed and looks wrong: the message names it, and why."""
