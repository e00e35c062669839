"""What a page shows has the shape that MuJoCo simulates, wherever a rover stands."""

import io

import mujoco
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from harness.episode.assembly import scenery
from harness.physics.scene import build_scenes
from harness.physics.stage import Quality, dress
from harness.spec.run import Run
from harness.view.camera import SOLID_GROUPS
from harness.view.live.shapes import WORLD, gltf_of_bodies

Triangles = NDArray[np.float64]
QUALITY = Quality(width=64, height=64, samples=0, shadow_map=64, slices=8)
RUNS = {
    "rocks": Run.of(terrain="rocky", robot="leo"),
    "walls": Run.of(terrain="maze", robot="rover_zero4wd"),
    "people": Run.of(terrain="flat", robot="husky", actors=["anna=2,2/4,2"]),
    "meshes": Run.of(terrain="gravel", robot="jackal"),
}


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
def test_the_world_is_shown_where_rays_meet_it_and_a_rovers_parts_around_their_geoms(run: Run) -> None:
    model, data, shown = seen(run)
    meets_rays(run, model, data, shown[WORLD])
    ground = max(shown[WORLD].geometry.values(), key=lambda part: len(part.faces))
    bare = trimesh.Trimesh(ground.vertices, ground.faces, process=False)  # which has its own normals
    assert (bare.vertex_normals * ground.vertex_normals).sum(axis=1).min() > 0.95
    moving = [body for body in shown if body != WORLD]
    assert len(moving) >= 5  # a body and four wheels at least
    for body in moving:
        points = shown[body].to_mesh().vertices @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
        own = [g for g in range(model.ngeom) if model.geom_bodyid[g] == body and model.geom_group[g] < 3]
        for geom in own:  # its middle lies within what is shown
            middle = data.geom_xpos[geom]
            assert np.all(points.min(axis=0) - 0.01 <= middle)
            assert np.all(middle <= points.max(axis=0) + 0.01)


def meets_rays(run: Run, model: mujoco.MjModel, data: mujoco.MjData, shown: trimesh.Scene) -> None:
    """Looks down from above at 40 places."""
    triangles = shown.to_mesh().triangles
    rng, high, hit = np.random.default_rng(0), 50.0, np.zeros(1, np.int32)
    places = rng.uniform(-6.0, 6.0, (40, 2))
    origins = np.column_stack([places, np.full(40, high)])
    down = np.tile([0.0, 0.0, -1.0], (40, 1))
    near = reaching(reaching(triangles, 0, -6.0, 6.0), 1, -6.0, 6.0)
    top = [topmost(near, *place) for place in places]
    met = [
        mujoco.mj_ray(model, data, origin, down[0], SOLID_GROUPS, 1, -1, hit, None) for origin in origins
    ]
    expected = high - np.array(met)
    people = expected > np.array(top) + 0.5 if run.world.actors else np.zeros(40, bool)
    assert np.array(top)[~people] == pytest.approx(expected[~people], abs=0.02)


def reaching(triangles: Triangles, axis: int, low: float, high: float) -> Triangles:
    """Those that reach into an interval of an axis."""
    a, b, c = triangles[:, :, axis].T
    lowest, highest = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    return np.asarray(triangles[(lowest <= high) & (low <= highest)])


def topmost(triangles: Triangles, x: float, y: float) -> float:
    """The height of the topmost of all triangles above a place, by their barycentric coordinates."""
    a, b, c = np.swapaxes(reaching(reaching(triangles, 0, x, x), 1, y, y), 0, 1)
    (ux, uy), (vx, vy), (px, py) = (to[..., :2].T - a[:, :2].T for to in (b, c, np.array([[x, y]])))
    area = ux * vy - uy * vx
    with np.errstate(divide="ignore", invalid="ignore"):  # upright ones have none
        along, aside = (px * vy - py * vx) / area, (ux * py - uy * px) / area
    inside = (along >= 0.0) & (aside >= 0.0) & (along + aside <= 1.0)
    heights = a[:, 2] + along * (b[:, 2] - a[:, 2]) + aside * (c[:, 2] - a[:, 2])
    return float(heights[inside].max())


def seen(run: Run) -> tuple[mujoco.MjModel, mujoco.MjData, dict[int, trimesh.Scene]]:
    """The dressed model of a run, its state, and the glTF of its bodies as another program reads it."""
    model = build_scenes(*scenery(run), run.timestep, lambda spec: dress(spec, QUALITY))[0].model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    files = gltf_of_bodies(model, data)
    return model, data, {b: trimesh.load_scene(io.BytesIO(f), "glb") for b, f in files.items()}
