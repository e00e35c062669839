"""One 360-beam scan against mj_multiRay over the whole scene and PyBullet's rayTestBatch."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.measuring import Effort, Rounds, Table, timed
from benchmarks.scenes import poses, scene_on_hills
from harness.physics.scene import Scene
from harness.robots.lidar import LidarSpec
from harness.sensors.lidar import Lidar
from harness.sensors.rays.arrays import heightfield_arrays
from harness.sensors.rays.heightfield_kernel import cast_rays

Array = NDArray[np.float64]
SPEC = LidarSpec(beams=360)
OBSTACLES = 100
SCENES = (  # name, size, cell and height of the hills [m], targets against MuJoCo and PyBullet
    ("20 m, 10 cm", 20.0, 0.1, 1.2, ">= 25", ">= 10"),
    ("20 m, 10 cm, nearly flat", 20.0, 0.1, 0.02, "-", "-"),
    ("60 m, 5 cm", 60.0, 0.05, 1.2, ">= 300", ">= 10"),
)
EVERYTHING_BUT_THE_ROVER = np.array([1, 1, 0, 0, 0, 0], np.uint8)
NOBODY = -1


@dataclass(frozen=True, eq=False)
class Fan:
    """Where one scan starts and goes."""

    origin: Array
    directions: Array


def measure(effort: Effort) -> Table:
    """Cost and parity on a small coarse and on a large fine map."""
    rows: list[tuple[str, ...]] = []
    for name, size, cell, height, mujoco_target, bullet_target in SCENES[: effort.maps]:
        scene = scene_on_hills(size, cell, OBSTACLES, height)
        states = poses(scene, effort.poses)
        rows += [
            (name, "mj_multiRay, whole scene", *_against_mujoco(scene, states, effort), mujoco_target),
            (name, "PyBullet, terrain only", *_against_pybullet(scene, states, effort), bullet_target),
        ]
    return Table(
        title=f"Scan of {SPEC.beams} beams, {OBSTACLES} obstacles",
        columns=(
            "map, cell",
            "against",
            "its time",
            "ours",
            "ratio",
            "beams that hit",
            "hits that differ",
            "largest difference",
            "target ratio",
        ),
        rows=tuple(rows),
    )


def _against_mujoco(scene: Scene, states: list[mujoco.MjData], effort: Effort) -> tuple[str, ...]:
    lidar = Lidar(scene.model, SPEC)
    fans = [_fan(scene, data) for data in states]

    def ours() -> list[Array]:
        return [lidar.scan(data).astype(np.float64) for data in states]

    def theirs() -> list[Array]:
        return [_multi_ray(scene.model, d, fan) for d, fan in zip(states, fans, strict=True)]

    return _compared(ours, theirs, effort)


def _against_pybullet(scene: Scene, states: list[mujoco.MjData], effort: Effort) -> tuple[str, ...]:
    try:
        bullet: Any = import_module("pybullet")
    except ImportError as error:
        return (f"skipped: {error}", *("-",) * 5)
    terrain = heightfield_arrays(scene.model)
    fans, clear = [_fan(scene, data) for data in states], np.zeros(SPEC.beams)

    def ours() -> list[Array]:
        found = [np.full(SPEC.beams, np.inf) for _ in fans]
        for fan, ranges in zip(fans, found, strict=True):
            cast_rays(*terrain, fan.origin, fan.directions, clear, SPEC.range_max, ranges)
        return found

    client = bullet.connect(bullet.DIRECT)
    try:
        _add_terrain(bullet, scene)
        rays = [_mirrored_ends(fan) for fan in fans]

        def theirs() -> list[Array]:
            return [_ray_test(bullet, start, end) for start, end in rays]

        return _compared(ours, theirs, effort)
    finally:
        bullet.disconnect(client)


def _compared(
    ours: Callable[[], list[Array]], theirs: Callable[[], list[Array]], effort: Effort
) -> tuple[str, ...]:
    """Times per scan, their ratio, share of hits and parity."""
    a, b = np.concatenate(ours()), np.concatenate(theirs())
    both = np.isfinite(a) & np.isfinite(b)
    differing = int((np.isfinite(a) != np.isfinite(b)).sum())
    rounds = Rounds({"ours": timed(ours), "theirs": timed(theirs)}, effort.rounds)
    return (
        f"{1e3 * rounds.median('theirs') / effort.poses:.2f} ms",
        f"{1e3 * rounds.median('ours') / effort.poses:.3f} ms",
        f"**{rounds.ratio('theirs', 'ours'):.0f}**",
        f"{100 * np.isfinite(b).mean():.0f} %",
        f"{differing} of {a.size:,}",
        f"{np.abs(a[both] - b[both]).max(initial=0.0):.1e} m",
    )


def _fan(scene: Scene, data: mujoco.MjData) -> Fan:
    site, angles = scene.model.site("lidar").id, SPEC.angles
    beams = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    origin = data.site_xpos[site].copy()
    return Fan(origin, np.ascontiguousarray(beams @ data.site_xmat[site].reshape(3, 3).T))


def _multi_ray(model: mujoco.MjModel, data: mujoco.MjData, fan: Fan) -> Array:
    ids, ranges = np.empty(SPEC.beams, np.int32), np.empty(SPEC.beams)
    mujoco.mj_multiRay(
        model,
        data,
        fan.origin,
        fan.directions.ravel(),
        EVERYTHING_BUT_THE_ROVER,
        1,
        NOBODY,
        ids,
        ranges,
        None,
        SPEC.beams,
        SPEC.range_max,
    )
    ranges[(ids < 0) | (ranges > SPEC.range_max)] = np.inf
    ranges[ranges < SPEC.range_min] = -np.inf
    return ranges


def _add_terrain(bullet: Any, scene: Scene) -> None:  # noqa: ANN401 - a module without types
    """The same heightfield, mirrored in x: Bullet splits its cells along the other diagonal."""
    ground = scene.world.ground
    heights = ground.heights[:, ::-1]
    shape = bullet.createCollisionShape(
        bullet.GEOM_HEIGHTFIELD,
        meshScale=[ground.cell, ground.cell, 1.0],
        heightfieldData=heights.ravel().tolist(),
        numHeightfieldRows=heights.shape[1],
        numHeightfieldColumns=heights.shape[0],
    )
    middle = 0.5 * (heights.min() + heights.max())  # Bullet puts that at the body's origin
    bullet.createMultiBody(0, shape, basePosition=[0.0, 0.0, middle])


def _mirrored_ends(fan: Fan) -> tuple[list[list[float]], list[list[float]]]:
    mirror = np.array([-1.0, 1.0, 1.0])
    start, end = fan.origin * mirror, (fan.origin + SPEC.range_max * fan.directions) * mirror
    return np.tile(start, (SPEC.beams, 1)).tolist(), end.tolist()


def _ray_test(bullet: Any, start: list[list[float]], end: list[list[float]]) -> Array:  # noqa: ANN401
    found = bullet.rayTestBatch(start, end)
    body, _, fraction, _, _ = zip(*found, strict=True)
    ranges: Array = np.where(np.array(body) < 0, np.inf, SPEC.range_max * np.array(fraction))
    return ranges
