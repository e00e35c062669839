"""Real motors against closed forms: torque over speed, dead time, lag, ties, play, weakness."""

import math
from typing import Any

import mujoco
import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.episode.assembly import check
from harness.episode.episode import Episode
from harness.faults.actuation import ActuatorFaults
from harness.faults.lookup import find_faults
from harness.physics.actuators import MOTOR_SPEED, MOTOR_TORQUE, PLAY, Drag
from harness.physics.base_controller import base_controller
from harness.physics.berths import Member
from harness.physics.motor_power import MotorPower
from harness.physics.scene import Scene, build_scene, build_scenes
from harness.physics.simulation import Simulation
from harness.physics.soil import soil_bed
from harness.robots import IDEAL, REAL, ROVERS, RoverSpec, equipped
from harness.samples import Twist
from harness.spec.fault import parse_fault
from harness.spec.run import Run
from harness.world.heightfield import Heightfield
from harness.world.soil_map import soils_on
from harness.world.world import World
from tests.harness.conftest import MakeSimulation
from tests.support.rovers import LEO

HUSKY = ROVERS["husky"]
FRONT_DRIVEN = HUSKY.but(drive=HUSKY.drive.but(driven=HUSKY.drive.driven[::2]))  # others idle
TICK = TICK_NS / NANOSECONDS


def real(rover: RoverSpec = HUSKY, **changes: Any) -> RoverSpec:  # noqa: ANN401 - of several types
    assert rover.actuators is not None
    return equipped(rover.but(actuators=rover.actuators.but(**changes)), REAL, "")


def in_the_air(simulation: Simulation) -> Simulation:
    simulation.model.opt.gravity[:] = 0.0
    simulation.pose[2] += 1.0
    return simulation


def wheel_losses(scene: Scene) -> list[float]:
    """Friction of a rover's wheels [N m]."""
    joints = scene.all_own(scene.rover.wheel_joints)
    return [float(scene.model.dof_frictionloss[scene.model.joint(name).dofadr[0]]) for name in joints]


@pytest.mark.parametrize("motors", [IDEAL, REAL])
@pytest.mark.parametrize("name", ROVERS)
def test_a_rover_goes_where_it_goes_with_finer_steps(name: str, motors: str) -> None:
    """Unless a motor is so stiff for the step that it turns its torque round in each."""
    commands = (0.2, 0.0, 1.0), (1.2, 0.4, -0.5), (2.4, -0.3, 0.2)
    run = Run.of(robot=name, terrain="flat", driver="cmd_vel", commands=commands, actuators=motors)
    run = run.alone(lidar_beams=2)
    coarse, fine = (Episode(run.but(duration=2.8, timestep=timestep)) for timestep in (0.0025, 0.000625))
    one, other = (
        np.array([(*e.simulation.position[:2], e.simulation.yaw) for _ in e.batches()])
        for e in (coarse, fine)
    )
    assert np.ptp(other[:, 2]) > 0.3
    assert one == pytest.approx(other, abs=0.03)


@pytest.mark.parametrize("rover", [*ROVERS.values(), FRONT_DRIVEN], ids=[*ROVERS, "front_driven"])
def test_a_motor_gives_what_current_and_voltage_allow_at_its_speed(
    rover: RoverSpec, simulate: MakeSimulation
) -> None:
    """T = min(K i_max, K / R (V - K w)) against a command that is out of reach."""
    rover = real(rover, backlash=0.0)
    simulation, motors = in_the_air(simulate(rover)), rover.actuators
    assert motors is not None
    simulation.model.dof_damping[6:] = simulation.model.dof_frictionloss[6:] = 0.0
    simulation.model.actuator_ctrlrange[:] *= 100
    simulation.data.ctrl[simulation.motors] = 100 * rover.wheel_speed_limit
    share = len(rover.drive.driven) // 2 if motors.one_motor_a_side else 1
    for _ in range(60):
        before = simulation.data.qvel[simulation.model.joint(rover.drive.driven[0]).dofadr[0]]
        simulation.data.ctrl[simulation.motors] = 100 * rover.wheel_speed_limit
        simulation.physics.tick()
        now = simulation.data.joint(rover.drive.driven[0]).qvel[0]
        constant, resistance = motors.motor_constant, motors.resistance * share
        bounds = [
            min(
                constant * motors.current_limit / share,
                constant / resistance * (motors.voltage - constant * speed),
            )
            for speed in (now, before)
        ]
        torque = float(simulation.data.actuator_force[simulation.motors[0]])
        assert min(bounds) - 1e-6 <= torque <= max(bounds) + 1e-6
    assert now == pytest.approx(motors.voltage / motors.motor_constant, rel=0.05)  # without load


def responses(rover: RoverSpec, twist: Twist, ticks: int) -> np.ndarray:
    controller = base_controller(rover, TICK)
    controller.command(twist)
    return np.array([controller.wheel_speeds() for _ in range(ticks)])


