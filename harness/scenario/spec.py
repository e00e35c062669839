"""What a *.scenario.yaml says: values that are checked as they are read, and their JSON schema."""

import re
from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, create_model

from harness.scenario.bound import Bound, Measure, Point, Share, Text
from harness.scenario.names import FORMS, MAP, OF_TARGET, PATTERN, POSE
from harness.scenario.quantities import check_name, names
from harness.scenario.steps import Event, Launched
from harness.spec.run import OWNERS, keys_of
from harness.spec.value import Finite, Length, Seed, Value, as_tuple

GROUP = re.compile(r"[?]P<.+?>")  # the name of a group, which JSON schemas do not know
SCHEMA: dict[str, Any] = {
    "propertyNames": {
        "anyOf": [
            {"enum": list(names())},
            {"pattern": f"^{PATTERN}$"},
            *(
                {"pattern": f"^{GROUP.sub('', form.pattern)}$"}
                for form in (OF_TARGET, FORMS[POSE], FORMS[MAP])
            ),
        ]
    }
}
MOST_RUNS = 100_000  # of one command


def _one_or_several(value: object) -> object:
    return as_tuple(value) if isinstance(value, list | tuple) else (value,)


def _known(name: str) -> str:
    if problem := check_name(name):
        raise ValueError(problem)
    return name


def _from_0_on(seeds: object) -> object:
    if not isinstance(seeds, int) or isinstance(seeds, bool):
        return as_tuple(seeds)
    if not 1 <= seeds <= MOST_RUNS:
        raise ValueError(f"{seeds} seeds are not valid; give 1 to {MOST_RUNS}, or a list of them")
    return tuple(range(seeds))


def _each_once(seeds: tuple[int, ...]) -> tuple[int, ...]:
    seed, times = Counter(seeds).most_common(1)[0]
    if times > 1:
        raise ValueError(f"seed {seed} is given {times} times, for the same run; leave it there once")
    return seeds


_Bounds = Annotated[tuple[Bound, ...], Field(min_length=1)]
Bounds = Annotated[_Bounds, BeforeValidator(_one_or_several, json_schema_input_type=Bound | _Bounds)]
_Measures = Annotated[tuple[Measure, ...], Field(min_length=1)]
Measures = Annotated[
    _Measures, BeforeValidator(_one_or_several, json_schema_input_type=Measure | _Measures)
]
_Seeds = Annotated[tuple[Seed, ...], Field(min_length=1)]
_Count = Annotated[int, Field(ge=1, le=MOST_RUNS)]
_Input = BeforeValidator(_from_0_on, json_schema_input_type=_Count | _Seeds)
Seeds = Annotated[_Seeds, _Input, AfterValidator(_each_once)]


class Goal(Value):
    """Where the rover is to arrive.

    Attributes:
        at: x and y in the world [m].
        yaw: Heading there [rad]; the driver `goal` turns to it.
        radius: How near is near enough [m].
    """

    at: Point
    yaw: Finite = 0.0
    radius: Length = 0.5


class ExpectedFailure(Value):
    """Why some runs are known to fail; a run of them that passes is reported.

    Attributes:
        reason: In a sentence.
        robot: Rover of the runs that are meant; of all if left out.
        terrain: Terrain of the runs that are meant; of all if left out.
    """

    reason: Text
    robot: str | None = None
    terrain: str | None = None


class PassRate(Value):
    """How many of the runs must pass; all if it is left out."""

    min: Share


class Matrix(Value):
    """Lists of values instead of single ones: every combination is run with every seed."""

    robot: tuple[str, ...] = ()
    terrain: tuple[str, ...] = ()
    difficulty: tuple[float, ...] = ()
    driver: tuple[str, ...] = ()
    noise: tuple[str | None, ...] = ()
    params: tuple[Text | None, ...] = ()
    soil: tuple[str | None, ...] = ()
    surface: tuple[str | None, ...] = ()
    actuators: tuple[str, ...] = ()


NOT_KEYS = (  # have other forms
    *("name", "faults", "seed", "duration"),
    *("drivers", "commands", "goals", "resets", "aborts", "resumes", "link_losses"),
)
if TYPE_CHECKING:
    RunKeys = Value
else:
    RunKeys = create_model(
        "RunKeys", __base__=Value, **keys_of(*(name for name in OWNERS if name not in NOT_KEYS))
    )


class Scenario(RunKeys):
    """A run with expectations: the fields of a run (harness.spec) are keys of it too.

    Files stand relative to the scenario's folder, if they are there.

    Attributes:
        about: What is checked, in a sentence.
        duration: Of the run [s].
        matrix: Lists instead of single values of some keys.
        seed: Of the run.
        seeds: A number of seeds from 0 on, or a list, instead of one.
        params: Parameter file of the metrics that judge the log; the defaults if left out.
        goal: Where the rover is to arrive; which the driver `goal` is given too.
        launch: Commands whose nodes hear the rover over ROS and are waited for.
        events: What happens on the way.
        expect: A bound, or a list of them, for each quantity.
        measure: How to sum up quantities that have no limits.
        compare: A name of the matrix: its first value is what the others are compared with, within each
            combination of all other values.
        same_bytes: Whether the log must be that of the baseline, byte for byte.
        expected_to_fail: Why runs are known to fail.
        pass_rate: How many of the runs must pass.
    """

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": [name]} for name in ("expect", "measure")]}
    )

    about: Text
    duration: Length = 30.0
    matrix: Matrix = Matrix()
    seed: Seed = 0
    seeds: Seeds | None = None
    params: Text | None = None
    goal: Goal | None = None
    launch: tuple[Launched, ...] = ()
    events: tuple[Event, ...] = ()
    expect: dict[Annotated[str, AfterValidator(_known)], Bounds] = Field(
        default={}, min_length=1, validate_default=False, json_schema_extra=SCHEMA
    )
    measure: dict[Annotated[str, AfterValidator(_known)], Measures] = Field(
        default={}, min_length=1, validate_default=False, json_schema_extra=SCHEMA
    )
    compare: str = ""
    same_bytes: bool = False
    expected_to_fail: tuple[ExpectedFailure, ...] = ()
    pass_rate: PassRate | None = None

    def run_values(self) -> dict[str, Any]:
        """Returns the fields of the run that the file gives, by name."""
        given = RunKeys.model_fields.keys() & self.model_fields_set
        return {name: getattr(self, name) for name in given} | {"duration": self.duration}

    @property
    def all_seeds(self) -> tuple[int, ...]:
        """Returns the seeds of the file."""
        return self.seeds or (self.seed,)

    @property
    def bounds(self) -> tuple[tuple[str, Bound], ...]:
        """Returns every bound with the name of its quantity."""
        return tuple((name, bound) for name, some in self.expect.items() for bound in some)

    @property
    def measured(self) -> tuple[tuple[str, Bound], ...]:
        """Returns every bound, and what is measured without one, with the name of its quantity."""
        more = ((name, one) for name, some in self.measure.items() for one in some)
        return (*self.bounds, *more)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Returns the quantities of which something is expected or measured, each once."""
        return tuple(dict.fromkeys(name for name, _ in self.measured))

    @property
    def needs_ros(self) -> bool:
        """Whether nodes are started or topics heard."""
        return bool(self.launch) or any(name.startswith(tuple(FORMS)) for name in self.quantities)

    @property
    def has_baseline(self) -> bool:
        """Whether runs are compared with recorded ones."""
        return self.same_bytes or any(bound.has_baseline for _, bound in self.bounds)
