"""The tracks on named terrains: to points that are drawn out of sight of the start, if it can be."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.base.errors import UsageError
from harness.base.streams import COURSE, generator
from harness.course.planner import RESOLUTION, Planner
from harness.course.task import Case, Point, Rule, Task
from harness.course.tracks.base import Track, to
from harness.episode.assembly import world_of
from harness.robots import find_rover
from harness.spec.world import DEFAULT_DATUM
from harness.world.geodesy import Datum

MARGIN = 0.3  # [m] of free ground around a rover that stands at a goal
START: Point = (0.0, 0.0)
TRIES = 40  # places that are looked at for one behind something
SAND_LIMIT = math.radians(15.0)  # of a way over sand: a steeper one costs more than its detour
# [m]: a post from its coordinates, and how near to these the rover has to stop: within URC's 2 m.
ASIDE, NEAR = 1.2, 0.7
GATE_ROOM = 1.2  # [m] of free ground around the middle of a gate
GNSS = "gnss=rtk"


@dataclass(frozen=True, kw_only=True)
class Ground(Track):
    """A named terrain with a goal of its own for each seed.

    Attributes:
        world: Fields of the run that say where, beside the seed.
        faults: What fails; the seeds take them in turn.
        distance: From the start, and from one way point to the next, at least and at most [m].
        slope_limit: Steepest slope of the shortest way [rad]; None for the rover's own.
    """

    name: str
    summary: str
    world: Mapping[str, object]
    faults: Sequence[tuple[str, ...]] = ((),)
    distance: tuple[float, float] = (9.0, 12.0)
    slope_limit: float | None = None
    rule: Rule = field(default_factory=Rule)
    robot: str = "leo"

    def task(self, case: Case, folder: Path) -> Task:  # noqa: ARG002 - it reads no file
        """Returns the task of a seed: its world, and goals that can be reached."""
        faults = self.faults[case.seed % len(self.faults)]
        run = self.run(**self.world, seed=case.seed, faults=faults)
        rover, rng = find_rover(self.robot), generator(case.seed, COURSE, self.name)
        planner = Planner(world_of(run), rover, self.slope_limit)
        way, plan = self._mission(planner, rover.reach + MARGIN, rng)
        yaw = math.atan2(way[1][1], way[1][0])
        run = run.alone(start=(*START, round(yaw, 3)), **plan)
        length = planner.length(way)
        return Task(run=run, shortest=length, speed=rover.top_speed, rule=self.rule)

    def _mission(
        self, planner: Planner, room: float, rng: np.random.Generator
    ) -> tuple[Sequence[Point], Mapping[str, object]]:
        """The way from the start through all goals, and the fields of the run that ask for it."""
        goal = self.place(planner, [START], room, rng)
        return (START, goal), {"route": to(goal)}

    def place(
        self, planner: Planner, way: Sequence[Point], room: float, rng: np.random.Generator
    ) -> Point:
        """Returns a place that can be reached, out of sight of the one before if possible.

        Args:
            planner: Of the world.
            way: The places before it; it is as far from the last one as `distance` says, and not
                nearer to any other [m].
            room: Free ground around it [m].
            rng: Draws it.

        Raises:
            UsageError: There is none.
        """
        low, high = self.distance
        lengths, apart = planner.lengths(way[-1]), planner.distances(way[-1])
        ring = (apart > low - RESOLUTION) & (apart < high + RESOLUTION)
        rows, columns = np.nonzero(np.isfinite(lengths) & (planner.clearance > room) & ring)
        cells = zip(rows.tolist(), columns.tolist(), strict=True)
        places = [planner.middle(row, column) for row, column in cells]
        far = [place for place in places if all(math.dist(place, other) >= low for other in way)]
        fit = [place for place in far if math.dist(place, way[-1]) <= high]
        if not fit:
            raise UsageError(f"track {self.name}: there is no place for a goal; take another seed")
        drawn = [fit[int(rng.integers(len(fit)))] for _ in range(TRIES)]
        return next((place for place in drawn if not planner.is_open(way[-1], place)), drawn[0])


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
