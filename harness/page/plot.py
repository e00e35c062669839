"""A figure with what stands around it on a page."""

from dataclasses import dataclass

from harness.page.figure import Figure
from harness.page.legend import Key, keys


@dataclass(frozen=True)
class Plot:
    """A figure, named and described.

    Attributes:
        name: Identifies it on the page.
        summary: What it shows, in words, for who cannot see it.
    """

    name: str
    heading: str
    caption: str
    summary: str
    figure: Figure

    @property
    def legend(self) -> list[Key]:
        """What its colours and symbols mean."""
        return keys(self.figure)
