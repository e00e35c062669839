"""The tracks over named terrains."""

import math

from harness.course.tracks.ground import Ground
from harness.course.tracks.mission import Mission

SAND_LIMIT = math.radians(15.0)  # of a way over sand: a steeper one costs more than its detour

ROCKY = Ground(
    name="rocky",
    summary="to a point behind boulders, over rocks",
    world={"terrain": "rocky", "difficulty": 1.0},
    robot="jackal",
)
DUNES = Ground(
    name="dunes",
    summary="to a point behind dunes of dry sand, in which wheels sink",
    world={"terrain": "dunes", "soil": "dry_sand"},
    slope_limit=SAND_LIMIT,
)
MARSYARD = Ground(
    name="marsyard",
    summary="to a point behind craters and hills",
    world={"terrain": "marsyard"},
)
MISSION = Mission(
    name="mission",
    summary="to a post by its coordinates, through a gate, to another post; stops within 2 m",
    world={"terrain": "posts", "difficulty": 1.0},
    robot="jackal",
    distance=(5.0, 8.0),
)
BLIND = Ground(
    name="blind",
    summary="to a point behind posts, with a lidar and a localisation that fail",
    world={"terrain": "posts", "difficulty": 1.0},
    faults=(
        ("scan:dropout=0.8", "pose:latency=0.4"),
        ("scan:nan=0.5", "imu:nan"),
        ("pose:freeze@6+6", "scan:rate=2"),
        ("scan:spike=1.5", "pose:dropout=0.9"),
        ("scan:freeze@8+4", "odometry:stuck=0"),
    ),
)
