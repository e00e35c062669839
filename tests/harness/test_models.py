"""The MJCF models, read back after compilation, against their sources (models/README.md)."""

from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.robots import ROVERS, RoverSpec
from tests.support.rovers import LEO, ROVER_ZERO4WD

GRAVITY = 9.8
TIMESTEP = 0.0025
VISUAL_GROUP, COLLISION_GROUP = 2, 3
GROUND = {"contype": 2, "conaffinity": 1}
BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())

Tensor = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, kw_only=True)
class Source:
    """RoboTerrain's numbers; inertia tensors as xx, yy, zz, xy, xz, yz about the centre of mass."""

    total_mass: float
    body_mass: float
    body_center: tuple[float, float, float]
    body_inertia: Tensor
    wheel_mass: float
    wheel_inertia: Tensor
    wheel_torque: float
    wheel_friction: float
    body_friction: float
    imu: tuple[float, float, float]
    lidar: tuple[float, float, float]


SOURCES = {
    LEO.name: Source(
        total_mass=5.495,
        body_mass=1.586231,
        body_center=(-0.01965, 0.01168, 0.16607),
        body_inertia=(0.010426, 0.010454, 0.018173, 0.001176, -0.000888, 0.000220),
        wheel_mass=0.283642,
        wheel_inertia=(0.000391, 0.0004716, 0.000391, 0, 0, 0),
        wheel_torque=4.0,
        wheel_friction=1.0,
        body_friction=0.3,
        imu=(0.0628, -0.0314, 0.15853),
        lidar=(0.174, 0.0, 0.6 + 0.19783),
    ),
    ROVER_ZERO4WD.name: Source(
        total_mass=12.486,
        body_mass=7.48592,
        body_center=(-0.00394, 0.0, 0.16283),
        body_inertia=(0.062935, 0.139552, 0.156719, 0, 0.001716, 0),
        wheel_mass=1.25,
        wheel_inertia=(0.005645, 0.01008, 0.005645, 0, 0, 0),
        wheel_torque=7.0,
        wheel_friction=1.0,
        body_friction=1.0,
        imu=(0.0, 0.0, 0.221),
        lidar=(0.174, 0.0, 0.321),
    ),
}


def rover_model(rover: RoverSpec) -> mujoco.MjModel:
    return mujoco.MjSpec.from_file(str(rover.model_path)).compile()


def wheel_bodies(model: mujoco.MjModel, rover: RoverSpec) -> list[int]:
    return [int(model.joint(name).bodyid[0]) for name in rover.wheel_joints]


def collision_geoms(model: mujoco.MjModel, prefix: str) -> list[int]:
    names = [model.geom(index).name for index in range(model.ngeom)]
    return [index for index, name in enumerate(names) if name.startswith(prefix)]


def in_model_frame(model: mujoco.MjModel) -> mujoco.MjData:
    """The rover as drawn: its root frame at the origin, every joint at zero."""
    data = mujoco.MjData(model)
    data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0]
    mujoco.mj_forward(model, data)
    return data


def inertia_tensor(model: mujoco.MjModel, body: int) -> NDArray[np.float64]:
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, model.body_iquat[body])
    rotation = axes.reshape(3, 3)
    return rotation @ np.diag(model.body_inertia[body]) @ rotation.T


