"""Which optional sensors a rover carries, by rover.yaml and --sensors, and which options are valid."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from harness.base.errors import UsageError
from harness.robots import RoverSpec
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.sections import FrameRow
from harness.sensors import table
from harness.sensors.choice import chosen
from harness.sensors.optional import SensorOptions
from harness.sensors.table import OPTIONAL, SensorRow
from harness.spec.sensor import parse_choice
from tests.support.rovers import LEO, ROVER_ZERO4WD

ALWAYS = tuple(row for row in table.SENSORS if row.options is None)
BARE = LEO.but(frames=(), rest_height=0.2)
LEFT = {"kind": "depth", "name": "left", "topic": "l"}
RIGHT = {"kind": "depth", "name": "right", "width": 4}
SMALL = {"kind": "camera", "name": "small", "preset": "small"}


def carried(asked: Sequence[str] | None, *entries: Mapping[str, Any]) -> dict[str, SensorRow]:
    """The optional sensors of a rover by name."""
    choices = None if asked is None else tuple(map(parse_choice, asked))
    rows = chosen(LEO.but(sensors=entries), choices)
    assert rows[: len(ALWAYS)] == ALWAYS
    return {row.given.name: row for row in rows if row.given is not None}


def options(**values: Any) -> SensorOptions:  # noqa: ANN401 - of several types
    (row,) = carried(None, {"kind": "gnss", "name": "eye", **values}).values()
    assert row.given is not None
    return row.given


def test_several_of_a_kind_have_names_topics_and_frames_of_their_own() -> None:
    rows = carried(
        None, LEFT, RIGHT | {"cloud": True, "frame": "lens"}, {"kind": "gnss", "topic": "a/b"}
    )
    assert {name: [topic.name for topic in row.topics] for name, row in rows.items()} == {
        "left": ["l/image", "l/camera_info"],
        "right": ["right/image", "right/camera_info", "right/points"],
        "gnss": ["a/b"],
    }
    assert [(row.source, row.fault, row.frame) for row in rows.values()] == [
        ("left", "left", "left_optical_frame"),
        ("right", "right", "lens_optical_frame"),
        ("gnss", "gnss", "gnss_link"),
    ]


@pytest.mark.parametrize(
    ("asked", "widths"),
    [
        (None, {"left": 160, "right": 4, "small": 160}),
        (("none",), {}),
        (("depth", "left"), {"depth": 160, "left": 160}),
        (("depth=roboterrain",), {"depth": 640}),
        (("left=roboterrain",), {"left": 640}),
        (("right=roboterrain",), {"right": 4}),  # its own value wins
        (("small=fisheye",), {"small": 1600}),
    ],
)
def test_those_of_rover_yaml_are_carried_unless_others_are_asked_for(
    asked: tuple[str, ...] | None, widths: dict[str, int]
) -> None:
    rows = carried(() if asked == ("none",) else asked, LEFT, RIGHT, SMALL)  # as harness.spec.sensor
    assert {name: getattr(row.given, "width", None) for name, row in rows.items()} == widths


def test_every_preset_is_valid_and_what_is_asked_for_wrongly_is_refused() -> None:
    for kind, row in OPTIONAL.shipped.items():
        assert row.options is not None
        for preset, values in row.options.presets.items():
            (made,) = carried((f"{kind}={preset}",)).values()
            assert made.given == row.options.model_validate({"name": kind, "preset": preset, **values})
    with pytest.raises(UsageError, match=r"'gnss=' names no preset; give gnss alone, or gnss=PRESET"):
        parse_choice("gnss=")
    for asked, said in (
        (("ear",), r"'ear' does not exist; available: left, lidar2d.*, none"),
        *((("depth", "none"), "none stands alone"), (("depth", "depth=small"), "has 'depth' twice")),
    ):
        with pytest.raises(UsageError, match=said):
            carried(asked, LEFT)


def test_the_rover_yaml_of_the_page_is_valid_and_its_frames_hang_together() -> None:
    page = (Path(__file__).parents[3] / "docs" / "sensors.md").read_text()
    (example,) = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    given = [row.given for row in carried(None, *YAML(typ="safe").load(example)["sensors"]).values()]
    ids = {some.name: some.frame_id for some in given if some is not None}
    assert ids == {"top": "top_link", "front": "front_link", "depth": "camera_optical_frame"}
    frames = rover_frames(LEO, (frame for some in given if some for frame in some.frames(LEO)))
    assert {*ids.values()} <= {link.name for link in frames.links}


OF_THE_RUN = ["clock", "cmd_vel", "goal_pose", "map", "robot_description", "tf_static", "rover/metrics"]


@pytest.mark.parametrize(
    ("entry", "parts"),
    [
        ({"name": "x"}, ["sensors [2]", "'kind' is missing", "lidar2d"]),
        ({"kind": "ear"}, ["'ear' does not exist", "gnss"]),
        ({"kind": "gnss", "ratio": 3}, ["'gnss'", "key 'ratio' does not exist", "rate"]),
        ({"kind": "depth", "preset": "x"}, ["preset 'x' does not exist", "small, roboterrain"]),
        ({"kind": "battery", "preset": "x"}, ["has no presets", "rover.yaml"]),
        ({"kind": "gnss", "rate": 33}, ["'gnss'", "33 Hz", "20 or 25"]),
        ({"kind": "gnss", "rate": "fast"}, ["rate 'fast'", "a whole number"]),
        ({"kind": "gnss", "rpy": [1, 2, math.nan]}, ["rpy", "finite"]),
        ({"kind": "gnss", "rpy": [0, 20, 0]}, ["rpy", "6.28"]),
        *(({"kind": "gnss", "name": n}, [f"name '{n}'"]) for n in ("2", "é", "e\u0661")),
        ({"kind": "gnss", "rate": "2_0"}, ["rate '2_0'", "give a number"]),
        ({"kind": "gnss", "name": "clock"}, ["two sensors are named 'clock'"]),
        ({"kind": "gnss", "name": "left"}, ["two are named 'left'"]),
        ({"kind": "depth", "name": "l"}, ["/l/image is the topic of left and of l"]),
        ({"kind": "gnss", "topic": "scan"}, ["/scan is the topic of scan and of gnss"]),
        *(({"kind": "gnss", "topic": t}, [f"/{t} is the topic of the run itself"]) for t in OF_THE_RUN),
        *(({"kind": "gnss", "topic": t}, [f"topic '{t}'", "front/points"]) for t in ("/a", "a/", "a-b")),
        ({"kind": "lidar2d", "range_min": -1e-3}, ["range_min -0.001"]),
        ({"kind": "lidar2d", "range_min": 30.0}, ["range_min 30 m and range_max 30 m"]),
        ({"kind": "lidar2d", "beams": 1}, ["beams 1", "2"]),
        ({"kind": "lidar2d", "beams": 500_001}, ["500,001 rays", "1 to 500,000"]),
        ({"kind": "lidar2d", "angle_max": 3.2}, ["field of view", "to 3.2 rad", "3.14159"]),
        ({"kind": "lidar2d", "angle_min": 0.5, "angle_max": 0.5}, ["field of view from 0.5 to 0.5"]),
        ({"kind": "lidar2d", "noise": {"white": -1e-9}}, ["noise.white"]),
        ({"kind": "lidar2d", "noise": {"wait": 1}}, ["'wait' does not exist"]),
        ({"kind": "lidar3d", "rings": 1000, "columns": 10_000}, ["10,000,000 rays"]),
        ({"kind": "lidar3d", "angle_min": -3.2}, ["field of view from -3.2"]),
        ({"kind": "lidar3d", "lowest": 0.3, "highest": 0.1}, ["elevations from 0.3 to 0.1"]),
        ({"kind": "lidar3d", "highest": 1.6}, ["elevations", "1.6 rad", "1.5708"]),
        ({"kind": "lidar3d", "elevations": [0.1, 0.3, 0.2]}, ["from the lowest to the highest"]),
        ({"kind": "lidar3d", "pattern": "spiral", "organised": True}, ["a spiral has no rings"]),
        ({"kind": "depth", "width": 3, "height": 0}, ["height 0", "1"]),
        ({"kind": "depth", "fov": math.pi}, ["fov 3.14159", "give 0 to"]),
        ({"kind": "camera", "height": 7}, ["height 7", "8"]),
        ({"kind": "camera", "fov": 3.0}, ["fov 3 rad of a pinhole camera", "2.96"]),
        ({"kind": "camera", "fov": 6.3, "lens": "fisheye"}, ["fov 6.3 rad of a fisheye", "6.28"]),
        ({"kind": "camera", "noise": 0.6}, ["noise 0.6", "0.5"]),
        ({"kind": "magnetometer", "field": [1e-6]}, ["east, north and up in tesla"]),
        ({"kind": "magnetometer", "field": [1e-6, 2e-6, 3.0]}, ["in tesla", "0.001"]),
        ({"kind": "magnetometer", "year": 2030.0}, ["year", "2030"]),
        ({"kind": "magnetometer", "year": "2026-11-25"}, ["year", "2026-11-25"]),
        ({"kind": "height_scan", "resolution": 0.0}, ["resolution 0"]),
        ({"kind": "height_scan", "resolution": 0.125, "size": [62.5, 62.625]}, ["more than 250000"]),
    ],
)
def test_a_wrong_entry_is_one_line_with_the_file_and_what_is_valid(
    entry: Mapping[str, Any], parts: list[str]
) -> None:
    with pytest.raises(UsageError) as refusal:
        carried(None, LEFT, entry)
    message = str(refusal.value)
    assert all(part in message for part in ("rover.yaml", *parts)), message
    assert "\n" not in message


@pytest.mark.parametrize(
    "entry",
    [
        {"kind": "gnss", "name": "Z9", "topic": "a/b_1/C"},
        {"kind": "lidar2d", "range_min": 0, "range_max": 1e-3, "beams": 2},
        {"kind": "lidar2d", "beams": 500_000, "noise": {"white": 0.1, "step": 0.2, "dropout": 1}},
        {"kind": "lidar2d", "angle_min": -3.1416, "angle_max": 3.1416},  # as somebody writes who rounds
        {"kind": "lidar3d", "rings": 1, "lowest": 0.1, "highest": 0.1},
        {"kind": "magnetometer", "field": [1e-3, -1e-3, 0.0]},
        {"kind": "height_scan", "resolution": 0.125, "size": [62.5, 62.5]},
        {"kind": "camera", "width": 8, "height": 4096, "noise": 0.5, "fov": 2.96},
    ],
)
def test_values_at_the_edge_of_what_is_valid_are_taken(entry: Mapping[str, Any]) -> None:
    (row,) = carried(None, entry).values()
    assert row.given is not None
    for key in entry.keys() - {"kind"}:
        value = entry[key]
        expected = tuple(value) if isinstance(value, list) else value
        given = getattr(row.given, key)
        assert (given.model_dump() if isinstance(value, dict) else given) == expected


def test_a_mount_without_parent_is_in_its_own_frame_if_the_rover_has_it_else_at_the_lidar() -> None:
    rover = BARE.but(frames=(FrameRow(parent="base_footprint", child="mast"),))
    for frame in ("lidar_link", LEO.imu_frame, "mast"):
        assert options(frame=frame).frames(rover) == ()
        (row,) = options(frame=frame, parent="mast").frames(rover)
        assert (row.parent, row.child) == ("mast", frame)
    place, turn = (0.1, 0.2, 0.3), (0.4, 0.5, 0.6)
    (free,) = options(xyz=place, rpy=turn).frames(BARE.but(lidar_y=-0.5, lidar_height=9.0))
    assert (free.parent, free.child, free.rpy) == ("base_footprint", "eye_link", turn)
    assert free.xyz == pytest.approx((0.1 + 0.174, 0.2 - 0.5, 0.3 + 0.79783))  # where the model has it
    (fixed,) = options(parent="rocker_L_link", xyz=place, rpy=turn).frames(LEO)
    assert (fixed.parent, fixed.xyz, fixed.rpy) == ("rocker_L_link", place, turn)


OPTICAL = (-math.pi / 2, 0.0, -math.pi / 2)  # z ahead, x right, y down: scipy reads it so in test_depth


@pytest.mark.parametrize(
    ("rover", "kind", "values", "frames"),
    [
        (LEO, "camera", {"name": "camera"}, []),  # it has one
        (LEO, "camera", {}, [("camera_frame", "eye_link"), ("eye_link", "eye_optical_frame")]),
        (ROVER_ZERO4WD, "camera", {"name": "camera"}, [("camera_link", "camera_optical_frame")]),
        (LEO, "camera", {"parent": "p", "frame": "l"}, [("p", "eye_link"), ("eye_link", "l")]),
        (LEO, "depth", {"parent": "p"}, [("p", "eye_link"), ("eye_link", "eye_optical_frame")]),
        (LEO, "depth", {"frame": "camera_frame"}, []),  # with that of the camera
        (ROVER_ZERO4WD, "depth", {"name": "camera"}, [("camera_link", "camera_optical_frame")]),
        (LEO, "height_scan", {"frame": "grid"}, [(LEO.odometry_child_frame, "grid")]),
        (LEO, "height_scan", {"parent": "p"}, [("p", "eye_link")]),
    ],
)
def test_cameras_have_an_optical_frame_and_hang_where_the_rover_has_a_place_for_them(
    rover: RoverSpec, kind: str, values: dict[str, str], frames: list[tuple[str, str]]
) -> None:
    (row,) = carried(None, {"kind": kind, "name": "eye", "xyz": (1.0, 2.0, 3.0), **values}).values()
    assert row.given is not None
    rows = row.given.frames(rover)
    assert [(frame.parent, frame.child) for frame in rows] == frames
    assert all(frame.xyz == (1.0, 2.0, 3.0) for frame in rows[:1] if "parent" in values)
    assert kind == "height_scan" or all(frame.rpy == OPTICAL for frame in rows[1:])
