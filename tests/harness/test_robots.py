"""The rover specifications and how they are found."""

import mujoco
import pytest

from harness.errors import UsageError
from harness.robots import ROVERS, RoverSpec, find_rover

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())


@BOTH
def test_a_rover_is_found_by_its_name(rover: RoverSpec) -> None:
    assert find_rover(rover.name) is rover


def test_an_unknown_name_is_refused_with_the_names_that_exist() -> None:
    with pytest.raises(UsageError, match=r"robot 'spot' does not exist; available: leo, rover_zero4wd"):
        find_rover("spot")


@BOTH
def test_every_published_joint_exists_in_the_model(rover: RoverSpec) -> None:
    model = mujoco.MjSpec.from_file(str(rover.model_path)).compile()
    hinges = [model.joint(index).name for index in range(model.njnt)]
    assert hinges[0] == "root"
    assert sorted(rover.joints) == sorted(hinges[1:])


@BOTH
def test_cruising_stays_within_the_speed_of_the_wheels(rover: RoverSpec) -> None:
    turning = rover.cruise_yaw_rate * rover.controller_separation / 2
    assert (rover.cruise_speed + turning) / rover.controller_radius < rover.wheel_speed_limit
