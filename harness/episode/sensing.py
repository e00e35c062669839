"""What the sensors of an episode are made with: their mounts, their noise, their randomness."""

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from harness.base.streams import EPISODE, OPTIONAL_SENSORS, VIBRATION, generator, seeded
from harness.physics.scene import Scene
from harness.robots.frames.rover_frames import RoverFrames
from harness.robots.lidar import LidarSpec
from harness.robots.sections import Shake
from harness.sensors.noise import EXACT, PRESETS, SensorNoise
from harness.sensors.optional import Installation, SensorOptions
from harness.sensors.rays.bundle import Surroundings
from harness.spec.run import Run
from harness.world.geodesy import Datum

if TYPE_CHECKING:
    from harness.sensors.vibration import Vibration

Given = TypeVar("Given", bound=SensorOptions)


def installed(
    run: Run, number: int, frames: RoverFrames, scene: Scene, surroundings: Surroundings, options: Given
) -> Installation[Given]:
    """Returns what an optional sensor is made with; its randomness depends on seed and name alone.

    Args:
        run: Whose seed, noise and datum it has.
        number: The rover's place in the run.
        frames: The rover's, the sensor's own among them.
        scene: The rover in its world.
        surroundings: What the sensor's rays can meet.
        options: The sensor's.
    """
    preset = run.rovers[number].noise
    return Installation(
        options,
        mount=frames.mount(options.frame_id, scene.model, scene.prefix),
        rng=generator(run.own_seed(number), OPTIONAL_SENSORS, options.name),
        datum=Datum(*run.world.datum),
        surroundings=surroundings,
        noise=None if preset is None else PRESETS[preset],
    )


def sensor_noise(
    preset: str | None, seed: int, lidar: LidarSpec, shakes: tuple[Shake, ...]
) -> SensorNoise | None:
    """Returns the noise of an episode, from its own generators; None without.

    Args:
        preset: Its name; None for sensors without errors.
        seed: Of the rover.
        lidar: Whose limits ranges have.
        shakes: What the surface that it drives on adds.
    """
    if preset is None and not shakes:
        return None
    _, scan_rng, imu_rng = generators(seed)
    vibration = vibration_of(shakes, seed)
    limits = lidar.range_min, lidar.range_max
    chosen = EXACT if preset is None else PRESETS[preset]
    return SensorNoise(chosen, limits, scan_rng, imu_rng, vibration)


def vibration_of(shakes: tuple[Shake, ...], seed: int) -> "Vibration | None":
    """Returns what shakes an IMU, from its own generator; None where nothing does."""
    if not shakes:
        return None
    from harness.sensors.vibration import Vibration  # noqa: PLC0415 - it loads scipy's filters

    return Vibration(shakes, generator(seed, VIBRATION))


def generators(seed: int) -> list[np.random.Generator]:
    """Returns an episode's generators: of its driver, of its scans' noise, of its IMU's."""
    return [np.random.default_rng(child) for child in seeded(seed, EPISODE).spawn(3)]
