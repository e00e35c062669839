"""The tracks over named terrains."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.course.planner import Planner
from harness.course.task import Point
from harness.course.tracks.ground import START, Ground
from harness.spec.world import DEFAULT_DATUM
from harness.world.geodesy import Datum

SAND_LIMIT = math.radians(15.0)  # of a way over sand: a steeper one costs more than its detour
# [m]: a post from its coordinates, and how near to these the rover has to stop: within URC's 2 m.
ASIDE, NEAR = 1.2, 0.7
GATE_ROOM = 1.2  # [m] of free ground around the middle of a gate
GNSS = "gnss=rtk"


@dataclass(frozen=True, kw_only=True)
class Mission(Ground):
    """From post to post: the first and the last one are stopped at, a gate between them is passed.

    After the University Rover Challenge 2023, 1.e.v: a stop within 2 m of each post.
    """

    def _mission(
        self, planner: Planner, room: float, rng: np.random.Generator
    ) -> tuple[Sequence[Point], Mapping[str, object]]:
        """The way, and posts with a route whose places are degrees, but for the gate's."""
        way = [START]
        for apart in (ASIDE, GATE_ROOM, ASIDE):
            way.append(self.place(planner, way, apart + room, rng))
        _, first, gate, last = way
        yaw = math.atan2(gate[1] - first[1], gate[0] - first[0])
        targets = [
            _post("first", 0, first, rng),
            f"gate=gate:id=1,x={gate[0]},y={gate[1]},yaw={yaw:.3f}",
            _post("last", 3, last, rng),
        ]
        route = [_coordinates(first), {"target": "gate"}, _coordinates(last)]
        plan = {"targets": targets, "route": route, "sensors": [GNSS]}
        return way, plan


def _post(name: str, number: int, place: Point, rng: np.random.Generator) -> str:
    """A post beside a place, in a direction that is drawn."""
    turn = rng.uniform(-math.pi, math.pi)
    x, y = place[0] + ASIDE * math.cos(turn), place[1] + ASIDE * math.sin(turn)
    return f"{name}=aruco:id={number},x={x:.3f},y={y:.3f}"


def _coordinates(place: Point) -> Mapping[str, object]:
    """The way point at a place, in degrees of a millimetre or so."""
    latitude, longitude, _ = Datum(*DEFAULT_DATUM).geodetic((*place, 0.0))
    return {"lat": round(latitude, 8), "lon": round(longitude, 8), "radius": NEAR, "stop": True}


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
    name="marsyard", summary="to a point behind craters and hills", world={"terrain": "marsyard"}
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
