"""What a *.scenario.yaml says: values that are checked as they are read, and their JSON schema."""

from typing import Annotated, Any, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    FiniteFloat,
    StringConstraints,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError

Over = Literal["always", "end", "mean", "p95", "share"]
Seed = Annotated[int, Field(ge=0)]
Seconds = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Length = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0.0, le=1.0)]
Text = Annotated[str, StringConstraints(min_length=1, strip_whitespace=True)]
Point = tuple[FiniteFloat, FiniteFloat]


class Part(BaseModel):
    """A part of a scenario; it cannot be changed, and a key that it does not know is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Bound(Part):
    """What a quantity must keep.

    Attributes:
        min: Smallest allowed value; no limit if left out. Likewise `max`.
        over: What is compared: every value, the last one, the mean, the 95th percentile, or the share
            of values between min and max.
        share: With `over: share`, the smallest allowed share of values.
        window: First and last second that count; the whole run if left out.
    """

    min: float | None = Field(None, allow_inf_nan=False)
    max: float | None = Field(None, allow_inf_nan=False)
    over: Over = "always"
    share: Share | None = None
    window: tuple[Seconds, Seconds] | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.min is None and self.max is None:
            raise ValueError("neither min nor max is given: nothing is expected")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min {self.min:g} is above max {self.max:g}: no value can be right")
        if (self.over == "share") != (self.share is not None):
            raise ValueError("'over: share' and 'share: 0 to 1' belong together")
        if self.window is not None and not self.window[0] < self.window[1]:
            raise ValueError(f"window {list(self.window)} does not begin before it ends")
        return self


class Goal(Part):
    """Where the rover is to arrive.

    Attributes:
        at: x and y in the world [m].
        radius: How near is near enough [m].
    """

    at: Point
    radius: Length = 0.5


class FaultEvent(Part):
    """A sensor fault, e.g. `{at: 5, fault: "scan:dropout", for: 3}`.

    Attributes:
        at: When it begins [s].
        fault: SENSOR:FAULT[=VALUE].
        length: How long it lasts [s], in the file `for`; to the end if left out.
    """

    at: Seconds
    fault: Annotated[str, StringConstraints(pattern=r"^[^@+]+$")]
    length: Length | None = Field(None, alias="for")

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


def _kind(event: Any) -> str | None:  # noqa: ANN401 - anything that stands in a file
    """Which event it is: the mistakes that are told are those of that one alone."""
    names = event if isinstance(event, dict) else type(event).model_fields
    return next((name for name in ("fault", "command", "reset") if name in names), None)


Event = Annotated[
    Annotated[FaultEvent, Tag("fault")]
    | Annotated[CommandEvent, Tag("command")]
    | Annotated[ResetEvent, Tag("reset")],
    Discriminator(_kind),
]


def _plural(value: object) -> str:
    return "list" if isinstance(value, list | tuple) else "one"


Bounds = Annotated[
    Annotated[Bound, Tag("one")] | Annotated[tuple[Bound, ...], Tag("list"), Field(min_length=1)],
    Discriminator(_plural),
]
Seeds = Annotated[
    Annotated[int, Tag("one"), Field(ge=1)]
    | Annotated[tuple[Seed, ...], Tag("list"), Field(min_length=1)],
    Discriminator(_plural),
]


class ExpectedFailure(Part):
    """Why some runs are known to fail; whoever mends that is told by the run that passes.

    Attributes:
        reason: In a sentence.
        robot: Which runs are meant; all if none of these is given. Likewise `terrain`.
    """

    reason: Text
    robot: str | None = None
    terrain: str | None = None


class PassRate(Part):
    """How many of the runs must pass; all if it is left out."""

    min: Share


class Matrix(Part):
    """Lists of values instead of single ones: every combination is run with every seed."""

    robot: tuple[str, ...] = ()
    terrain: tuple[str, ...] = ()
    difficulty: tuple[float, ...] = ()
    driver: tuple[str, ...] = ()
    noise: tuple[str | None, ...] = ()


class Scenario(Part):
    """A run with expectations.

    Attributes:
        about: What is checked, in a sentence.
        robot: See `python -m harness.run --list`; likewise `terrain` (or a file) and `driver`.
        matrix: Instead of single values of those, lists.
        seed: Of the run; `seeds` is a number of seeds from 0 on, or a list.
        noise: Errors of the sensors; none if left out.
        goal: Where the rover is to arrive; see the quantity truth.goal_s.
        events: What happens on the way.
        expect: A bound, or a list of them, for each quantity.
        expected_to_fail: Why runs are known to fail.
        pass_rate: How many of the runs must pass.
    """

    about: Text
    robot: str = "leo"
    terrain: str = "rocky"
    difficulty: float | None = None
    driver: str = "wander"
    duration: float = 30.0
    matrix: Matrix = Matrix()
    seed: Seed = 0
    seeds: Seeds | None = None
    noise: str | None = None
    lidar_beams: int | None = None
    imu_rate: int | None = None
    goal: Goal | None = None
    events: tuple[Event, ...] = ()
    expect: dict[str, Bounds] = Field(min_length=1)
    expected_to_fail: tuple[ExpectedFailure, ...] = ()
    pass_rate: PassRate | None = None

    @property
    def all_seeds(self) -> tuple[int, ...]:
        """Returns the seeds of the file."""
        if self.seeds is None:
            return (self.seed,)
        return tuple(range(self.seeds)) if isinstance(self.seeds, int) else self.seeds

    @property
    def bounds(self) -> tuple[tuple[str, Bound], ...]:
        """Returns every bound with the name of its quantity."""
        return tuple(
            (name, bound)
            for name, some in self.expect.items()
            for bound in (some if isinstance(some, tuple) else (some,))
        )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        length = f"after the run of {self.duration:g} s"
        for name, bound in self.bounds:
            if bound.window is not None and bound.window[0] >= self.duration:
                raise _mistake(
                    ("expect", name), f"a window from {bound.window[0]:g} s on begins {length}"
                )
            if name.startswith("truth.goal") and self.goal is None:
                raise _mistake(("expect", name), "needs a goal, e.g. goal: {at: [5, 0]}")
        for index, event in enumerate(self.events):
            if event.at >= self.duration:
                raise _mistake(("events", index), f"an event at {event.at:g} s is {length}")
            if isinstance(event, CommandEvent) and {self.driver, *self.matrix.driver} != {"cmd_vel"}:
                raise _mistake(
                    ("events", index), "commands need 'driver: cmd_vel'; others drive by themselves"
                )
        return self


def _mistake(place: tuple[str | int, ...], message: str) -> PydanticCustomError:
    """A mistake that shows only beside another part of the file, and where it stands."""
    return PydanticCustomError("beside", "{message}", {"place": place, "message": message})
