"""Commands that a scenario starts, and the nodes of theirs that it waits for."""

import shlex
from typing import Annotated

from pydantic import AfterValidator, Discriminator, Field, Tag

from harness.scenario.bound import FullName, Part, Text

FOLDER = "{folder}"  # in a word: a folder of the run's own


def _splits(line: str) -> str:
    shlex.split(line)  # ValueError: No closing quotation
    return line


def _form(value: object) -> str:
    if isinstance(value, list | tuple):
        return "list"
    return "one" if isinstance(value, str) else "part"


Line = Annotated[Text, AfterValidator(_splits), Tag("one")]
Words = Annotated[tuple[Text, ...], Field(min_length=1), Tag("list")]
Command = Annotated[Line | Words, Discriminator(_form)]
Nodes = Annotated[
    Annotated[FullName, Tag("one")] | Annotated[tuple[FullName, ...], Tag("list")],
    Discriminator(_form),
]


class Launch(Part):
    """A command, and what of it is waited for.

    Attributes:
        command: Its words, or a line that is split as a shell does; no shell runs it. "{folder}" stands
            for a folder of the run's own.
        wait_for: Its nodes that must have handled everything before time goes on, by their full names;
            if left out, one, whatever its name. An empty list waits for none, and the command may end.
    """

    command: Command
    wait_for: Nodes | None = None

    @property
    def nodes(self) -> tuple[str, ...] | None:
        """Returns the names of `wait_for`; None if it was left out."""
        return (self.wait_for,) if isinstance(self.wait_for, str) else self.wait_for

    def words(self, folder: str) -> list[str]:
        """Returns the words of the command, in the folder of a run."""
        words = shlex.split(self.command) if isinstance(self.command, str) else self.command
        return [word.replace(FOLDER, folder) for word in words]


Launched = Annotated[Line | Words | Annotated[Launch, Tag("part")], Discriminator(_form)]


def launch_of(entry: Launch | str | tuple[str, ...]) -> Launch:
    """Returns an entry of `launch:`, which may be a command alone."""
    return entry if isinstance(entry, Launch) else Launch(command=entry)
