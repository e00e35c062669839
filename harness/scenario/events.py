"""What happens on the way: sensor faults, commands, resets and pauses at simulated times."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StringConstraints, Tag

from harness.scenario.bound import Length, Part, Point, Seconds


class FaultEvent(Part):
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


class CommandEvent(Part):
    """A command for `driver: cmd_vel`: speed [m/s] and yaw rate [rad/s] from a time on."""

    at: Seconds
    command: Point


class ResetEvent(Part):
    """The rover is put back to its start."""

    at: Seconds
    reset: Literal[True]


class PauseEvent(Part):
    """Time stands still: /clock tells its last time again, every 10 ms of so many seconds."""

    at: Seconds
    pause: Length


EVENTS: dict[str, type[Part]] = {
    "fault": FaultEvent,
    "command": CommandEvent,
    "reset": ResetEvent,
    "pause": PauseEvent,
}


def _kind(event: Any) -> str | None:  # noqa: ANN401 - anything that stands in a file
    """Which event it is: the mistakes that are told are those of that one alone."""
    names = event if isinstance(event, dict) else getattr(type(event), "model_fields", ())
    return next((name for name in EVENTS if name in names), None)


Event = Annotated[
    Annotated[FaultEvent, Tag("fault")]
    | Annotated[CommandEvent, Tag("command")]
    | Annotated[ResetEvent, Tag("reset")]
    | Annotated[PauseEvent, Tag("pause")],
    Discriminator(_kind),
]
