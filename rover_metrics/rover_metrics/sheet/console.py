"""A console that prints text as text: a name in somebody's file is no markup, and moves no cursor."""

from typing import Any

from rich.console import Console, RenderableType
from rich.status import Status
from rich.text import Text


class PlainConsole(Console):
    """Rich's console without markup, emoji codes, highlighting and control characters in text.

    Markup stands in literals of this project alone: `print(..., markup=True)`, with numbers alone.
    """

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - those of Console
        super().__init__(**{"markup": False, "emoji": False, "highlight": False} | options)

    def render_str(self, text: str, **options: Any) -> Text:  # noqa: ANN401 - those of Console
        """Returns what is printed for a text, with a ? for each control character."""
        shown = "".join(c if c.isprintable() or c in "\n\t" else "?" for c in text)
        return super().render_str(shown, **options)

    def status(self, status: RenderableType, **options: Any) -> Status:  # noqa: ANN401 - those of Console
        """Returns a line that turns while something is done; rich would take a text for markup."""
        return super().status(self.render_str(status) if isinstance(status, str) else status, **options)
