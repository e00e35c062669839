"""Every rover folder, shipped or made of a URDF: what is known of it against its compiled model."""

import copy
from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.robots import ROVERS, RoverSpec, find_rover
from harness.robots.measures import Measures, frame_name
from harness.robots.model import read_model
from tests.support.foreign_rovers import FOREIGN

Foreign = Callable[[str], RoverSpec]
Points = NDArray[np.float64]
COLLIDING = 3  # the group of geoms that collide


class Bare:
    """A rover's model, compiled, with its root at the origin and its joints at 0."""

    def __init__(self, rover: RoverSpec) -> None:
        self.rover = rover
        self.model = read_model(rover).compile()
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:], self.data.qpos[3] = 0.0, 1.0
        mujoco.mj_forward(self.model, self.data)
        self.wheels = [int(self.model.joint(name).bodyid[0]) for name in rover.wheel_joints]
        colliding = np.flatnonzero(self.model.geom_group == COLLIDING)
        of_wheel = np.isin(self.model.geom_bodyid[colliding], self.wheels)
        self.tyres, self.body = colliding[of_wheel].tolist(), colliding[~of_wheel].tolist()

    def lowest(self, geom: int) -> float:
        """Height of the lowest point of a geom, by the support function of its shape [m]."""
        up, size = self.data.geom_xmat[geom].reshape(3, 3)[2], self.model.geom_size[geom]
        shapes = mujoco.mjtGeom
        reach = {
            shapes.mjGEOM_BOX: np.abs(up) @ size,
            shapes.mjGEOM_ELLIPSOID: np.linalg.norm(up * size),
            shapes.mjGEOM_CAPSULE: size[0] + size[1] * abs(up[2]),
            shapes.mjGEOM_CYLINDER: size[0] * np.hypot(up[0], up[1]) + size[1] * abs(up[2]),
        }
        return float(self.data.geom_xpos[geom][2] - reach[shapes(self.model.geom_type[geom])])


@pytest.fixture(scope="module", params=[*ROVERS, *FOREIGN])
def bare(request: pytest.FixtureRequest, foreign: Foreign) -> Bare:
    name = request.param
    return Bare(ROVERS[name] if name in ROVERS else foreign(name))


def test_wheels_have_the_stated_size_and_stand_on_the_ground(bare: Bare) -> None:
    rover = bare.rover
    sizes = bare.model.geom_aabb[bare.tyres, 3:]
    assert 2 * sizes.max() == pytest.approx(2 * rover.wheel_radius)
    assert 2 * sizes.min(axis=1).max() == pytest.approx(rover.wheel_width)
    for tyre in bare.tyres:
        assert bare.lowest(tyre) == pytest.approx(-rover.rest_height, abs=1e-6)


def test_wheels_stand_in_order_at_the_stated_wheelbase_and_track(bare: Bare) -> None:
    left, right = np.split(bare.data.xpos[bare.wheels], 2)
    assert (np.diff(left[:, 0]) < 0).all()  # front to rear
    assert left[:, 0] == pytest.approx(right[:, 0], abs=1e-6)
    assert left[:, 1] - right[:, 1] == pytest.approx(bare.rover.track, abs=1e-4)
    assert left[0, 0] - left[-1, 0] == pytest.approx(bare.rover.wheelbase, abs=1e-4)


def test_the_footprint_is_that_of_the_wheels_and_of_what_stands_out_further(bare: Bare) -> None:
    rover, (x, y, _) = bare.rover, bare.data.xpos[bare.wheels].T
    radius, half = rover.wheel_radius, rover.wheel_width / 2
    wheels = (x.min() - radius, x.max() + radius, y.min() - half, y.max() + half)
    beyond = np.array([-1, 1, -1, 1]) * (np.array(rover.footprint) - wheels)
    assert (beyond > -2e-3).all()  # rover_zero4wd's is that of a tyre mesh
    for geom in bare.body:
        corner = np.abs(bare.data.geom_xpos[geom][:2]).max() + bare.model.geom_rbound[geom]
        if corner < min(rover.length, rover.width) / 2:
            continue
        assert max(beyond) < bare.model.geom_rbound[geom]


def test_the_clearance_is_that_of_the_lowest_part_of_the_body(bare: Bare) -> None:
    model = bare.model
    root = [g for g in bare.body if model.body_weldid[model.geom_bodyid[g]] == 1] or bare.tyres
    lowest = min(bare.lowest(geom) for geom in root)
    assert lowest + bare.rover.rest_height == pytest.approx(bare.rover.clearance, abs=5e-4)


def test_every_joint_is_published_once_and_every_motor_turns_its_joint(bare: Bare) -> None:
    rover, model = bare.rover, bare.model
    hinges = [model.joint(index).name for index in range(1, model.njnt)]
    assert sorted(rover.joints) == sorted(hinges)
    assert rover.joints[: len(rover.wheel_joints)] == rover.wheel_joints
    motors = {model.joint(int(joint)).name: n for n, (joint, _) in enumerate(model.actuator_trnid)}
    assert set(rover.motors) <= motors.keys()
    driving = [motors[name] for name in rover.drive.driven]
    assert model.actuator_ctrlrange[driving, 1].min() == pytest.approx(rover.wheel_speed_limit)
    for name in rover.motors:
        data, dof = copy.copy(bare.data), int(model.joint(name).dofadr[0])
        data.ctrl[motors[name]] = 0.1
        mujoco.mj_forward(model, data)
        assert data.qfrc_actuator[dof] > 0.0
        assert np.count_nonzero(data.qfrc_actuator) == 1


def test_cruising_stays_within_the_speed_of_the_wheels(bare: Bare) -> None:
    rover = bare.rover
    speed = rover.cruise_speed * (rover.steers or 1.0)
    turning = 0.0 if rover.steers else rover.cruise_yaw_rate * rover.controller_separation / 2
    assert (speed + turning) / rover.controller_radius <= rover.wheel_speed_limit * 1.01
    assert (rover.length, rover.width) == pytest.approx(
        (rover.footprint[1] - rover.footprint[0], rover.footprint[3] - rover.footprint[2])
    )


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_what_is_read_from_a_shipped_file_is_what_mujoco_measures(rover: RoverSpec) -> None:
    measures = Measures(rover)
    for key, value in measures.facts().items():
        read = getattr(rover, key)
        assert value == (pytest.approx(read) if "wheel_" in key or key == "gravity" else read), key
    derived = measures.derived()
    for key in ("rest_height", "wheelbase", "track", "lidar_height"):
        assert derived[key] == pytest.approx(getattr(rover, key), abs=5e-4), key
    assert derived["footprint"] == pytest.approx(rover.footprint, abs=2e-3)


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
