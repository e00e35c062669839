"""One rover that is driven, control period by control period: the physics and the sensors of an episode.

What it senses is what `harness.run` publishes, at the same ticks, with the same noise: the same commands
give the same samples, to the bit.
"""

from collections import deque
from dataclasses import replace

from harness.base.sim_time import TICK, TICKS_PER_CONTROL
from harness.episode.sensing import sensor_noise
from harness.gym.course import Course, Variation
from harness.physics.base_controller import base_controller
from harness.physics.motor_power import MotorPower
from harness.physics.scene import HAZARD_CONTACT, SCRAPE_CONTACT
from harness.physics.truth.wheels import SoilWheels
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist
from harness.sensors.base import EpisodeParts
from harness.sensors.ranging import RangeReading
from harness.sensors.suite import SensorSuite
from harness.spec.rover import IMU_RATE
from harness.world.world import Start

SENSED = (LaserScan, Imu, Pose, Odometry)
HOUR = 3600.0  # [s]

Readings = dict[type[Sample], Sample]


class DrivenRover:
    """One episode's rover, settled, after one control period of standing: everything has been read.

    Args:
        course: Where it drives.
        start: x, y [m] and yaw [rad] in the world.
        variation: How the rover differs from the one that ships.
        noise_seed: Seed of the sensors' noise.

    Attributes:
        simulation: The physics.
        readings: The last samples, of each kind in SENSED and of the depth camera if there is one; as
            much older as the variation's latency says.
        hazard_s: Contact of the rover with hazards in the last control period [s].
        energy: What the motors took in the last control period [W h]; 0 of servos.
        scrape_s: Contact of anything but wheels with the ground in the last control period [s].
        soil: What soil does to the wheels; None on rigid ground.

    Raises:
        UsageError: The rover cannot stand there.
        RunFailed: The rover left the map or the simulation diverged while it settled.
    """

    def __init__(self, course: Course, start: Start, variation: Variation, noise_seed: int) -> None:
        scene = course.varied(start, variation)
        self.simulation = course.settled(scene, (start, replace(variation, latency=0.0)))
        self._base = base_controller(scene.rover, TICK)
        lidar = course.lidar_of(self.simulation)
        parts = EpisodeParts(simulation=self.simulation, lidar=lidar)
        noise = sensor_noise(
            course.run.rover.noise, noise_seed, course.lidar.spec, scene.rover.vibration
        )
        self._suite = SensorSuite(parts, scene.rover, {Imu: IMU_RATE}, wanted=SENSED, noise=noise)
        self._camera = course.camera_of(self.simulation, lidar, noise_seed)
        self._late: deque[Readings] = deque(maxlen=1 + variation.late_periods)
        sensors = [scene.model.sensor(index) for index in range(scene.model.nsensor)]
        scrapes = [int(s.adr[0]) for s in sensors if s.name.startswith(SCRAPE_CONTACT)]
        self._touches = [int(scene.model.sensor(HAZARD_CONTACT).adr[0]), *scrapes]
        self._motors, self.energy = MotorPower(self.simulation) if scene.rover.real else None, 0.0
        self._soil = None if self.simulation.physics.bed is None else SoilWheels(self.simulation)
        self._ticks = 0
        self.readings: Readings = {}
        self.advance(Twist())

    def advance(self, twist: Twist) -> None:
        """Drives one control period with a command, and reads; RunFailed as by `read`."""
        self.command(twist)
        self.drive()
        self.read()

    def command(self, twist: Twist) -> None:
        """Makes of a command what the wheels do in the control period that `drive` lets pass."""
        self._base.command(twist)
        self.simulation.command_ahead(self._base.ahead(TICKS_PER_CONTROL))

    def drive(self) -> None:
        """Lets the physics go on by one control period."""
        self.simulation.physics.run(watched=False)

    def read(self) -> None:
        """Reads the sensors of the period just driven; with RunFailed the readings are from before."""
        physics, begun = self.simulation.physics, self._ticks + 1
        for _ in physics.shown(lambda tick: self._suite.needs(begun + tick)):
            self._ticks += 1
            self._suite.tick(self._ticks)
        counts = physics.latest_sums(TICKS_PER_CONTROL)
        if self._motors is not None:
            self.energy = sum(self._motors.draw(sums)[1] for sums in counts) * TICK / HOUR
        touches = counts[:, self._touches].tolist()  # lists are faster than arrays as small as this
        self.hazard_s = TICK * sum([tick[0] != 0.0 for tick in touches])
        self.scrape_s = TICK * sum([any(tick[1:]) for tick in touches])
        self.soil = None if self._soil is None else self._soil.state()
        readings = self._suite.latest.copy()
        if self._camera is not None:
            readings[RangeReading] = self._camera.read()
        self._late.append(readings)
        self.readings = self._late[0]
