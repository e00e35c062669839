"""The fan of beams against mj_ray, obstacle by obstacle, compiled and as plain Python."""

import itertools
import math
from collections.abc import Callable
from types import ModuleType
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.arrays import obstacle_arrays
from harness.sensors.rays.bundle import BIN, _sorted_into_bins
from harness.sensors.rays.obstacle_kernel import cast_fan
from tests.harness.sensors.mujoco_rays import meets
from tests.harness.sensors.plain_python import as_plain_python

Array = NDArray[np.float64]

BEAMS, RANGE_MAX = 61, 4.0
FIRST, STEP = -math.pi, 2 * math.pi / (BEAMS - 1)
SHAPES = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
)


def scene(*geoms: dict[str, object]) -> tuple[mujoco.MjModel, mujoco.MjData]:
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=SHAPES[0], size=[9, 9, 0.1], pos=[0, 0, -5], group=0)  # not seen
    for geom in geoms:
        spec.worldbody.add_geom(**({"group": 1} | geom))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def fans(
    world: tuple[mujoco.MjModel, mujoco.MjData],
    origin: Array,
    turn: Array,
    kernel: Callable[..., None],
) -> tuple[Array, Array]:
    """Our ranges and MuJoCo's, of a fan in the xy plane of a frame."""
    model, data = world
    angles = FIRST + STEP * np.arange(BEAMS)
    beams = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(BEAMS)]) @ turn.T
    ours = np.full(BEAMS, np.inf)
    fan = np.array([FIRST, STEP, RANGE_MAX])
    pose = np.ascontiguousarray(np.vstack([origin, turn]))
    kernel(*obstacle_arrays(model, 1), data.geom_xpos, data.geom_xmat, pose, beams, fan, ours)
    _, theirs = meets(model, data, origin, beams, (1,))
    theirs[theirs > RANGE_MAX] = np.inf
    return ours, theirs


def test_a_fan_meets_mujoco_and_as_plain_python_the_compiled_one_to_the_bit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From outside and from within, level and tilted, over and beside, behind one another."""
    plain = as_plain_python("harness.sensors.rays.obstacle_kernel", monkeypatch).cast_fan
    rng = np.random.default_rng(0)
    hits = misses = 0
    for tilt in (0.0, 0.1, 1.0) * 8:
        geoms = [
            {
                "type": shape,
                "size": rng.uniform(0.1, 0.9, 3),
                "pos": [*rng.uniform(-3, 3, 2), rng.uniform(-0.8, 0.8)],
                "quat": rng.normal(size=4) if tilt else [1, 0, 0, 0],
            }
            for shape in SHAPES * 2
        ]
        turn, quaternion = np.empty(9), np.array([1.0, *(tilt * rng.normal(size=2)), rng.normal()])
        mujoco.mju_quat2Mat(turn, quaternion / np.linalg.norm(quaternion))
        world, origin = scene(*geoms), rng.uniform(-1, 1, 3)
        ours, theirs = fans(world, origin, turn.reshape(3, 3), plain)
        assert ours.tobytes() == fans(world, origin, turn.reshape(3, 3), cast_fan)[0].tobytes()
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-9)
        hits, misses = hits + np.isfinite(ours).sum(), misses + np.isinf(ours).sum()
    assert min(hits, misses) > 200


def test_what_is_nearer_already_stays_and_without_obstacles_all_does() -> None:
    model, data = scene({"type": SHAPES[0], "size": [0.5] * 3, "pos": [2.0, 0.0, 0.0]})
    ranges, pose = np.array([1.0, 1.6]), np.vstack([np.zeros(3), np.eye(3)])
    beams, fan = np.tile([1.0, 0.0, 0.0], (2, 1)), np.array([0.0, 1e-3, 9.0])

    cast_fan(*obstacle_arrays(model, 2), data.geom_xpos, data.geom_xmat, pose, beams, fan, ranges)
    assert ranges.tolist() == [1.0, 1.6]
    cast_fan(*obstacle_arrays(model, 1), data.geom_xpos, data.geom_xmat, pose, beams, fan, ranges)
    assert ranges == pytest.approx([1.0, 1.5])


def test_beams_along_the_axes_of_shapes_meet_mujoco() -> None:
    """Four beams along two axes: in and beside the sides that they run along, from within and behind."""
    local = np.array([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    fan, outcomes = np.array([-math.pi, math.pi / 2, 9.0]), set()
    for shape in SHAPES:
        model, data = scene({"type": shape, "size": [0.5, 0.4, 0.3], "pos": [0.0, 0.0, 0.0]})
        arrays = obstacle_arrays(model, 1)
        for axis in range(3):
            turn = np.roll(np.eye(3), axis, axis=0)
            beams = np.ascontiguousarray(local @ turn.T)
            for place in itertools.product((-0.62, -0.13, 0.0, 0.27, 0.55, 2.0), repeat=3):
                origin, ours = np.array(place), np.full(4, np.inf)
                pose = np.ascontiguousarray(np.vstack([origin, turn]))
                cast_fan(*arrays, data.geom_xpos, data.geom_xmat, pose, beams, fan, ours)
                _, expected = meets(model, data, origin, beams, (1,))
                np.testing.assert_allclose(ours, expected, rtol=0.0, atol=1e-9)
                outcomes |= {(shape, bool(np.isfinite(one))) for one in ours}
    assert len(outcomes) == 2 * len(SHAPES)


def spheres(rng: np.random.Generator) -> tuple[Array, Array]:
    """Middles and radii of bounding spheres: near the plane, off it, around the origin, far away."""
    middles = rng.uniform(-1.0, 1.0, (40, 3)) * (5.0, 5.0, 1.0)
    middles[:4] *= 0.1
    middles[4:8] = [[0.02, 0.01, 2.0], [0.0, 0.0, -1.5], [-3.0, 0.01, 0.0], [-3.0, -0.01, 0.2]]
    return middles, rng.uniform(0.2, 1.2, 40)


def asked_of(plain: ModuleType, monkeypatch: pytest.MonkeyPatch) -> list[list[float]]:
    """Notes each beam that asks a shape; all miss, so that none stands in another's way."""
    asked: list[list[float]] = []

    def noted(_kind: int, _size: object, _start: object, speed: tuple[float, float, float]) -> float:
        asked.append([*speed])
        return math.inf

    monkeypatch.setattr(plain, "_hit_shape", noted)
    return asked


