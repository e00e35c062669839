"""A console that prints text as text: a name in somebody's file is no markup, and moves no cursor."""

import os
from typing import Any

from rich.console import Console, RenderableType
from rich.status import Status
from rich.text import Text

PRINTED_WIDTH = 160  # characters where no terminal says how many there are


class PlainConsole(Console):
    """Rich's console without markup, emoji codes, highlighting and control characters in text.

    A pipe or a file takes lines as wide as a table; a terminal, or COLUMNS, says how wide it is.
    Markup stands in literals of this project alone: `print(..., markup=True)`, with numbers alone.
    """

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - those of Console
        super().__init__(**{"markup": False, "emoji": False, "highlight": False} | options)
        if not (self.is_terminal or "width" in options or "COLUMNS" in os.environ):
            self.width = PRINTED_WIDTH

    def render_str(self, text: str, **options: Any) -> Text:  # noqa: ANN401 - those of Console
        """Returns what is printed for a text, with a ? for each control character."""
        shown = "".join(c if c.isprintable() or c in "\n\t" else "?" for c in text)
        return super().render_str(shown, **options)

    def status(self, status: RenderableType, **options: Any) -> Status:  # noqa: ANN401 - those of Console
        """Returns a line that turns while something is done; rich would take a text for markup."""
        return super().status(self.render_str(status) if isinstance(status, str) else status, **options)
