"""Everything that determines a drive, as one frozen value."""

import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Self

from pydantic import AfterValidator, Field, model_validator
from pydantic.fields import FieldInfo

from harness.base.errors import UsageError, unknown
from harness.base.sim_time import (
    DEFAULT_TIMESTEP_NS,
    NANOSECONDS,
    TICK_NS,
    TICKS_PER_CONTROL,
    check_duration,
    parse_timestep,
)
from harness.base.streams import FLEET, seeded
from harness.spec.plan import Plan
from harness.spec.rover import RoverSetup
from harness.spec.value import Option, Seed, Value, checked, made
from harness.spec.world import WorldSpec

MOST_ROVERS = 16


class Run(Value):
    """Everything that determines a drive: the same value gives the same bytes.

    Attributes:
        world: Where it takes place.
        rovers: Who drives there; the first one's clearance sorts the obstacles of a file.
        plan: What happens on the way.
        duration: Simulated time [s], whole clock ticks of 10 ms.
        timestep: Of the physics [s]; it divides the clock tick.
        seed: Of everything random.
    """

    world: WorldSpec = WorldSpec.model_construct()
    rovers: tuple[RoverSetup, ...] = Field(
        default=(RoverSetup.model_construct(),), min_length=1, max_length=MOST_ROVERS
    )
    plan: Plan = Plan.model_construct()
    duration: Annotated[float, AfterValidator(checked(check_duration)), Option("S")] = Field(
        default=60.0, description="simulated seconds"
    )
    timestep: Annotated[float, AfterValidator(checked(parse_timestep)), Option("S")] = Field(
        default=DEFAULT_TIMESTEP_NS / NANOSECONDS, description="physics step [s]"
    )
    seed: Annotated[Seed, Option("N")] = Field(default=0, description="of everything random")

    @classmethod
    def of(cls, **values: Any) -> "Run":  # noqa: ANN401 - as the fields are
        """Returns a run of one rover from the names of all fields, in whatever part they stand.

        Args:
            values: Fields of Run, WorldSpec, RoverSetup and Plan, as values or as text, e.g.
                terrain="posts", robot="leo", faults=["scan:dropout@2"], seed=3.

        Raises:
            UsageError: One does not exist or is not valid.
        """
        return from_fields(cls(), values)

    @property
    def rover(self) -> RoverSetup:
        """The first rover, the only one of most runs."""
        return self.rovers[0]

    def check_single(self) -> None:
        """Raises UsageError if several rovers drive, for what has one episode, one result, one trial."""
        if len(self.rovers) > 1:
            names = ", ".join(rover.name for rover in self.rovers)
            raise UsageError(
                f"this drives a single rover, not {names}; give a run of one, or use harness.run --rover"
            )

    @property
    def total_ticks(self) -> int:
        """Clock ticks from start to end."""
        return round(self.duration * NANOSECONDS) // TICK_NS

    @property
    def total_periods(self) -> int:
        """Control periods from start to end, which is how many batches there are."""
        return math.ceil(self.total_ticks / TICKS_PER_CONTROL)

    @property
    def timestep_ns(self) -> int:
        """Physics step [ns]."""
        return parse_timestep(self.timestep)

    def own_seed(self, number: int) -> int:
        """Returns the seed of what is random about the rover at a place; of the first one, `seed`."""
        if number == 0:
            return self.seed
        return int.from_bytes(seeded(self.seed, FLEET, number).generate_state(4).tobytes(), "little")

    def alone(self, **changes: Any) -> "Run":  # noqa: ANN401 - as the fields are
        """Returns the same run with other values of some fields, by the names that `of` takes."""
        return from_fields(self, changes)

    def fields(self, number: int = 0) -> dict[str, Any]:
        """Returns what determines the part of the rover at a place, by `of`'s names, as JSON values."""
        parts = (self.world, self.rovers[number], self.plan, self)
        return {
            name: value
            for part in parts
            for name, value in part.model_dump(mode="json", exclude=set(PARTS)).items()
        }

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        for time in self.plan.times:
            if time >= self.duration:
                raise ValueError(f"an event at {time:g} s is not in the run of {self.duration:g} s")
        names = [rover.name for rover in self.rovers]
        for number, name in enumerate(names):
            if name in names[:number]:
                raise ValueError(
                    f"two rovers are called '{name}'; give each a name of its own: ROBOT:NAME"
                )
        for fault in (fault for rover in self.rovers for fault in rover.faults):
            if (fault.start or 0.0) > self.duration:
                raise ValueError(
                    f"fault '{fault}' begins after the end of the run at {self.duration:g} s; "
                    "begin it earlier, or give a longer --duration"
                )
        return self


PARTS: dict[str, type[Value]] = {"world": WorldSpec, "rovers": RoverSetup, "plan": Plan}


ALL_PARTS = PARTS | {"": Run}
# The part of a run that has a field, by the name of each; "" for the run itself.
OWNERS = {n: part for part, cls in ALL_PARTS.items() for n in cls.model_fields if n not in PARTS}


def keys_of(*names: str) -> dict[str, tuple[Any, FieldInfo]]:
    """Returns fields of a run, of whatever part, as pydantic's `create_model` takes them."""
    fields = {name: ALL_PARTS[OWNERS[name]].model_fields[name] for name in names}
    return {name: (field.annotation, field) for name, field in fields.items()}


def from_fields(run: Run, changes: Mapping[str, Any], name: Callable[[str], str] = str) -> "Run":
    """Returns a run in which some fields have other values.

    Args:
        run: The run; its first rover's fields are changed.
        changes: By name, of whatever part; text is converted.
        name: How a user calls a field, for messages, e.g. by a flag.

    Raises:
        UsageError: One does not exist or is not valid.
    """
    given: dict[str, dict[str, Any]] = {part: {} for part in ALL_PARTS}
    for key, value in changes.items():
        if key not in OWNERS:
            raise UsageError(unknown("key", name(key), map(name, OWNERS)))
        given[OWNERS[key]][key] = value
    parts: dict[str, Any] = {
        "world": made(WorldSpec, run.world.__dict__ | given["world"], name=name),
        "plan": made(Plan, run.plan.__dict__ | given["plan"], name=name),
        "rovers": (made(RoverSetup, run.rover.__dict__ | given["rovers"], name=name), *run.rovers[1:]),
    }
    return made(type(run), run.__dict__ | parts | given[""], name=name)
