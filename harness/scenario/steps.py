"""What a scenario does beside driving: events at simulated times, and commands that it starts."""

import shlex
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, StringConstraints, Tag

from harness.scenario.bound import FullName, Point, Text
from harness.spec.value import Length, Seconds, Value, as_tuple


class FaultEvent(Value):
    """A sensor fault, e.g. `{at: 5, fault: "scan:dropout", for: 3}`.

    Attributes:
        at: When it begins [s].
        fault: SENSOR:FAULT[=VALUE].
        length: How long it lasts [s], in the file `for`; to the end if left out.
    """

    at: Seconds
    fault: Annotated[str, StringConstraints(pattern=r"^[^@+]+$")]
    length: Length | None = Field(default=None, alias="for")

    @property
    def spec(self) -> str:
        """Returns the fault as `--fault` takes it."""
        return f"{self.fault}@{self.at!r}" + ("" if self.length is None else f"+{self.length!r}")


class CommandEvent(Value):
    """A command for `driver: cmd_vel`: speed [m/s] and yaw rate [rad/s] from a time on."""

    at: Seconds
    command: Point


class ResetEvent(Value):
    """The rover is put back to its start."""

    at: Seconds
    reset: Literal[True]


class PauseEvent(Value):
    """Time stands still: /clock tells its last time again, every 10 ms of so many seconds."""

    at: Seconds
    pause: Length


class AbortEvent(Value):
    """The rover stands still from then on, whatever its driver wants."""

    at: Seconds
    abort: Literal[True]


class ResumeEvent(Value):
    """The rover drives on; the way point of its route that is in hand is given again."""

    at: Seconds
    resume: Literal[True]


class LinkLossEvent(Value):
    """No command reaches the rover for so many seconds: the last one holds, or its time-out ends it."""

    at: Seconds
    link_loss: Length


EVENTS: dict[str, type[Value]] = {
    "fault": FaultEvent,
    "command": CommandEvent,
    "reset": ResetEvent,
    "pause": PauseEvent,
    "abort": AbortEvent,
    "resume": ResumeEvent,
    "link_loss": LinkLossEvent,
}


def _kind(event: Any) -> str | None:  # noqa: ANN401 - anything that stands in a file
    """Which event it is: the mistakes that are told are those of that one alone."""
    names = event if isinstance(event, dict) else getattr(type(event), "model_fields", ())
    return next((name for name in EVENTS if name in names), None)


Event = Annotated[
    Annotated[FaultEvent, Tag("fault")]
    | Annotated[CommandEvent, Tag("command")]
    | Annotated[ResetEvent, Tag("reset")]
    | Annotated[PauseEvent, Tag("pause")]
    | Annotated[AbortEvent, Tag("abort")]
    | Annotated[ResumeEvent, Tag("resume")]
    | Annotated[LinkLossEvent, Tag("link_loss")],
    Discriminator(_kind),
]


FOLDER = "{folder}"  # in a word: a folder of the run's own


def _words(command: object) -> object:
    return tuple(shlex.split(command)) if isinstance(command, str) else as_tuple(command)


def _several(nodes: object) -> object:
    return (nodes,) if isinstance(nodes, str) else as_tuple(nodes)


def _alone(entry: object) -> object:
    return {"command": entry} if isinstance(entry, str | list | tuple) else entry


_Words = Annotated[tuple[Text, ...], Field(min_length=1)]
Words = Annotated[_Words, BeforeValidator(_words, json_schema_input_type=Text | _Words)]
_Nodes = tuple[FullName, ...]
Nodes = Annotated[_Nodes, BeforeValidator(_several, json_schema_input_type=FullName | _Nodes)]


class Launch(Value):
    """A command, and what of it is waited for.

    Attributes:
        command: Its words, or a line that is split as a shell does; no shell runs it. "{folder}" stands
            for a folder of the run's own.
        wait_for: Its nodes that must have handled everything before time goes on, by their full names;
            if left out, one, whatever its name. An empty list waits for none, and the command may end.
    """

    command: Words
    wait_for: Nodes | None = None

    def words(self, folder: str) -> list[str]:
        """Returns the words of the command, in the folder of a run."""
        return [word.replace(FOLDER, folder) for word in self.command]


Launched = Annotated[Launch, BeforeValidator(_alone, json_schema_input_type=Text | _Words | Launch)]
