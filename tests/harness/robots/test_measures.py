"""What is derived from a model against numbers that were told independently of it."""

from collections.abc import Callable

import pytest

from harness.robots import ROVERS, RoverSpec
from harness.robots.measures import Measures, frame_name
from tests.support.foreign_rovers import FOREIGN

Foreign = Callable[[str], RoverSpec]


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_what_is_derived_of_the_models_that_ship_is_what_their_sources_say(rover: RoverSpec) -> None:
    measures = Measures(rover)
    derived = measures.derived()
    for key in ("rest_height", "wheelbase", "track", "lidar_height"):
        assert derived[key] == pytest.approx(getattr(rover, key), abs=5e-4), key
    assert derived["footprint"] == pytest.approx(rover.footprint, abs=2e-3)
    for key in ("passive_joints", "wheel_speed_limit", "lidar_x", "lidar_y", "lidar_yaw", "drive"):
        assert getattr(measures, key) == getattr(rover, key), key
    assert (measures.wheel_radius, measures.wheel_width, measures.gravity) == pytest.approx(
        (rover.wheel_radius, rover.wheel_width, rover.gravity)
    )


def test_clearance_is_that_of_the_lowest_part_that_is_no_wheel() -> None:
    assert Measures(ROVERS["rover_zero4wd"]).derived()["clearance"] == pytest.approx(0.049)


@pytest.mark.parametrize("name", FOREIGN)
def test_a_folder_made_of_public_numbers_tells_them_again(name: str, foreign: Foreign) -> None:
    known, rover = FOREIGN[name], foreign(name)
    assert (rover.drive.left, rover.drive.right) == (known.left, known.right)
    told = (rover.wheel_radius, rover.wheelbase, rover.track, rover.top_speed)
    assert told == pytest.approx(
        (known.wheel_radius, known.wheelbase, known.track, known.top_speed), rel=1e-3
    )
    assert f"{known.mass:.1f} kg, {2 * len(known.left)} wheels" in rover.summary


def test_wheels_are_named_by_side_and_place(foreign: Foreign) -> None:
    assert ROVERS["leo"].wheel_names == ("front_left", "rear_left", "front_right", "rear_right")
    assert foreign("sojourner").wheel_names[:3] == ("front_left", "middle_left", "rear_left")


def test_a_buggy_steers_its_front_wheels_and_drives_those_with_transmissions(foreign: Foreign) -> None:
    buggy = foreign("buggy")
    assert buggy.drive.steering == ("left_steering", "right_steering")
    assert buggy.drive.driven == ("rear_left_joint", "rear_right_joint")
    assert buggy.steered_wheels == ("front_left_joint", "front_right_joint")
    assert (buggy.drive.steering_limit, buggy.drive.steering_rate) == (0.4189, 3.2)
    assert buggy.passive_joints == ()
    # By hand: the inner wheel at its limit, the centre of the circle on the rear axle's line.
    assert buggy.tightest_turn == pytest.approx(0.3302 / 0.44528 + 0.2413 / 2, abs=1e-3)


def test_a_lidar_that_looks_ahead_is_known_to(foreign: Foreign) -> None:
    husky = foreign("husky")
    assert (husky.lidar_x, husky.lidar_y, husky.lidar_yaw) == pytest.approx((0.3, 0.0, 0.0))
    assert husky.lidar_height == pytest.approx(0.45 + 0.1651 - 0.0328)


def test_frames_are_called_as_their_bodies_if_those_sound_like_frames() -> None:
    assert [frame_name(name) for name in ("base_link", "imu_frame", "wheel")] == [
        "base_link",
        "imu_frame",
        "wheel_link",
    ]