def symmetric(tensor: Tensor) -> NDArray[np.float64]:
    xx, yy, zz, xy, xz, yz = tensor
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def lowest_point(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Height of the lowest point of a box, cylinder or capsule in the world."""
    up = np.abs(data.geom_xmat[geom].reshape(3, 3)[2])  # of the geom's axes
    size = model.geom_size[geom]
    radius, half_length = size[0], size[1]
    reach = {
        mujoco.mjtGeom.mjGEOM_BOX: up @ size,
        mujoco.mjtGeom.mjGEOM_CAPSULE: radius + half_length * up[2],
        mujoco.mjtGeom.mjGEOM_CYLINDER: radius * np.hypot(up[0], up[1]) + half_length * up[2],
    }
    return float(data.geom_xpos[geom][2] - reach[mujoco.mjtGeom(model.geom_type[geom])])


class Drive:
    """A rover settled on flat ground, on which a bar may lie across the path of its left wheels."""

    def __init__(self, rover: RoverSpec, bar_height: float = 0.0, timestep: float = TIMESTEP) -> None:
        spec = mujoco.MjSpec.from_file(str(rover.model_path))
        spec.option.timestep = timestep
        for equality in spec.equalities:
            equality.solref[0] = max(equality.solref[0], 2 * timestep)
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[20, 20, 1], **GROUND)
        if bar_height:
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=[0.05, 0.5, bar_height / 2],
                pos=[0.5, 0.52, bar_height / 2],
                **GROUND,
            )
        self.rover = rover
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.data.qpos[2] = rover.rest_height + 0.005
        self.run(seconds=2.0)

    def command(self, linear: float, angular: float = 0.0) -> None:
        half_difference = angular * self.rover.controller_separation / 2
        left, right = linear - half_difference, linear + half_difference
        for name, speed in zip(self.rover.wheel_joints, (left, left, right, right), strict=True):
            self.data.actuator(name).ctrl[0] = speed / self.rover.controller_radius

    def run(self, seconds: float) -> None:
        mujoco.mj_step(self.model, self.data, nstep=round(seconds / self.model.opt.timestep))

    def record(self, seconds: float, sensor: str) -> NDArray[np.float64]:
        rows = []
        for _ in range(round(seconds / self.model.opt.timestep)):
            mujoco.mj_step(self.model, self.data)
            rows.append(self.data.sensor(sensor).data.copy())
        return np.array(rows)

    def rockers(self) -> NDArray[np.float64]:
        return np.array([self.data.joint(name).qpos[0] for name in self.rover.passive_joints])


@BOTH
def test_the_whole_rover_weighs_what_its_sources_sum_up_to(rover: RoverSpec) -> None:
    assert rover_model(rover).body_mass.sum() == pytest.approx(SOURCES[rover.name].total_mass, abs=5e-4)


@BOTH
def test_the_body_has_the_mass_centre_and_inertia_of_the_source(rover: RoverSpec) -> None:
    model, source = rover_model(rover), SOURCES[rover.name]
    body = model.body("rover").id
    assert model.body_mass[body] == pytest.approx(source.body_mass)
    assert model.body_ipos[body] == pytest.approx(source.body_center, abs=1e-5)
    assert inertia_tensor(model, body) == pytest.approx(symmetric(source.body_inertia), abs=1e-8)


@BOTH
def test_every_wheel_has_the_mass_and_inertia_of_the_source(rover: RoverSpec) -> None:
    model, source = rover_model(rover), SOURCES[rover.name]
    for wheel in wheel_bodies(model, rover):
        assert model.body_mass[wheel] == pytest.approx(source.wheel_mass)
        tensor = inertia_tensor(model, wheel)
        assert tensor == pytest.approx(symmetric(source.wheel_inertia), abs=1e-9)


@pytest.mark.parametrize(("side", "y_sign"), [("L", 1.0), ("R", -1.0)])
def test_leos_rockers_are_mirrored_but_for_their_products_of_inertia(side: str, y_sign: float) -> None:
    # The source turns the left rocker's frame by pi about z, which keeps xy and negates xz and yz.
    model = rover_model(LEO)
    rocker = model.body(f"rocker_{side}").id
    turned = symmetric((0.002956, 0.02924, 0.02832, -1.489e-6, y_sign * 8.103e-6, y_sign * -7.112e-5))
    assert model.body_mass[rocker] == pytest.approx(1.387336)
    assert model.body_pos[rocker] == pytest.approx([0.00263, y_sign * 0.14167, 0.15052])
    assert model.body_ipos[rocker] == pytest.approx([0, y_sign * -0.01346, -0.06506])
    assert inertia_tensor(model, rocker) == pytest.approx(turned, abs=1e-8)


@BOTH
def test_the_wheels_have_the_specified_size_and_touch_the_ground(rover: RoverSpec) -> None:
    model = rover_model(rover)
    data = in_model_frame(model)
    for geom in collision_geoms(model, "wheel_"):
        radius, half_width, _ = model.geom_size[geom]
        assert (radius, 2 * half_width) == pytest.approx((rover.wheel_radius, rover.wheel_width))
        assert data.geom_xpos[geom][2] - radius == pytest.approx(-rover.rest_height, abs=1e-6)


@BOTH
def test_the_wheels_stand_at_the_specified_wheelbase_and_track(rover: RoverSpec) -> None:
    model = rover_model(rover)
    data = in_model_frame(model)
    front_left, rear_left, front_right, rear_right = data.xpos[wheel_bodies(model, rover)]
    assert front_left[0] - rear_left[0] == pytest.approx(rover.wheelbase, abs=1e-4)
    assert front_right[0] - rear_right[0] == pytest.approx(rover.wheelbase, abs=1e-4)
    assert front_left[1] - front_right[1] == pytest.approx(rover.track, abs=1e-4)
    assert rear_left[1] - rear_right[1] == pytest.approx(rover.track, abs=1e-4)


@BOTH
def test_the_footprint_encloses_the_wheels(rover: RoverSpec) -> None:
    model = rover_model(rover)
    x, y, _ = in_model_frame(model).xpos[wheel_bodies(model, rover)].T
    half_width = rover.wheel_width / 2
    wheels = (
        x.min() - rover.wheel_radius,
        x.max() + rover.wheel_radius,
        y.min() - half_width,
        y.max() + half_width,
    )
    assert wheels == pytest.approx(rover.footprint, abs=2e-3)  # zero's is that of the tyre mesh


@BOTH
def test_the_underside_is_as_far_above_the_ground_as_the_clearance_says(rover: RoverSpec) -> None:
    model = rover_model(rover)
    data = in_model_frame(model)
    body = model.body("rover").id
    parts = [g for g in collision_geoms(model, "body_") if model.geom_bodyid[g] == body]
    lowest = min(lowest_point(model, data, geom) for geom in parts)
    assert lowest + rover.rest_height == pytest.approx(rover.clearance, abs=5e-4)


def test_leos_rocker_arms_are_lowest_at_the_hubs_and_arch_above_the_underside_between() -> None:
    model = rover_model(LEO)
    data = in_model_frame(model)
    arms = collision_geoms(model, "body_rocker")
    assert [lowest_point(model, data, arm) for arm in arms] == pytest.approx([0.037] * 4, abs=5e-4)
    x, y, _ = data.xpos[model.body("rocker_L").id]
    below_pivot, up = np.array([x, y - 0.01346, 0.0]), np.array([0.0, 0.0, 1.0])
    groups = np.eye(6, dtype=np.uint8)[COLLISION_GROUP]
    hit = np.zeros(1, dtype=np.int32)
    height = mujoco.mj_ray(model, data, below_pivot, up, groups, 1, -1, hit)
    assert model.geom(int(hit[0])).name == "body_chassis"
    assert height == pytest.approx(LEO.clearance, abs=5e-4)


@BOTH
def test_the_imu_sits_where_the_source_puts_it(rover: RoverSpec) -> None:
    model = rover_model(rover)
    site = model.site("imu")
    assert site.bodyid[0] == model.body("rover").id
    assert site.pos == pytest.approx(SOURCES[rover.name].imu)
    assert site.quat == pytest.approx([1, 0, 0, 0])


@BOTH
def test_the_lidar_looks_backward_from_its_height_over_the_ground(rover: RoverSpec) -> None:
    model = rover_model(rover)
    site = model.site("lidar")
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, site.quat)
    assert site.bodyid[0] == model.body("rover").id
    assert site.pos == pytest.approx(SOURCES[rover.name].lidar)
    assert axes.reshape(3, 3) == pytest.approx(np.diag([-1, -1, 1]), abs=1e-9)
    assert site.pos[2] + rover.rest_height == pytest.approx(rover.lidar_height, abs=5e-4)


@BOTH
def test_the_wheels_are_driven_in_order_within_the_limits_of_speed_and_torque(
    rover: RoverSpec,
) -> None:
    model, torque = rover_model(rover), SOURCES[rover.name].wheel_torque
    names = tuple(model.actuator(index).name for index in range(model.nu))
    driven = tuple(model.joint(joint).name for joint, _ in model.actuator_trnid)
    assert names == driven == rover.wheel_joints
    for limits, limit in (
        (model.actuator_ctrlrange, rover.wheel_speed_limit),
        (model.actuator_forcerange, torque),
    ):
        assert limits == pytest.approx(np.array([[-limit, limit]] * 4))


@pytest.mark.parametrize(
    ("rover", "joints", "damping", "dry_friction"),
    [
        (LEO, LEO.wheel_joints, 0.1, 0.3125),
        (LEO, LEO.passive_joints, 0.1, 1.0),
        (ROVER_ZERO4WD, ROVER_ZERO4WD.wheel_joints, 0.05, 0.1),  # estimates
    ],
    ids=["leo wheels", "leo rockers", "rover_zero4wd wheels"],
)
def test_the_joints_resist_as_the_source_says(
    rover: RoverSpec, joints: tuple[str, ...], damping: float, dry_friction: float
) -> None:
    model = rover_model(rover)
    for name in joints:
        dof = model.joint(name).dofadr[0]
        assert model.dof_damping[dof] == pytest.approx(damping)
        assert model.dof_frictionloss[dof] == pytest.approx(dry_friction)


def test_leos_rockers_swing_within_the_limits_of_the_source() -> None:
    model = rover_model(LEO)
    for name in LEO.passive_joints:
        assert model.joint(name).range == pytest.approx([-0.24, 0.24])


@BOTH
def test_only_collision_geoms_collide_and_only_with_the_world(rover: RoverSpec) -> None:
    model = rover_model(rover)
    collision = collision_geoms(model, "wheel_") + collision_geoms(model, "body_")
    visual = sorted(set(range(model.ngeom)) - set(collision))
    for geoms, group, contype, conaffinity in (
        (collision, COLLISION_GROUP, 1, 2),
        (visual, VISUAL_GROUP, 0, 0),
    ):
        assert set(model.geom_group[geoms]) == {group}
        assert set(model.geom_contype[geoms]) == {contype}
        assert set(model.geom_conaffinity[geoms]) == {conaffinity}


@BOTH
def test_the_contact_with_the_ground_has_the_rovers_friction(rover: RoverSpec) -> None:
    model, source = rover_model(rover), SOURCES[rover.name]
    ground_priority, ground_friction = 0, 1.0
    for prefix, friction in (
        ("wheel_", source.wheel_friction),
        ("body_", source.body_friction),
    ):
        for geom in collision_geoms(model, prefix):
            own = model.geom_friction[geom][0]
            wins = model.geom_priority[geom] > ground_priority
            assert (own if wins else max(own, ground_friction)) == pytest.approx(friction)


def test_the_payload_box_stands_where_the_payloads_mass_does() -> None:
    """2.95 kg of the 7.48592 kg body; the chassis' own centre of mass is at x = 0 (source: payload)."""
    model = rover_model(ROVER_ZERO4WD)
    box, body = model.geom("body_payload"), model.body("rover")
    assert 2.95 * box.pos[0] == pytest.approx(7.48592 * body.ipos[0], abs=1e-4)
    assert box.pos[1:] == pytest.approx((0.0, 0.125 + 0.096))


@BOTH
def test_at_rest_the_imu_reads_gravity_upward(rover: RoverSpec) -> None:
    drive = Drive(rover)
    force = drive.record(1.0, "imu_accelerometer")
    rate = drive.record(1.0, "imu_gyro")
    assert force.mean(axis=0) == pytest.approx([0, 0, GRAVITY], abs=0.05)
    assert np.linalg.norm(force, axis=1) == pytest.approx(GRAVITY, abs=0.05)
    assert rate == pytest.approx(0.0, abs=1e-4)


@BOTH
def test_at_rest_nothing_creeps_and_the_wheels_hardly_sink(rover: RoverSpec) -> None:
    drive = Drive(rover)
    before = drive.data.qpos.copy()
    drive.run(seconds=5.0)
    assert drive.data.qpos == pytest.approx(before, abs=1e-5)
    sink = rover.rest_height - drive.data.qpos[2]
    assert 0.0 < sink < 2e-3


@pytest.mark.parametrize("timestep", [0.001, 0.002, 0.0025, 0.005])
@pytest.mark.parametrize(
    ("rover", "slowest", "fastest"),
    [(LEO, 0.49, 0.50), (ROVER_ZERO4WD, 0.515, 0.520)],  # zero: as measured in RoboTerrain's bags
    ids=ROVERS.keys(),
)
def test_half_a_metre_per_second_commanded_is_driven_as_in_roboterrain(
    rover: RoverSpec, slowest: float, fastest: float, timestep: float
) -> None:
    drive = Drive(rover, timestep=timestep)
    drive.command(linear=0.5)
    drive.run(seconds=1.0)
    start = drive.data.qpos[:3].copy()
    drive.run(seconds=2.0)
    moved = drive.data.qpos[:3] - start
    assert slowest < moved[0] / 2.0 < fastest
    assert moved[1:] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(
    ("rover", "least", "most"),
    [
        (LEO, 0.55, 0.59),  # 1 / 1.76, the firmware's angular_velocity_multiplier, is 0.568
        (ROVER_ZERO4WD, 0.3, 0.24 / 0.36),  # without any skid: believed over true track
    ],
    ids=ROVERS.keys(),
)
def test_turning_in_place_loses_the_yaw_rate_that_skidding_costs(
    rover: RoverSpec, least: float, most: float
) -> None:
    drive = Drive(rover)
    drive.command(linear=0.0, angular=1.0)
    drive.run(seconds=1.0)
    assert least < drive.record(2.0, "imu_gyro")[:, 2].mean() < most


@BOTH
def test_turning_in_place_on_flat_ground_does_not_rattle(rover: RoverSpec) -> None:
    drive = Drive(rover)
    drive.command(linear=0.0, angular=1.0)
    drive.run(seconds=1.0)
    assert drive.record(3.0, "imu_accelerometer")[:, 2].std() < 0.3


def test_leos_differential_lets_one_rocker_rise_as_far_as_the_other_sinks() -> None:
    drive = Drive(LEO, bar_height=0.05)
    drive.command(linear=0.4)
    rockers = []
    for _ in range(500):
        drive.run(seconds=0.005)
        rockers.append(drive.rockers())
    left, right = np.array(rockers).T
    assert left.min() < -0.05  # its front wheel on the bar: nose up, which is negative about +y
    assert right.max() > 0.05
    assert np.abs(left + right).max() < 1e-3


def test_leo_climbs_with_one_side_the_70_mm_that_its_data_sheet_promises() -> None:
    drive = Drive(LEO, bar_height=0.07)
    drive.command(linear=0.3)
    drive.run(seconds=4.0)
    assert drive.data.qpos[0] > 0.55 + LEO.wheelbase / 2 + LEO.wheel_radius
