"""A mutant. What makes them takes half a second to load."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """One small change of one module.

    Attributes:
        file: From the root.
        function: Qualified name of what it is in; empty at the module's level.
        start, end: What is replaced, in characters from the beginning.
        new: What replaces it.
        line: The lines that it changes, in one.
        becomes: What they become.
        number: Number of the first of these lines.
    """

    file: str
    function: str
    start: int
    end: int
    new: str
    line: str
    becomes: str
    number: int

    @property
    def key(self) -> tuple[str, str, str, str]:
        """What it is, wherever in the file it stands."""
        return self.file, self.function, self.line, self.becomes

    def apply(self, source: str) -> str:
        """The module with the change."""
        return source[: self.start] + self.new + source[self.end :]
