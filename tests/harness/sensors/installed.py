"""Optional sensors on a rover that does nothing: a simulation of one pose, and an installation."""

from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np

from harness.robots.frames.rover_frames import BodyFrame
from harness.sensors.noise import NoisePreset
from harness.sensors.optional import Installation, SensorOptions
from harness.sensors.rays.bundle import Surroundings
from harness.spec.world import DEFAULT_DATUM
from harness.world.geodesy import Datum

MODEL = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><body name="rover"><freejoint/>
<geom size="0.1" mass="1"/></body></worldbody></mujoco>""")


def simulation(
    position: tuple[float, ...] = (0, 0, 0), quaternion: tuple[float, ...] = (1, 0, 0, 0)
) -> Any:  # noqa: ANN401 - stands for a Simulation
    """What sensors read of a rover in that pose (w, x, y, z); its time can be set."""
    data = mujoco.MjData(MODEL)
    data.qpos[:] = (*position, *np.array(quaternion) / np.linalg.norm(quaternion))
    return SimpleNamespace(model=MODEL, data=data, time_ns=0, physics=SimpleNamespace(bed=None))


def installation(
    options: SensorOptions,
    seed: int = 0,
    noise: NoisePreset | None = None,
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0),
    axes: Any = None,  # noqa: ANN401 - an array
    *,
    body: int = 1,
    datum: Datum | None = None,
    surroundings: Surroundings | None = None,
) -> Installation[Any]:
    """Mounted on that body, there."""
    mount = BodyFrame(body, np.array(xyz), np.eye(3) if axes is None else np.array(axes))
    met: Any = surroundings  # few sensors cast rays
    rng = np.random.default_rng(seed)
    return Installation(options, mount, rng, datum or Datum(*DEFAULT_DATUM), met, noise)