def arrays_of(middle: Array, radius: float) -> tuple[Any, ...]:
    """One ellipsoid in that bounding sphere, as kernels take it."""
    sizes = np.array([[0.1, 0.1, 0.1, radius]])
    return np.array([[0, SHAPES[2]]]), sizes, middle[None], np.eye(3).reshape(1, 9)


def test_a_fan_asks_with_the_beams_that_meet_the_bounding_sphere_and_one_more_on_either_side(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plain = as_plain_python("harness.sensors.rays.obstacle_kernel", monkeypatch)
    asked = asked_of(plain, monkeypatch)
    angles = FIRST + STEP * np.arange(BEAMS)
    beams = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(BEAMS)])
    fan, pose = np.array([FIRST, STEP, RANGE_MAX]), np.vstack([np.zeros(3), np.eye(3)])
    outcomes = set()
    for middle, radius in zip(*spheres(np.random.default_rng(2)), strict=True):
        asked.clear()
        plain.cast_fan(*arrays_of(middle, radius), pose, beams, fan, np.full(BEAMS, np.inf))
        disc, distance = max(radius**2 - middle[2] ** 2, 0.0) ** 0.5, np.hypot(*middle[:2])
        width = math.pi if distance <= disc else math.asin(disc / distance)
        aside = np.abs(np.remainder(angles - np.arctan2(*middle[1::-1]) + np.pi, 2 * np.pi) - np.pi)
        in_sight = abs(middle[2]) <= radius and distance - disc <= RANGE_MAX
        meet, near = aside <= width, aside <= width + 1.001 * STEP
        told = {tuple(beam) for beam in asked}
        assert told >= {tuple(beam) for beam in beams[meet & in_sight].tolist()}
        assert told <= {tuple(beam) for beam in beams[near & in_sight].tolist()}
        outcomes.add((bool(in_sight), bool(in_sight and meet.all())))
    assert outcomes == {(False, False), (True, False), (True, True)}


class Noted(list[int]):
    """Numbers that note which of them were asked for."""

    def __init__(self, values: NDArray[np.int64]) -> None:
        super().__init__(values.tolist())
        self.taken: list[int] = []

    def __getitem__(self, place: Any) -> Any:  # noqa: ANN401 - list's
        self.taken.append(value := super().__getitem__(place))
        return value


def test_a_bundle_asks_with_the_beams_that_meet_the_bounding_sphere_and_looks_at_few_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It looks at bins that the sphere's azimuths and elevations touch, at each once."""
    plain, rng = (
        as_plain_python("harness.sensors.rays.obstacle_kernel", monkeypatch),
        np.random.default_rng(3),
    )
    asked = asked_of(plain, monkeypatch)
    beams = rng.normal(size=(300, 3)) * (1.0, 1.0, 0.7)
    beams /= np.linalg.norm(beams, axis=1, keepdims=True)
    order, starts, grid = _sorted_into_bins(beams)
    azimuths, elevations = np.arctan2(beams[:, 1], beams[:, 0]), np.arcsin(beams[:, 2])
    pose = np.vstack([np.zeros(3), np.eye(3)])
    for middle, radius in zip(*spheres(rng), strict=True):
        asked.clear()
        noted, distance = Noted(order), float(np.linalg.norm(middle))
        plain.cast_bundle(
            *arrays_of(middle, radius), pose, beams, noted, starts, grid, RANGE_MAX, np.full(300, np.inf)
        )
        assert len(noted.taken) == len(set(noted.taken))
        if distance - radius > RANGE_MAX:
            assert not noted.taken
            continue
        along, beside = beams @ middle, distance**2 - radius**2
        meet = (along > 0.0) & (along**2 >= beside) if beside > 0.0 else np.full(300, True)
        assert sorted(asked) == sorted(beams[meet].tolist())
        if beside > 0.0:
            elevation, reach = math.asin(middle[2] / distance), math.asin(radius / distance)
            over = abs(elevation) + reach >= math.pi / 2
            width = math.pi if over else math.asin(math.sin(reach) / math.cos(elevation))
            aside = np.abs(
                np.remainder(azimuths - np.arctan2(*middle[1::-1]) + np.pi, 2 * np.pi) - np.pi
            )
            within = (np.abs(elevations - elevation) <= reach + BIN) & (aside <= width + BIN)
            assert set(noted.taken) <= set(np.flatnonzero(within).tolist())
