"""Every rover folder, shipped or made of a URDF: what is known of it against its compiled model."""

import copy
import json
from collections.abc import Callable
from itertools import product

import mujoco
import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.robots import IDEAL, REAL, ROVERS, RoverSpec, equipped, find_rover
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.measures import frame_name
from harness.robots.model import compiled_alone
from tests.support.foreign_rovers import FOREIGN
from tests.support.snapshots import check_snapshot

Foreign = Callable[[str], RoverSpec]


@pytest.mark.parametrize("name", [*ROVERS, *FOREIGN])
def test_every_joint_is_published_once_and_every_motor_turns_its_joint(
    name: str, foreign: Foreign
) -> None:
    rover = ROVERS[name] if name in ROVERS else foreign(name)
    model, bare = compiled_alone(rover)
    hinges = [model.joint(index).name for index in range(1, model.njnt)]
    assert sorted(rover.joints) == sorted(hinges)
    assert rover.joints[: len(rover.wheel_joints)] == rover.wheel_joints
    motors = {model.joint(int(joint)).name: n for n, (joint, _) in enumerate(model.actuator_trnid)}
    assert set(rover.motors) <= motors.keys()
    for motor in rover.motors:
        data, dof = copy.copy(bare), int(model.joint(motor).dofadr[0])
        data.ctrl[motors[motor]] = 0.1
        mujoco.mj_forward(model, data)
        assert data.qfrc_actuator[dof] > 0.0
        assert np.count_nonzero(data.qfrc_actuator) == 1


@pytest.mark.parametrize("name", FOREIGN)
def test_a_folder_made_of_public_numbers_states_them_again(name: str, foreign: Foreign) -> None:
    known, rover = FOREIGN[name], foreign(name)
    assert (rover.drive.left, rover.drive.right) == (known.left, known.right)
    measured = (rover.wheel_radius, rover.wheelbase, rover.track, rover.top_speed)
    stated = (known.wheel_radius, known.wheelbase, known.track, known.top_speed)
    assert measured == pytest.approx(stated, rel=1e-3)
    assert f"{known.mass:.1f} kg, {2 * len(known.left)} wheels" in rover.summary


def test_a_buggy_steers_its_front_wheels_and_drives_those_with_transmissions(foreign: Foreign) -> None:
    buggy = foreign("buggy")
    assert buggy.drive.steering == ("left_steering", "right_steering")
    assert buggy.drive.driven == ("rear_left_joint", "rear_right_joint")
    assert buggy.steered_wheels == ("front_left_joint", "front_right_joint")
    assert (buggy.drive.steering_limit, buggy.drive.steering_rate) == (0.4189, 3.2)
    # By hand: the inner wheel at its limit, the centre of the circle on the rear axle's line.
    assert buggy.tightest_turn == pytest.approx(0.3302 / 0.44528 + 0.2413 / 2, abs=1e-3)


def test_wheels_are_named_by_side_and_place(foreign: Foreign) -> None:
    assert ROVERS["leo"].wheel_names == ("front_left", "rear_left", "front_right", "rear_right")
    assert foreign("sojourner").wheel_names[:3] == ("front_left", "middle_left", "rear_left")
    frames = [frame_name(body) for body in ("base_link", "imu_frame", "wheel")]
    assert frames == ["base_link", "imu_frame", "wheel_link"]


@pytest.mark.parametrize(
    ("robot", "valid"), [("spot", ", ".join(ROVERS)), (__file__, "harness.robot new NAME --from ")]
)
def test_a_rover_that_does_not_exist_is_refused_with_what_is_valid(robot: str, valid: str) -> None:
    with pytest.raises(UsageError, match=valid):
        find_rover(robot)


def test_what_is_known_of_each_rover_is_what_was_kept(foreign: Foreign) -> None:
    rovers = [ROVERS[name] if name in ROVERS else foreign(name) for name in (*ROVERS, *FOREIGN)]
    lines = []
    for rover in rovers:
        kinds = [IDEAL] if rover.actuators is None else [IDEAL, REAL]
        for kind, surface in product(kinds, ("", *rover.surfaces)):
            own = equipped(rover, kind, surface)
            known = own.model_dump(mode="json", exclude_defaults=True)
            plain = {} if own is rover else rover.model_dump(mode="json", exclude_defaults=True)
            told = {key: value for key, value in known.items() if value != plain.get(key)}
            lines.append(
                f"{rover.name} {kind} {surface} {json.dumps(told)}".replace(str(rover.folder), "")
            )
        placed = ((link.name, link.in_base.round(6).tolist()) for link in rover_frames(rover).links)
        lines.append(json.dumps(dict(placed)))
    check_snapshot("rovers.txt", "\n".join(lines) + "\n")
