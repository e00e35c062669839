"""A rover of a test's own model: its spec is Leo's, but for the frames and the file."""

from pathlib import Path

from harness.robots import RoverSpec
from tests.support.rovers import LEO


def made_rover(folder: Path, body: str, assets: str = "") -> RoverSpec:
    """Returns a rover of that MJCF.

    Args:
        folder: Where its file is put.
        body: What its root body holds.
        assets: Meshes and materials.
    """
    file = folder / "made.xml"
    file.write_text(
        f'<mujoco><compiler meshdir="meshes"/><asset>{assets}</asset><worldbody><body name="rover">'
        f'<freejoint name="root"/><inertial pos="0 0 0.1" mass="1" diaginertia="1 1 1"/>'
        f'<site name="imu"/><site name="lidar"/>{body}</body></worldbody></mujoco>'
    )
    return LEO.but(frames=(), name="made", folder=folder)
