"""What can be expected of a run: quantities by name."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from typing import NamedTuple

from harness.base.errors import unknown
from harness.episode.mission import MissionState
from harness.page.run.log import NOTES_COLUMN, TIME_COLUMN
from harness.samples import ContactKind, SoilState, Truth, TruthState
from harness.scenario.names import FORMS, OF_TARGET, check_heard
from rover_metrics.core.columns import COLUMNS
from rover_metrics.extended.metrics import ALL_COLUMNS
from rover_metrics.plugins import Table, takes

NO_VALUE = "there is no value"
SAMPLED = 0.05  # [s] between two values of the truth


class Snapshot(NamedTuple):
    """What the simulator knows at the end of a control period of 50 ms.

    Attributes:
        truth: Totals since the start; `state` is the latest sample.
        tilt: Largest angle between the rover's and the world's vertical in this period [rad].
        goal_distance: From the model frame to the goal, in the plane [m]; NaN without a goal.
        goal_s: When the rover was first as near to its goal as it must be [s]; NaN before.
        person_distance: From the model frame to the nearest person, in the plane, the least in this
            period [m]; NaN without people.
        mission: How its mission stands.
    """

    truth: Truth
    state: TruthState
    tilt: float
    goal_distance: float
    goal_s: float
    person_distance: float = math.nan
    mission: MissionState = MissionState()


@dataclass(frozen=True)
class Quantity:
    """A quantity of the truth, taken out of a snapshot; `contact` are the contacts that it counts.

    `nothing` is said where it never had a value; `unit` is empty for counts and flags.
    """

    unit: str
    meaning: str
    value: Callable[[Snapshot], float]
    contact: ContactKind | None = None
    nothing: str = NO_VALUE


# Of the slips of both sides, each front to rear: the first and the last of each.
_CORNERS = {"front_left": (0, 0), "rear_left": (0, -1), "front_right": (1, 0), "rear_right": (1, -1)}


def _contacts(field: str, kind: ContactKind, count: str, time: str) -> dict[str, Quantity]:
    """The number of contacts of a kind and their time, which Truth has as FIELDs and FIELD_s."""
    number, seconds = attrgetter(f"truth.{field}s"), attrgetter(f"truth.{field}_s")
    return {
        f"truth.{field}s": Quantity("", f"{count} so far.", number, kind),
        f"truth.{field}_s": Quantity("s", f"{time} so far.", seconds, kind),
    }


def _at(place: tuple[int, int], values: Sequence[float]) -> float:
    """The value of the wheel at a place of a side."""
    side, index = place
    half = len(values) // 2
    return values[side * half :][:half][index]


def _slip_of(place: tuple[int, int], snapshot: Snapshot) -> float:
    return _at(place, snapshot.state.slip)


def _of_wheel(name: str, place: tuple[int, int], soil: SoilState) -> float:
    return _at(place, getattr(soil, name))


def _soil(unit: str, meaning: str, value: Callable[[SoilState], float]) -> Quantity:
    """What soil does to the wheels, which has no value on rigid ground."""

    def in_soil(snapshot: Snapshot) -> float:
        soil = snapshot.state.soil
        return math.nan if soil is None else value(soil)

    return Quantity(unit, meaning, in_soil, nothing="the ground is rigid; give soil")


_OF_WHEELS = {
    "sinkage": ("m", "Depth of the wheel below the ground."),
    "slip_angle": ("rad", "Between the wheel's plane and its way, positive to the left."),
    "pull": ("N", "Force of the soil along the wheel's heading."),
    "side_force": ("N", "Force of the soil to the wheel's left."),
}

SHIPPED: dict[str, Quantity] = {
    **_contacts("hazard_contact", "hazard", "Contacts with hazards", "Time in contact with a hazard"),
    **_contacts("rock_contact", "rock", "Contacts with rocks", "Time in contact with a rock"),
    **_contacts(
        "scrape", "scrape", "Times that the body touched the ground", "Time of the body on the ground"
    ),
    "truth.contact_force": Quantity(
        "N", "Largest normal force of a hazard in 50 ms.", lambda m: m.state.contact_force, "hazard"
    ),
    "truth.tilt_deg": Quantity(
        "deg", "Angle between the rover's and the world's vertical.", lambda m: math.degrees(m.tilt)
    ),
    "truth.tipped_over": Quantity(
        "", "1 once the rover has lain on its side or roof.", lambda m: m.truth.tipped_over
    ),
    "truth.speed": Quantity("m/s", "Forward speed, negative backwards.", lambda m: m.state.speed),
    "truth.path_length": Quantity("m", "Path so far.", lambda m: m.truth.path_length),
    "truth.roughness": Quantity("m", "Of the terrain under the wheels.", lambda m: m.state.roughness),
    "truth.x": Quantity("m", "Position in the world.", lambda m: m.truth.position[0]),
    "truth.y": Quantity("m", "Position in the world.", lambda m: m.truth.position[1]),
    "truth.z": Quantity("m", "Position in the world.", lambda m: m.truth.position[2]),
    "truth.resets": Quantity("", "Times that it was put back so far.", lambda m: m.truth.resets),
    "truth.slip": Quantity(
        "",
        "Mean magnitude of the wheels' slip ratios.",
        lambda m: sum(map(abs, m.state.slip)) / len(m.state.slip),
    ),
    **{
        f"truth.slip.{wheel}": Quantity("", "Slip ratio, -1 to 1.", partial(_slip_of, place))
        for wheel, place in _CORNERS.items()
    },
    "truth.sinkage": _soil("m", "Of the wheel that is deepest in soil.", lambda s: max(s.sinkage)),
    "truth.slip_angle_deg": _soil(
        "deg",
        "Mean magnitude of the wheels' slip angles in soil.",
        lambda s: math.degrees(sum(map(abs, s.slip_angle)) / len(s.slip_angle)),
    ),
    "truth.pull": _soil(
        "N", "Drawbar pull of all wheels in soil, negative where it holds back.", lambda s: sum(s.pull)
    ),
    "truth.side_force": _soil(
        "N", "Sum of the magnitudes of the side forces of soil.", lambda s: sum(map(abs, s.side_force))
    ),
    "truth.stuck": _soil(
        "", "1 while wheels have turned in soil for a second without getting on.", lambda s: s.stuck
    ),
    **{
        f"truth.{name}.{wheel}": _soil(unit, meaning, partial(_of_wheel, name, place))
        for name, (unit, meaning) in _OF_WHEELS.items()
        for wheel, place in _CORNERS.items()
    },
    "truth.person_distance": Quantity(
        "m",
        "To the nearest person, in the plane.",
        lambda m: m.person_distance,
        nothing="nobody is in the world; give actors",
    ),
    "truth.goal_distance": Quantity("m", "To the goal, in the plane.", lambda m: m.goal_distance),
    "truth.goal_s": Quantity(
        "s",
        "When the goal was reached; no value before.",
        lambda m: m.goal_s,
        nothing="the goal was not reached",
    ),
    "truth.route_points": Quantity("", "Way points reached so far.", lambda m: m.mission.points),
    "truth.route_s": Quantity(
        "s",
        "When the last way point was reached, if none was missed; no value before.",
        lambda m: m.mission.done_s,
        nothing="the route was not finished",
    ),
    "truth.targets_reached": Quantity(
        "", "Targets stopped at within reach, and gates passed, so far.", lambda m: m.mission.reached
    ),
    "truth.gates_passed": Quantity(
        "", "Gates passed between their posts so far.", lambda m: m.mission.gates
    ),
}
QUANTITIES = Table[Quantity](
    "expectations",
    SHIPPED,
    lambda value: isinstance(value, Quantity) and takes(value.value, 1),
    "a harness.scenario.quantities.Quantity with a function (snapshot) -> number",
)

GOAL = "truth.goal"  # how the names of those begin that need a goal
ROUTE, TARGETS = "truth.route", ("truth.target", "truth.gates")  # a route, targets
LOG = "log."  # and the name of a column
RUN = {
    "run.lost_messages": "Messages given up.",
    "run.rows": "Rows of the log.",
    "run.refused_commands": "Commands on /cmd_vel that are not finite or in a frame of somebody else.",
}


def names() -> tuple[str, ...]:
    """Returns all quantities; those of the log are its columns with numbers, also the extended ones."""
    headers = (column.header for column in ALL_COLUMNS)
    columns = [
        f"{LOG}{name}" for name in (*COLUMNS, *headers) if name not in (TIME_COLUMN, NOTES_COLUMN)
    ]
    return (*QUANTITIES, *RUN, *columns)


def quantity_of(name: str) -> Quantity | None:
    """Returns the quantity of the truth of that name, of a target too; None if it is none."""
    match = OF_TARGET.fullmatch(name)
    if match is None:
        return QUANTITIES.get(name)
    target = match["name"]
    if match["what"] == "distance":
        return Quantity("m", "To the target, in the plane.", lambda m: m.mission.distances[target])
    return Quantity(
        "m",
        "From the target to the nearest stop of a second so far.",
        lambda m: m.mission.stops[target],
        nothing="the rover has not stopped",
    )


def check_name(name: str) -> str | None:
    """Returns the complaint about a quantity that does not exist; None about one that does."""
    if name.startswith(tuple(FORMS)):
        return check_heard(name)
    if OF_TARGET.fullmatch(name):
        return None
    return None if name in QUANTITIES or name in names() else unknown("quantity", name, names())
