"""Which sensors a run has: those of every rover, and the optional ones that are asked for."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from harness.base.errors import UsageError, find_named, repeated
from harness.robots import RoverSpec
from harness.sensors import table
from harness.sensors.table import SensorRow
from harness.spec.sensor import NONE, SensorChoice
from harness.spec.value import made
from rover_metrics.plugins import FILE

RESERVED = ("clock", "cmd_vel", "goal_pose", "map", "robot_description", "tf_static", "rover/metrics")


def by_default() -> tuple[SensorRow, ...]:
    """Returns all rows, the optional ones as they are with the defaults of their options."""
    optional = (_carried(name, {"kind": name}, "by default") for name in table.OPTIONAL.shipped)
    return (*(row for row in table.SENSORS if row.options is None), *optional)


def chosen(rover: RoverSpec, asked: Sequence[SensorChoice] | None) -> tuple[SensorRow, ...]:
    """Returns the rows of a run, in publishing order: with those asked for, or all of the rover.yaml.

    Raises:
        UsageError: One of them does not exist or is not valid, or two have the same name or topic.
    """
    where = f"{rover.folder / 'rover.yaml'}: sensors"
    listed = _listed(rover.sensors, where)
    if asked is None:
        wanted = [(name, entry, f"{where}, '{name}'") for name, entry in listed.items()]
    else:
        wanted = [_asked(choice, listed, where) for choice in asked]
        if twice := repeated([name for name, _, _ in wanted]):
            raise UsageError(f"--sensors has '{twice}' twice; leave one out")
    always = (row for row in table.SENSORS if row.options is None)
    rows = (*always, *(_carried(*sensor) for sensor in wanted))
    _check_apart(rows)
    return rows


def _listed(entries: Iterable[Mapping[str, Any]], where: str) -> dict[str, Mapping[str, Any]]:
    """The entries of rover.yaml by their names."""
    named: dict[str, Mapping[str, Any]] = {}
    for number, entry in enumerate(entries, 1):
        if (kind := entry.get("kind")) is None:
            valid = ", ".join(table.OPTIONAL)
            raise UsageError(f"{where} [{number}]: key 'kind' is missing; give one of {valid}")
        name = str(entry.get("name", kind))
        if name in named:
            raise UsageError(f"{where}: two are named '{name}'; give each a name of its own")
        named[name] = entry
    return named


def _asked(
    choice: SensorChoice, listed: Mapping[str, Mapping[str, Any]], where: str
) -> tuple[str, Mapping[str, Any], str]:
    """A sensor of --sensors: its name, its options, and where these stand."""
    name, preset = choice.name, {"preset": choice.preset} if choice.preset else {}
    if name in listed:
        return name, {**listed[name], **preset}, f"{where}, '{name}'"
    if name == NONE:
        raise UsageError("--sensors none stands alone; leave out the others, or none")
    if name not in table.OPTIONAL:
        find_named("sensor", name, dict.fromkeys((*listed, *table.OPTIONAL, NONE)))
    called = name if FILE not in name else str(table.OPTIONAL[name].fault)
    return called, {"kind": name, **preset}, f"--sensors {choice}"


def _carried(name: str, entry: Mapping[str, Any], where: str) -> SensorRow:
    """The row of a sensor as it is mounted on this rover."""
    values = {"name": name, **entry}
    try:
        row = find_named("sensor", str(values.pop("kind")), table.OPTIONAL)
        assert row.options is not None  # noqa: S101 - OPTIONAL has no others
        if preset := values.get("preset", ""):
            values = _preset(str(preset), row.options.presets) | values
    except UsageError as error:
        raise UsageError(f"{where}: {error}") from error
    options = made(row.options, values, where)
    alone = len(row.topics) == 1
    topics = (topic for topic in row.topics if not topic.option or getattr(options, topic.option))
    return replace(
        row,
        given=options,
        topics=tuple(replace(t, name=options.topic_name(t.name, alone=alone)) for t in topics),
        rate=options.rate,
        frame=options.frame_id,
        fault=options.name,
    )


def _preset(name: str, presets: Mapping[str, Mapping[str, object]]) -> dict[str, Any]:
    """The values of a preset; UsageError if there is none of that name."""
    if not presets:
        raise UsageError("this sensor has no presets; its options stand in rover.yaml")
    return dict(find_named("preset", name, presets))


def _check_apart(rows: Iterable[SensorRow]) -> None:
    """Checks that no two sensors have the same name, or the same topic."""
    names, owner = {"clock"}, dict.fromkeys(RESERVED, "the run itself")
    for row in rows:
        name = row.fault or row.sample.__name__
        if name in names:
            raise UsageError(f"two sensors are named '{name}'; give one another name in rover.yaml")
        names.add(name)
        for topic in row.topics:
            other = owner.setdefault(topic.name, name)
            if other != name:
                both = f"/{topic.name} is the topic of {other} and of {name}"
                raise UsageError(f"{both}; give '{name}' another topic: in rover.yaml")
