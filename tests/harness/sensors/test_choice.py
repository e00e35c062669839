"""Which sensors a rover carries, by rover.yaml and by --sensors, and what is wrong with the rest."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import pytest

from harness.base.errors import UsageError
from harness.robots import RoverSpec, find_rover
from harness.samples import Pose
from harness.sensors import table
from harness.sensors.choice import chosen
from harness.sensors.optional import SensorOptions
from harness.sensors.table import SensorRow, Topic


@dataclass(frozen=True, kw_only=True)
class EyeOptions(SensorOptions):
    """Of a made-up sensor."""

    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "fine": {"pixels": 9, "rate": 50},
        "coarse": {"pixels": 2},
    }

    preset: str = ""
    pixels: int = 1
    cloud: bool = False


EYE = SensorRow(
    sample=Pose,
    reader="harness.sensors.state:PoseSensor",
    topics=(Topic("image", "sensor_msgs/msg/Image"), Topic("points", "x/msg/Cloud", option="cloud")),
    fault="eye",
    options=EyeOptions,
)
NOSE = replace(EYE, fault="nose", topics=(Topic("smell", "std_msgs/msg/String"),), options=SensorOptions)
ALWAYS = tuple(row for row in table.SENSORS if row.options is None)


@pytest.fixture(autouse=True)
def _rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table, "SENSORS", (*ALWAYS, EYE, NOSE))


def rover(*sensors: Mapping[str, Any]) -> RoverSpec:
    return find_rover("leo").but(sensors=sensors)


def carried(asked: tuple[str, ...] | None, *sensors: Mapping[str, Any]) -> dict[str, SensorRow]:
    """The optional sensors by name."""
    rows = chosen(rover(*sensors), asked)
    assert rows[: len(ALWAYS)] == ALWAYS
    return {row.given.name: row for row in rows if row.given is not None}


# What a run hears or tells besides the sensors: docs/topics.md.
OF_THE_RUN = ["clock", "cmd_vel", "goal_pose", "map", "robot_description", "tf_static", "rover/metrics"]
LEFT, RIGHT = (
    {"kind": "eye", "name": "left", "topic": "l"},
    {"kind": "eye", "name": "right", "pixels": 4},
)


def test_several_of_a_kind_have_names_topics_and_frames_of_their_own() -> None:
    rows = carried(None, LEFT, RIGHT | {"cloud": True, "frame": "lens"})
    assert {name: [topic.name for topic in row.topics] for name, row in rows.items()} == {
        "left": ["l/image"],
        "right": ["right/image", "right/points"],
    }
    assert [(row.source, row.fault, row.frame) for row in rows.values()] == [
        ("left", "left", "left_link"),
        ("right", "right", "lens"),
    ]


def test_the_topic_of_a_sensor_that_has_one_is_what_it_is_told() -> None:
    (row,) = carried(None, {"kind": "nose", "topic": "front/smell"}).values()
    assert [topic.name for topic in row.topics] == ["front/smell"]


@pytest.mark.parametrize(
    ("asked", "names"),
    [
        (None, {"left": 1, "right": 4}),
        (("none",), {}),
        (("right",), {"right": 4}),
        (("eye", "left"), {"eye": 1, "left": 1}),
        (("eye=fine",), {"eye": 9}),
        (("left=fine",), {"left": 9}),
        (("right=fine",), {"right": 4}),  # what it is told itself wins
        (("coarse",), {"coarse": 2}),
        (("coarse=fine",), {"coarse": 9}),
    ],
)
def test_those_of_rover_yaml_are_carried_unless_others_are_asked_for(
    asked: tuple[str, ...] | None, names: dict[str, int]
) -> None:
    coarse = [{"kind": "eye", "name": "coarse", "preset": "coarse"}] if asked else []
    rows = carried(asked, LEFT, RIGHT, *coarse)
    assert {name: getattr(row.given, "pixels", None) for name, row in rows.items()} == names


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"name": "x"}, r"rover\.yaml: sensors \[2\]: key 'kind' is missing; give one of eye, nose"),
        ({"kind": "ear"}, r"sensors, 'ear': sensor 'ear' does not exist; available: eye, nose"),
        (
            {"kind": "eye", "pixel": 3},
            r"sensors, 'eye': key 'pixel' does not exist; valid: name, parent",
        ),
        ({"kind": "eye", "preset": "x"}, r"preset 'x' does not exist; available: fine, coarse"),
        ({"kind": "nose", "preset": "x"}, r"key 'preset' does not exist"),
        ({"kind": "eye", "rate": 33}, r"'eye': rate 33 Hz does not divide .* nearest valid: 20 or 25"),
        ({"kind": "eye", "rate": 0}, r"rate 0 Hz does not divide"),
        (
            {"kind": "eye", "name": "l"},
            r"/l/image is the topic of left and of l; give 'l' another topic",
        ),
        ({"kind": "nose", "topic": "scan"}, r"/scan is the topic of scan and of nose"),
        *(
            ({"kind": "nose", "topic": topic}, rf"/{topic} is the topic of the run itself and of nose")
            for topic in OF_THE_RUN
        ),
        ({"kind": "nose", "name": "clock"}, r"two sensors are named 'clock'; give one another name"),
        (
            {"kind": "nose", "topic": "/a"},
            r"topic '/a' is not valid; give e\.g\. front/points, no slash",
        ),
        ({"kind": "nose", "name": "2"}, r"name '2' is not valid; give letters, digits and _"),
        ({"kind": "nose", "name": "imu"}, r"two sensors are named 'imu'; give one another name"),
        ({"kind": "eye", "name": "left"}, r"two are named 'left'; give each a name of its own"),
    ],
)
def test_a_wrong_entry_is_told_with_what_is_valid(entry: Mapping[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        chosen(rover(LEFT, entry), None)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (("ear",), r"sensor 'ear' does not exist; available: left, eye, nose, none"),
        (("eye", "none"), r"--sensors none stands alone"),
        (("eye", "eye=fine"), r"--sensors has 'eye' twice; leave one out"),
        (("nose=fine",), r"--sensors nose=fine: key 'preset' does not exist"),
        (("",), r"sensor '' does not exist"),
    ],
)
def test_a_wrong_word_is_told_with_what_is_valid(asked: tuple[str, ...], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        chosen(rover(LEFT), asked)