def test_commands_come_late_and_speeds_follow_as_two_lags_do() -> None:
    """1 - (1 + t / T) exp(-t / T) of two equal lags T after the dead time, for a step in the middle."""
    rover = real(delay=0.2, lag=0.3, turn_limit=None).but(linear_acceleration=1e3)
    speeds = responses(rover, Twist(0.5, 0.0), 200)[:, 0] * rover.controller_radius / 0.5
    time = TICK * np.arange(1, 201) - 0.2
    closed = np.where(time > 0, 1 - (1 + time / 0.15) * np.exp(-np.maximum(time, 0) / 0.15), 0.0)
    assert speeds == pytest.approx(closed, abs=0.04)
    assert not speeds[:20].any()


@pytest.mark.parametrize("delay", [0.02, 0.023, 0.087])
@pytest.mark.parametrize("twist", [Twist(0.5, 0.0), Twist(0.0, 0.5)])
@pytest.mark.parametrize("acceleration", [1e3, 5.0])
def test_a_delay_costs_its_own_length_of_the_way_also_parts_of_a_tick(
    delay: float, twist: Twist, acceleration: float
) -> None:
    late, prompt = (
        responses(
            real(delay=seconds, lag=0.0, turn_limit=None).but(
                linear_acceleration=acceleration, angular_acceleration=acceleration
            ),
            twist,
            30,
        )
        for seconds in (delay, 0.0)
    )
    assert TICK * ((prompt - late) / prompt[-1]).sum(axis=0) == pytest.approx(delay)


def test_slow_commands_do_nothing_and_the_sides_differ_by_no_more_than_their_limit() -> None:
    rover = real(delay=0.0, lag=0.0, dead_band=0.05, turn_limit=0.4)
    radius = rover.controller_radius
    assert not responses(rover, Twist(0.04, 0.0), 50).any()
    left, _, right, _ = responses(rover, Twist(0.2, 3.0), 200)[-1] * radius
    assert (right - left, right + left) == pytest.approx((0.4, 0.4))


def test_wheels_of_one_motor_turn_alike_whatever_holds_one(simulate: MakeSimulation) -> None:
    simulation = simulate(real())
    simulation.limit_motors({"left": 1.0, "right": 1.0}, frozenset(["front_left_wheel"]))
    simulation.command_wheels(np.full(4, 2.0))
    for _ in range(100):
        simulation.tick()
    speeds = {name: abs(simulation.data.joint(name).qvel[0]) for name in HUSKY.wheel_joints}
    assert speeds["front_left_wheel"] < 0.01
    assert speeds["rear_left_wheel"] < 0.02
    assert speeds["front_right_wheel"] > 0.5
    simulation.limit_motors({"left": 1.0, "right": 1.0}, frozenset())
    for _ in range(100):
        simulation.tick()
    assert simulation.data.joint("front_left_wheel").qvel[0] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(("motors", "is_limited"), [(REAL, True), (IDEAL, True), (IDEAL, False)])
def test_a_weak_side_gives_its_share_of_the_torque(
    motors: str, is_limited: bool, simulate: MakeSimulation
) -> None:
    simulation, torques = in_the_air(simulate(equipped(HUSKY, motors, ""))), []
    simulation.model.actuator_forcelimited[simulation.motors] &= is_limited
    for faults in ((), ("motor.left:weak=0.5", "motor.left:weak=0.5")):
        ActuatorFaults(find_faults(map(parse_fault, faults), ()), seed=0).act(simulation)
        simulation.data.qvel[:] = 1.0
        simulation.command_wheels(np.full(4, 100.0))
        mujoco.mj_forward(simulation.model, simulation.data)
        torques.append(simulation.data.actuator_force[simulation.motors].copy())
    assert torques[1] == pytest.approx(torques[0] * [0.25, 0.25, 1.0, 1.0], rel=0.05)


def test_drag_holds_back_alike_in_all_directions_and_is_none_without(simulate: MakeSimulation) -> None:
    """In the air, without weight: m v' = -drag m g against the motion, whatever the heading.

    It acts at the model's origin, which is not quite the centre of mass.
    """
    for drag, heading in ((0.0, 0.3), (0.2, 0.0), (0.2, 0.8), (0.2, 2.5)):
        rover = HUSKY.but(tyres=HUSKY.tyres.but(drag=drag))
        simulation = in_the_air(simulate(rover))
        way = np.array([math.cos(heading), math.sin(heading)])
        simulation.twist[:2] = 2.0 * way
        for _ in range(50):
            simulation.tick()
        assert simulation.twist[:2] == pytest.approx((2.0 - drag * rover.gravity * 0.5) * way, abs=0.1)


def test_a_wheel_with_play_turns_that_far_without_its_motor(simulate: MakeSimulation) -> None:
    simulation = in_the_air(simulate(real(LEO, backlash=0.1)))
    model, data, name = simulation.model, simulation.data, LEO.wheel_joints[0]
    dof, low = int(model.joint(name + PLAY).dofadr[0]), []
    for push in (1.0, -1.0):
        data.qfrc_applied[dof] = 0.05 * push
        for _ in range(100):
            simulation.tick()
        low.append(float(data.joint(name + PLAY).qpos[0]))
    assert low == pytest.approx([0.05, -0.05], abs=0.01)


