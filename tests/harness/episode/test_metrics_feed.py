"""What the extended columns are told of a rover and of each sample."""

import math
from typing import Any

import numpy as np
import pytest

from harness.episode.metrics_feed import (
    SampleIntake,
    extended_ros_args,
    extended_settings,
    outline_parameters,
)
from harness.robots import RoverSpec
from harness.samples import (
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    TruthState,
    Twist,
)
from harness.sensors.lidar_spec import LidarSpec
from tests.support.rovers import LEO, ROVER_ZERO4WD

# The rectangle around the wheels in models/README.md, and x of the lidar, which looks backwards.
OUTLINES = [(LEO, (-0.212, 0.218, 0.214), 0.174), (ROVER_ZERO4WD, (-0.272, 0.268, 0.223), 0.174)]
ATTITUDE = (0.1, 0.2, 0.3, 0.9)
RANGES = np.ones(5, dtype=np.float32)


@pytest.mark.parametrize(("rover", "edges", "lidar_x"), OUTLINES)
def test_a_node_is_told_the_footprint_and_the_pose_of_the_lidar(
    rover: RoverSpec, edges: tuple[float, float, float], lidar_x: float
) -> None:
    rear, front, side = edges
    told = outline_parameters(rover)
    corners = np.reshape(told["footprint"], (-1, 2)).tolist()
    expected = [[rear, -side], [rear, side], [front, -side], [front, side]]
    assert sorted(corners) == expected
    assert told["lidar_pose"] == [lidar_x, 0.0, math.pi]
    settings = extended_settings(rover)
    assert settings.gravity == 9.8
    assert settings.footprint is not None
    assert [list(corner) for corner in settings.footprint.corners] == corners
    words = extended_ros_args(rover)
    assert words[:3] == ["--ros-args", "-p", "extended_columns:=true"]
    assert words[-1] == "--"
    assert "gravity:=9.8" in words
    assert f"lidar_pose:={told['lidar_pose']}" in words
    assert f"footprint:={told['footprint']}" in words


class Spy:
    """Extended metrics that only remember what they were given."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = []

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - a method
        return lambda *values, **named: self.calls.append((name, values, named))


@pytest.mark.parametrize(
    ("sample", "calls"),
    [
        (
            LaserScan(5, RANGES),
            [
                (
                    "add_scan",
                    (5, RANGES),
                    # float32, as sensor_msgs/LaserScan has them
                    {
                        "angle_min": float(np.float32(-3.14159)),
                        "angle_increment": float(np.float32(2 * 3.14159 / 4)),
                        "used": True,
                    },
                )
            ],
        ),
        (
            Imu(5, ATTITUDE, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)),
            [("add_imu", (5, (4.0, 5.0, 6.0), ATTITUDE), {"used": True})],
        ),
        (Pose(5, (1.0, 2.0, 3.0), ATTITUDE), [("add_pose", (5, (1.0, 2.0, 3.0)), {"used": True})]),
        (
            Odometry(5, 1.0, 2.0, 3.0, Twist(0.4, 0.7)),
            [("add_odometry", (5, (0.4, 0.0, 0.0)), {"used": True})],
        ),
        (
            GroundTruth(5, 1.0, 2.0, 3.0, (4.0, 5.0, 6.0), (7.0, 8.0, 9.0)),
            [("add_true_velocity", ((4.0, 5.0, 6.0),), {})],
        ),
        (
            TruthState(5, True, False, True, 11.0, 12.0, 13.0, (0.1, 0.2, 0.3, 0.4), 14.0),
            [
                ("add_contact", (), {"touches": True}),
                ("add_traversal", ((11.0, False, True, 12.0, 13.0, 0.1, 0.2, 0.3, 0.4, 14.0),), {}),
            ],
        ),
        (JointStates(5, (1.0,), (2.0,), (3.0,)), []),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_sample_arrives_as_it_would_out_of_its_message(sample: Sample, calls: list[Any]) -> None:
    spy = Spy()
    SampleIntake(spy, LidarSpec(beams=5)).take(sample, used=True)  # type: ignore[arg-type]  # a spy
    assert spy.calls == calls
