"""Case files for programs that read them: their keys, and messages that name file and line."""

from __future__ import annotations

from pendcore._cases.case_file import KEYS, text_of, with_line
from pendcore._cases.toml_text import TomlText

__all__ = ["KEYS", "TomlText", "text_of", "with_line"]
