"""What a *.scenario.yaml says: values that are checked as they are read, and their JSON schema."""

from collections.abc import Iterator
from typing import Annotated, Any, Self

from pydantic import AfterValidator, Discriminator, Field, FiniteFloat, Tag, model_validator
from pydantic_core import PydanticCustomError

from harness.scenario.bound import Bound, Length, Part, Point, Share, Text
from harness.scenario.events import CommandEvent, Event
from harness.scenario.quantities import GOAL, check_name, names

Seed = Annotated[int, Field(ge=0)]
SCHEMA: dict[str, Any] = {"propertyNames": {"enum": list(names())}}


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


def _known(expect: dict[str, Any]) -> dict[str, Any]:
    for name in expect:
        problem = check_name(name)
        if problem is not None:
            raise _mistake(("expect", name), problem)
    return expect


class Goal(Part):
    """Where the rover is to arrive.

    Attributes:
        at: x and y in the world [m].
        yaw: Heading there [rad]; the driver `goal` turns to it.
        radius: How near is near enough [m].
    """

    at: Point
    yaw: FiniteFloat = 0.0
    radius: Length = 0.5


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
        terrain_size: Along x and y [m], of a terrain from a file that does not say it.
        terrain_height: Of the relief [m], likewise.
        start: x and y in the world [m], and the heading [rad]; where the terrain has it if left out.
        matrix: Instead of single values of those, lists.
        seed: Of the run; `seeds` is a number of seeds from 0 on, or a list.
        noise: Errors of the sensors; none if left out.
        goal: Where the rover is to arrive; the driver `goal` is told. See the quantity truth.goal_s.
        events: What happens on the way.
        expect: A bound, or a list of them, for each quantity.
        same_bytes: Whether the log must be that of the baseline, byte for byte.
        expected_to_fail: Why runs are known to fail.
        pass_rate: How many of the runs must pass.
    """

    about: Text
    robot: str = "leo"
    terrain: str = "rocky"
    terrain_size: tuple[Length, Length] | None = None
    terrain_height: Length | None = None
    difficulty: float | None = None
    start: tuple[float, float, float] | None = None
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
    expect: Annotated[dict[str, Bounds], AfterValidator(_known)] = Field(
        min_length=1, json_schema_extra=SCHEMA
    )
    same_bytes: bool = False
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

    @property
    def has_baseline(self) -> bool:
        """Whether runs are compared with recorded ones."""
        return self.same_bytes or any(bound.has_baseline for _, bound in self.bounds)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for problem in self._problems():
            raise problem
        return self

    def _problems(self) -> Iterator[PydanticCustomError]:
        late = f"after the run of {self.duration:g} s"
        for name in sorted(self.matrix.model_fields_set & self.model_fields_set):
            yield _mistake((name,), f"give one of {name} and matrix: {name}")
        if self.seeds is not None and "seed" in self.model_fields_set:
            yield _mistake(("seed",), "give one of seed and seeds")
        for name, bound in self.bounds:
            if bound.window is not None and bound.window[1] > self.duration:
                yield _mistake(("expect", name), f"a window to {bound.window[1]:g} s ends {late}")
            if name.startswith(GOAL) and self.goal is None:
                yield _mistake(("expect", name), "it needs a goal, e.g. goal: {at: [5, 0]}")
        for index, event in enumerate(self.events):
            if event.at >= self.duration:
                yield _mistake(("events", index), f"an event at {event.at:g} s is {late}")
            drivers = self.matrix.driver or (self.driver,)
            if isinstance(event, CommandEvent) and set(drivers) != {"cmd_vel"}:
                text = "commands need 'driver: cmd_vel'; others drive by themselves"
                yield _mistake(("events", index), text)


def _mistake(place: tuple[str | int, ...], message: str) -> PydanticCustomError:
    """A mistake that shows only beside another part of the file, and where it stands."""
    return PydanticCustomError("beside", "{message}", {"place": place, "message": message})
