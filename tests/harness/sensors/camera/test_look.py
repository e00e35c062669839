"""What cameras see: rocks look like rocks, what a file gives a colour is painted."""

from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
import pytest

from harness.physics.scene import build_scene
from harness.physics.stage import Quality
from harness.robots import find_rover
from harness.sensors.camera.look import dress_for_cameras
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

SMALL = Quality(width=8, height=8, samples=0, shadow_map=16, slices=8)
BOX = Obstacle(ObstacleKind.HAZARD, "box", (0.5, 0.5, 0.5), (3.0, 0.0, 0.5))


def test_only_rocks_have_the_grain_of_rocks() -> None:
    painted = replace(BOX, position=(5.0, 0.0, 0.5), color=(0.2, 0.9, 0.4, 1.0))
    ground = Heightfield(np.zeros((41, 41)), 0.5)
    world = World("bare", ground, (BOX, painted), seed=0, difficulty=None)
    dress = partial(dress_for_cameras, quality=SMALL)
    model = build_scene(world, find_rover("leo"), 0.002, dress).model
    materials = [int(model.geom(f"hazard_{index}").matid[0]) for index in (0, 1)]
    grain = [int(model.mat_texid[m, mujoco.mjtTextureRole.mjTEXROLE_RGB]) for m in materials]
    assert [model.tex(texture).name for texture in grain] == ["rock", "paint"]
    assert model.mat_rgba[materials[1]].tolist() == pytest.approx([0.28, 1.0, 0.56, 1.0])
    spread = [model.tex_data[model.tex_adr[t] :][: 6 * model.tex_width[t] ** 2 * 3].std() for t in grain]
    assert spread[0] > 1.5 * spread[1] > 0.0
