"""Columns of the truth, which only a simulator publishes; empty with a real rover."""

import math
from collections.abc import Iterator, Sequence

from rover_metrics.core.columns import Cell, Column
from rover_metrics.core.rotation import Vector3
from rover_metrics.timing import EVENT_GAP_NS, NANOSECONDS

RATE = 20  # [Hz] of the harness's truth
CONTACT_PAUSE = EVENT_GAP_NS * RATE // NANOSECONDS  # messages without contact before a new event
STANDING = 0.05  # [m/s]: of the harness's wheels, which say 0 below it

WHEELS = ("front_left", "rear_left", "front_right", "rear_right")  # if nobody says others
ROUGHNESS = "roughness"
SLIP = "True Slip "  # and the wheel: names of columns
FIRST_SLIP = 5  # place among the values
STUCK = "stuck"
IN_SOIL = {  # of each wheel: name of its column, unit, meaning
    "sinkage": ("True Sinkage", "m", "Depth of the lowest point of the {} wheel below the ground."),
    "slip_angle": (
        "True Slip Angle",
        "rad",
        "Between the plane of the {} wheel and its way over the ground, positive to the left.",
    ),
    "pull": (
        "True Drawbar Pull",
        "N",
        "Force of the soil on the {} wheel along its heading, negative where it holds back.",
    ),
    "side_force": ("True Side Force", "N", "Force of the soil on the {} wheel to its left."),
}


def traversal_names(wheels: Sequence[str], *, soil: bool = False) -> tuple[str, ...]:
    """Returns the names of the values of /rover/truth/traversal of a rover with these wheels."""
    totals = ("contact_force", "rock_contact", "scrape", "speed", "path_length")
    of_soil = (*(f"{name}_{wheel}" for name in IN_SOIL for wheel in wheels), STUCK) if soil else ()
    return (*totals, *(f"slip_{wheel}" for wheel in wheels), ROUGHNESS, *of_soil)


_CONTACT = "/rover/truth/contact"
_TRAVERSAL = "/rover/truth/traversal"


def truth_columns(wheels: Sequence[str], *, soil: bool) -> tuple[Column, ...]:
    """Returns the columns of a rover with these wheels, e.g. front_left, on soil or on rigid ground."""
    return (
        Column(
            name="True Contact Events",
            meaning="Contacts with hazards so far, a lasting one counted once.",
            formula=f"A new event begins with a contact after {CONTACT_PAUSE} messages or more without "
            f"({EVENT_GAP_NS / NANOSECONDS:g} s at {RATE} Hz).",
            source=_CONTACT,
            cumulative=True,
        ),
        Column(
            name="True Contact Share",
            meaning="Share of the time in contact with a hazard.",
            formula="Messages that say contact / messages, since the row before.",
            source=_CONTACT,
        ),
        Column(
            name="True Speed",
            unit="m/s",
            meaning="How fast the rover moves.",
            formula="Mean of |v| since the row before; empty while no message has filled the twist in, "
            "as RoboTerrain's pose converter does not.",
            source="/odom_ground_truth twist.twist.linear",
        ),
        *map(slip_column, wheels),
        Column(
            name="True Roughness",
            unit="m",
            meaning="How rough the terrain under the wheels is.",
            formula="Mean since the row before.",
            source=f"{_TRAVERSAL} {ROUGHNESS}",
        ),
        *(_soil_columns(wheels) if soil else ()),
    )


def _soil_columns(wheels: Sequence[str]) -> Iterator[Column]:
    for name, (title, unit, meaning) in IN_SOIL.items():
        for wheel in wheels:
            words = wheel.replace("_", " ")
            yield Column(
                name=f"{title} {words.title()}",
                unit=unit,
                meaning=meaning.format(words),
                formula="Mean since the row before.",
                source=f"{_TRAVERSAL} {name}_{wheel}",
            )
    yield Column(
        name="True Stuck",
        meaning="Share of the time in which the wheels turned and did not get on.",
        formula="Mean since the row before of 1 where the rims have turned for a second and the hubs "
        "moved at less than a tenth of their speed, else 0.",
        source=f"{_TRAVERSAL} {STUCK}",
    )


def slip_column(wheel: str) -> Column:
    """Returns the column of one wheel, e.g. front_left."""
    words = wheel.replace("_", " ")
    return Column(
        name=f"{SLIP}{words.title()}",
        meaning=f"Slip ratio of the {words} wheel, -1 to 1.",
        formula="Mean since the row before of (w r - v) / max(|w r|, |v|), w r the speed of its "
        f"rim and v that of its centre; 0 while both are below {STANDING:g} m/s. A skid-steer's "
        "wheels slip in every turn, though the rover does not.",
        source=f"{_TRAVERSAL} slip_{wheel}",
    )


def find_truth_column(header: str) -> Column | None:
    """Returns the column of the truth with that header, whatever the rover's wheels; None for none."""
    titles = (*(title + " " for title, _, _ in IN_SOIL.values()), SLIP)
    words = next((header.removeprefix(title) for title in titles if header.startswith(title)), "")
    wheel = words.partition(" [")[0].lower().replace(" ", "_")
    columns = truth_columns((wheel,), soil=True)
    return next((column for column in columns if column.header == header), None)


class TruthColumns:
    """The account of the truth topics of a rover with these wheels, in the order of the columns."""

    def __init__(self, wheels: Sequence[str] = WHEELS, *, soil: bool = False) -> None:
        self._names = traversal_names(wheels, soil=soil)
        self._on_soil = traversal_names(wheels, soil=True)
        self._events: int | None = None  # nothing heard yet
        self._pause = CONTACT_PAUSE
        self._contact = _Mean()
        self._speed = _Mean()
        self._moved = False
        self._traversal = {name: _Mean() for name in self._names[FIRST_SLIP:]}

    def add_contact(self, *, touches: bool) -> None:
        """Takes whether the rover has touched a hazard since the last message."""
        self._contact.add(float(touches))
        self._events = self._events or 0
        if not touches:
            self._pause += 1
            return
        self._events += self._pause >= CONTACT_PAUSE
        self._pause = 0

    def add_velocity(self, velocity: Vector3) -> bool:
        """Takes the true velocity [m/s]; returns whether it was usable."""
        speed = math.hypot(*velocity)
        if not math.isfinite(speed):
            return False
        self._moved |= speed > 0.0
        if self._moved:
            self._speed.add(speed)
        return True

    def add_traversal(self, values: Sequence[float], names: Sequence[str] | None = None) -> bool:
        """Takes a message's values, with their names if it has any; returns whether they were usable.

        Without names they may be those of soil too, if no column is of it.
        """
        if names is None:
            names = self._names if len(values) == len(self._names) else self._on_soil
        if len(values) != len(names) or not all(map(math.isfinite, values)):
            return False
        named = dict(zip(names, values, strict=True))
        if not self._traversal.keys() <= named.keys():
            return False
        for name, mean in self._traversal.items():
            mean.add(named[name])
        return True

    def cells(self) -> tuple[Cell, ...]:
        """Returns the cells of a row; the means begin anew."""
        return (
            self._events,
            self._contact.take(),
            self._speed.take(),
            *(mean.take() for mean in self._traversal.values()),
        )


class _Mean:
    def __init__(self) -> None:
        self._sum, self._count = 0.0, 0

    def add(self, value: float) -> None:
        self._sum += value
        self._count += 1

    def take(self) -> float | None:
        """The mean since the last call; None if there was nothing."""
        mean = self._sum / self._count if self._count else None
        self._sum, self._count = 0.0, 0
        return mean
