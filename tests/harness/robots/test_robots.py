"""The rover specifications against RoboTerrain's files, and how they are found."""

import mujoco
import pytest

from harness.base.errors import UsageError
from harness.robots import ROVERS, RoverSpec, find_rover
from tests.support.rovers import LEO, ROVER_ZERO4WD

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())

# What no model file says; sizes are compared with the models in test_models.py.
SPECIFIED = {
    LEO: {
        "name": "leo",
        "odometry_child_frame": "base_footprint",
        "imu_frame": "imu_frame",
        "rest_height": 0.0,
        "wheel_joints": ("wheel_FL_joint", "wheel_RL_joint", "wheel_FR_joint", "wheel_RR_joint"),
        "passive_joints": ("rocker_L_joint", "rocker_R_joint"),
        "controller_radius": 0.0625,
        "controller_separation": 0.358,
        "linear_acceleration": 2.5,
        "angular_acceleration": 3.0,
        "cruise_speed": 0.4,
        "cruise_yaw_rate": 1.0,
        "encoder_ticks": 878.4,
        "odometry_rate": 20,
    },
    ROVER_ZERO4WD: {
        "name": "rover_zero4wd",
        "odometry_child_frame": "base_link",
        "imu_frame": "imu_link",
        "rest_height": 0.002,
        "wheel_joints": tuple(f"{wheel}_wheel_to_chassis" for wheel in ("fl", "rl", "fr", "rr")),
        "passive_joints": (),
        "controller_radius": 0.122,
        "controller_separation": 0.24,
        "linear_acceleration": 5.0,
        "angular_acceleration": 4.0,
        "cruise_speed": 0.5,
        "cruise_yaw_rate": 2.0,
        "encoder_ticks": 4096.0,
        "odometry_rate": 50,
    },
}


@BOTH
def test_controller_rates_and_frames_are_those_of_roboterrain(rover: RoverSpec) -> None:
    assert {name: getattr(rover, name) for name in SPECIFIED[rover]} == SPECIFIED[rover]


def test_a_rover_is_found_by_its_name() -> None:
    assert list(ROVERS) == ["leo", "rover_zero4wd"]
    assert [find_rover(name) for name in ROVERS] == [LEO, ROVER_ZERO4WD]


def test_an_unknown_name_is_refused_with_the_names_that_exist() -> None:
    with pytest.raises(
        UsageError,
        match=r"^robot 'spot' does not exist; available: leo, rover_zero4wd, or the path",
    ):
        find_rover("spot")
    with pytest.raises(
        UsageError, match=r"test_robots\.py' is a file; .* harness.robot new NAME --from "
    ):
        find_rover(__file__)


@BOTH
def test_every_published_joint_exists_in_the_model(rover: RoverSpec) -> None:
    model = mujoco.MjSpec.from_file(str(rover.model_path)).compile()
    hinges = [model.joint(index).name for index in range(model.njnt)]
    assert hinges[0] == "root"
    assert sorted(rover.joints) == sorted(hinges[1:])
    assert rover.joints[:4] == rover.wheel_joints
    assert rover.lidar_x == model.site("lidar").pos[0]


@BOTH
def test_cruising_stays_within_the_speed_of_the_wheels(rover: RoverSpec) -> None:
    turning = rover.cruise_yaw_rate * rover.controller_separation / 2
    assert (rover.cruise_speed + turning) / rover.controller_radius < rover.wheel_speed_limit


@pytest.mark.parametrize(
    ("rover", "length", "width", "top_speed"),
    [(LEO, 0.43, 0.428, 0.75), (ROVER_ZERO4WD, 0.54, 0.446, 1.27)],
)
def test_size_and_top_speed_follow_from_footprint_and_true_wheels(
    rover: RoverSpec, length: float, width: float, top_speed: float
) -> None:
    assert (rover.length, rover.width, rover.top_speed) == pytest.approx((length, width, top_speed))
