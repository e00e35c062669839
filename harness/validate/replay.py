"""A rover of ours driven by recorded commands: what it then has recorded, what its controller wants."""

from itertools import pairwise

import numpy as np

from harness.base.sim_time import HIGHEST_RATE, TICK
from harness.episode.sensing import vibration_of
from harness.physics.base_controller import base_controller, mean_of
from harness.physics.motor_power import MotorPower
from harness.robots import RoverSpec
from harness.samples import Twist
from harness.sensors.state import ImuSensor
from harness.validate.grounds import Course, flat
from harness.validate.recordings.recording import Recording, Series, at, changes
from harness.validate.rig import Rig

# How often a real rover's log has something new [ticks of 10 ms].
WHEELS, POSES, IMU = 15, 10, 100 // HIGHEST_RATE


def replay(
    rover: RoverSpec,
    commands: Series,
    end: float,
    *,
    seed: int = 0,
    course: Course | None = None,
    every: int | None = None,
) -> Recording:
    """Drives a rover with real motors by commands and returns what it recorded.

    Args:
        rover: Equipped as it is to be; its poses are those of its model frame, from 0, 0, 0.
        commands: Times from 0 [s], v [m/s], yaw rate [rad/s]; each holds until the next.
        end: When it ends [s].
        seed: Of what shakes the IMU.
        course: The ground; None for a level plane.
        every: Ticks from one sample of wheels and currents to the next; None for WHEELS.
    """
    every = WHEELS if every is None else every
    rig = Rig(rover, flat() if course is None else course)
    simulation, radius = rig.simulation, rover.controller_radius
    motors, imu = MotorPower(simulation), ImuSensor(simulation, IMU)
    vibration = vibration_of(rover.vibration, seed)
    left, right = (
        [int(simulation.model.joint(name).dofadr[0]) for name in side]
        for side in (rover.drive.left, rover.drive.right)
    )
    logs: dict[str, list[tuple[float, ...]]] = {"wheels": [], "currents": [], "imu": [], "poses": []}
    due, drawn = 0, np.zeros(2)
    for tick in range(round(end / TICK)):
        while due < len(commands) and commands[due, 0] <= (tick + 0.5) * TICK:
            rig.command(*commands[due, 1:].tolist())
            due += 1
        rig.tick()
        imu.observe(simulation.tick_sum[None])
        drawn = drawn + motors.draw(simulation.tick_sum)[0]
        now = (tick + 1) * TICK
        turning = simulation.data.qvel.tolist()
        speeds = [radius * mean_of(turning, side) for side in (left, right)]
        if tick % every == 0:
            logs["wheels"].append((now, *speeds))
            logs["currents"].append((now, *(drawn / (every if tick else 1)).tolist()))
            drawn = np.zeros(2)
        if tick % IMU == 0:
            read = imu.read()
            force = read.linear_acceleration
            if vibration is not None:
                force = vibration.shake(force, sum(speeds) / 2, read.stamp_ns)
            logs["imu"].append((now, *read.angular_velocity, *force))
        if tick % POSES == 0:
            stance = rig.stance
            logs["poses"].append((now, stance.ahead, stance.aside, stance.yaw - rig.heading))
    series = {name: np.array(rows) for name, rows in logs.items()}
    return Recording(rover.name, commands=commands, **series)  # type: ignore[arg-type]  # names of series alone


def controlled(rover: RoverSpec, recording: Recording) -> Series:
    """Returns the speeds of the sides that a rover's controller wants of a recording's commands.

    Returns:
        Times [s], left and right [m/s].
    """
    drive, wheels = base_controller(rover, TICK), recording.wheels
    left = np.array([name in rover.drive.left for name in rover.drive.driven])
    ends = TICK * np.arange(1, round(wheels[-1, 0] / TICK) + 1)
    speeds = np.empty((ends.size, left.size))
    commanded = at(recording.commands, ends - 0.5 * TICK)
    for first, last in pairwise([*np.flatnonzero(changes(commanded)).tolist(), ends.size]):
        drive.command(Twist(*commanded[first].tolist()))
        speeds[first:last] = drive.ahead(last - first)[:, : left.size]
    rims = speeds * rover.controller_radius
    return np.column_stack([ends, rims[:, left].mean(axis=1), rims[:, ~left].mean(axis=1)])