def test_rolling_resistance_is_a_share_of_the_load(simulate: MakeSimulation) -> None:
    """The motors' torque at a steady speed is M g c r more, over all wheels."""
    torques = []
    for rolling in (0.0, 0.1):
        rover = HUSKY.but(tyres=HUSKY.tyres.but(rolling=rolling))
        simulation = simulate(rover)
        simulation.command_wheels(np.full(4, 1.0))
        for _ in range(200):
            simulation.tick()
        torques.append(float(simulation.data.qfrc_actuator[6:].sum()))
    mass = float(simulation.model.body_subtreemass[1])
    assert torques[1] - torques[0] == pytest.approx(0.1 * mass * 9.8 * 0.1651, rel=0.02)


def test_what_ground_resists_and_bears_is_a_share_of_the_weight_in_that_world() -> None:
    rover, found, loads = HUSKY.but(tyres=HUSKY.tyres.but(rolling=0.1, drag=0.2)), list[float](), []
    ground = Heightfield(np.zeros((81, 81)), 0.05)
    for gravity in (9.8, 1.6):
        soil = soils_on("firm", ground, "flat")
        world = World("moon", ground, (), 0, 0.0, gravity=gravity, soil=soil)
        scene = build_scene(world, rover, 0.0025)
        Drag(scene.model, rover, scene.root).turn(np.array([1.0, 0.0]))
        dofs = [0, int(scene.model.joint(rover.wheel_joints[0]).dofadr[0])]
        found += scene.model.dof_frictionloss[dofs].tolist()
        bed = soil_bed((scene,), mujoco.MjData(scene.model))
        assert bed is not None
        loads.append(sum(wheel.load for wheel in bed.wheels))
    mass = float(scene.model.body_subtreemass[scene.root])
    assert found[0::2] == pytest.approx([0.2 * mass * 9.8, 0.2 * mass * 1.6])
    assert found[1] - found[3] == pytest.approx(0.1 * mass * (9.8 - 1.6) / 4 * rover.wheel_radius)
    assert loads == pytest.approx([mass * 9.8, mass * 1.6])
    light = LEO.but(tyres=LEO.tyres.but(rolling=0.1))
    both = build_scenes(world, [Member("a", rover, (0, 0, 0)), Member("b", light, (1.3, 1, 0))], 0.0025)
    assert [wheel_losses(one) for one in both] == [
        pytest.approx(wheel_losses(build_scene(world, one, 0.0025))) for one in (rover, light)
    ]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"robot": "leo", "surface": "moon"}, "surface 'moon' is not one of .*; available: none"),
        ({"robot": "leo", "sensors": ["battery"]}, "'battery' needs --actuators real"),
        ({"faults": ["wheel.fifth:stuck"]}, "available: wheel.front_left"),
        ({"faults": ["motor.left:weak=1"]}, "a share of the torque"),
        ({"faults": ["cmd_vel:zero"]}, "available: latency, dropout, freeze"),
    ],
)
def test_what_a_rover_has_not_is_one_line(fields: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        check(Run.of(**fields))


def test_a_folder_without_motors_cannot_be_real() -> None:
    with pytest.raises(UsageError, match="section 'actuators'"):
        equipped(LEO.but(actuators=None), REAL, "")


def test_a_surface_changes_what_it_states_and_pushes_nobody(simulate: MakeSimulation) -> None:
    met = HUSKY.surfaces["asphalt"].but(radius=0.16)
    worn = HUSKY.but(tyres=HUSKY.tyres.but(drag=0.1), surfaces={"worn": met})
    rover = equipped(worn, IDEAL, "worn")
    assert (rover.tyres.drag, rover.tyres.rolling, rover.wheel_radius) == (0.1, met.rolling, 0.16)
    pushing = worn.but(surfaces={"worn": met.but(falling=2.0)})
    with pytest.raises(UsageError, match="would push husky"):
        simulate(equipped(pushing, IDEAL, "worn"))


def test_motors_of_a_side_that_work_against_each_other_draw_all_the_same(
    simulate: MakeSimulation,
) -> None:
    simulation = simulate(real(LEO))
    motors, sums = MotorPower(simulation), simulation.tick_sum.copy()
    torque = dict(zip(LEO.drive.driven, (1.0, -1.0, 0.0, 0.0), strict=True))
    for name, value in torque.items():
        sums[simulation.felt(MOTOR_TORQUE + name)] = value * simulation.steps_per_tick
        sums[simulation.felt(MOTOR_SPEED + name)] = 0.0
    (left, right), power = motors.draw(sums)
    assert LEO.actuators is not None
    current = 1.0 / LEO.actuators.motor_constant
    assert (left, right) == pytest.approx((2 * current, 0.0))
    assert power == pytest.approx(2 * LEO.actuators.resistance * current**2)
