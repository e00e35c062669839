"""All tracks; the command shows them in this order."""

import math

from harness.base.errors import find_named
from harness.course.tracks.barn import Barn
from harness.course.tracks.base import SEEDS, Track
from harness.course.tracks.dynabarn import DynaBarn
from harness.course.tracks.ground import Ground
from harness.course.tracks.mission import Mission

__all__ = ["SEEDS", "TRACKS", "Track", "find_track"]

SAND_LIMIT = math.radians(15.0)  # of a way over sand: a steeper one costs more than its detour
BLIND = (
    ("scan:dropout=0.8", "pose:latency=0.4"),
    ("scan:nan=0.5", "imu:nan"),
    ("pose:freeze@6+6", "scan:rate=2"),
    ("scan:spike=1.5", "pose:dropout=0.9"),
    ("scan:freeze@8+4", "odometry:stuck=0"),
)

TRACKS: dict[str, Track] = {
    track.name: track
    for track in (
        Barn(),
        DynaBarn(),
        Ground(
            name="rocky",
            summary="to a point behind boulders, over rocks",
            world={"terrain": "rocky", "difficulty": 1.0},
            robot="jackal",
        ),
        Ground(
            name="dunes",
            summary="to a point behind dunes of dry sand, in which wheels sink",
            world={"terrain": "dunes", "soil": "dry_sand"},
            slope_limit=SAND_LIMIT,
        ),
        Ground(
            name="marsyard",
            summary="to a point behind craters and hills",
            world={"terrain": "marsyard"},
        ),
        Mission(
            name="mission",
            summary="to a post by its coordinates, through a gate, to another post; stops within 2 m",
            world={"terrain": "posts", "difficulty": 1.0},
            robot="jackal",
            distance=(5.0, 8.0),
        ),
        Ground(
            name="blind",
            summary="to a point behind posts, with a lidar and a localisation that fail",
            world={"terrain": "posts", "difficulty": 1.0},
            faults=BLIND,
        ),
    )
}


def find_track(name: str) -> Track:
    """Returns the track of that name; UsageError, which lists them, without one."""
    return find_named("track", name, TRACKS)
