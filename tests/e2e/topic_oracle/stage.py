"""The stage of the oracle for topics: a small world that has everything, rovers with a tilted IMU."""

import json
import math
from pathlib import Path
from shutil import copytree

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec, find_rover
from harness.robots.content import MODELS_DIR
from harness.samples import Twist
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World, with_actors
from tests.e2e.topic_oracle.surroundings import carried
from tests.support.words import parse_actors

Grid = NDArray[np.float64]

CELL, VERTICES = 0.06, 101  # [m] and along each side
IMU_MOUNTING = "0.8 0.3 -0.4 0.33"  # w x y z: about an axis that is none of the rover's
BATCHES = 88  # of 50 ms
PERSON = "guide=-2,1.5/-2,-1.5"  # walks 3 m beside the rover, and back no sooner than the drive ends

# From which batch on a command holds, and where the rover is put back. Nothing is commanded at first
# and after the reset: the rover stands, its previous command forgotten.
RESET = 56
SCRIPT = {
    2: Twist(0.75, 0.0),
    36: Twist(-0.6, -1.2),
    46: Twist(0.0, 9.0),
    58: Twist(-0.2, -9.0),
}


def staged_rover(robot: str, folder: Path) -> RoverSpec:
    """A folder rover: a shipped one with its IMU mounted obliquely and with all optional sensors."""
    made = Path(copytree(MODELS_DIR / robot, folder / robot))
    model, facts, site = made / f"{robot}.xml", made / "rover.yaml", '<site name="imu"'
    text = model.read_text()
    assert text.count(site) == 1
    model.write_text(text.replace(site, f'{site} quat="{IMU_MOUNTING}"'))
    facts.write_text(f"{facts.read_text()}\nsensors: {json.dumps(carried(robot))}\n")
    return find_rover(str(made))


def beyond(values: Grid, limit: float) -> Grid:
    """How far outside of -limit..limit, with its sign."""
    return values - np.clip(values, -limit, limit)


def stage(rover: RoverSpec) -> World:
    """A hillside around a level start; ahead a rock before the left wheels, a hump, and a wall."""
    half_size = CELL * (VERTICES - 1) / 2
    x, y = np.meshgrid(*2 * [np.linspace(-half_size, half_size, VERTICES)])
    east, north = beyond(x, 0.28), beyond(y, 0.28)
    heights = 0.15 * east + 0.08 * north + 0.01 * np.sin(6.0 * east) * np.cos(5.0 * y)
    heights += (rover.clearance + 0.02) * np.exp(-(((x - 0.5) / 0.08) ** 2) - (y / 0.06) ** 2)
    ground = Heightfield(heights, CELL)
    rock = Obstacle(
        kind=ObstacleKind.ROCK,
        shape="ellipsoid",
        half_size=(0.10, 0.08, 0.05),
        position=(0.42, 0.17, ground.height_at(0.42, 0.17)),
    )
    wall = Obstacle(
        kind=ObstacleKind.HAZARD,
        shape="box",
        half_size=(0.1, 0.5, 1.2),
        position=(0.95, -0.1, 0.3),
        quaternion=(math.cos(0.05), 0.0, 0.0, math.sin(0.05)),
    )
    return World("stage", ground, (rock, wall), seed=0, difficulty=0.0)


def peopled(world: World) -> World:
    """The world with the one who walks there."""
    return with_actors(world, parse_actors([PERSON]))
