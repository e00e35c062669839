"""Optional sensors on a rover that does nothing: a simulation of one pose, and an installation."""

from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
from harness.sensors.mount import Mount

from harness.sensors.noise import NoisePreset
from harness.sensors.optional import Installation, OptionalSensor, SensorOptions

SECOND_NS = 1_000_000_000
MODEL = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><body name="rover"><freejoint/>
<geom size="0.1" mass="1"/></body></worldbody></mujoco>""")


def simulation(
    position: tuple[float, ...] = (0, 0, 0), quaternion: tuple[float, ...] = (1, 0, 0, 0)
) -> Any:  # noqa: ANN401 - stands for a Simulation
    """What sensors read of a rover in that pose (w, x, y, z); its time can be set."""
    data = mujoco.MjData(MODEL)
    data.qpos[:] = (*position, *np.array(quaternion) / np.linalg.norm(quaternion))
    return SimpleNamespace(model=MODEL, data=data, time_ns=0)


def set_time(sensor: OptionalSensor, seconds: float) -> None:
    """Of the simulation that the sensor looks at."""
    stands_in: Any = sensor._simulation
    stands_in.time_ns = round(seconds * SECOND_NS)


def installation(
    options: SensorOptions,
    seed: int = 0,
    noise: NoisePreset | None = None,
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0),
    axes: Any = None,  # noqa: ANN401 - an array
) -> Installation:
    """Mounted on the rover, there."""
    mount = Mount(1, np.array(xyz), np.eye(3) if axes is None else np.array(axes))
    return Installation(options, mount, np.random.default_rng(seed), noise)
