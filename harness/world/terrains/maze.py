"""A maze: outer walls 2 m high around 20 x 20 m, inner walls 1 m high, like RoboTerrain's maze.sdf.

The inner walls stand on the grid lines of square chambers. A random spanning tree of doors joins all
chambers; of the edges that it leaves closed, a share becomes walls. Runs of them merge into one box.
"""

from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Form, Obstacle, ObstacleKind, place
from harness.world.statistics import Promise
from harness.world.terrain import SPAWN_CLEARANCE, constant, parameter
from harness.world.terrains.ground import Flat

ARENA = 20.0  # [m] between the outer walls
CHAMBERS = 9  # along a side; odd, so that the rover starts in the middle of one
PITCH = ARENA / CHAMBERS  # [m] from grid line to grid line
THICKNESS = 0.2  # [m]
OUTER_HEIGHT, INNER_HEIGHT = 2.0, 1.0  # [m]
LONGEST_RUN = 3  # pitches in one box

Box = tuple[float, float, float, float, float]  # x, y, half length x, half length y, height [m]
Walls = NDArray[np.bool_]  # (line, chamber along the line): a wall stands on this edge


@dataclass(frozen=True, kw_only=True)
class Maze(Flat):
    """Level ground with walls; every chamber can be reached through passages of 2 m."""

    name = "maze"
    summary = "20 x 20 m arena with walls of 1 m and passages of 2 m, level"
    has_hazards = True
    promise = Promise(obstacle_density=(0.04, 0.065))

    size: float = constant(24.0, "m")
    # share of the possible walls that stand; at 1 there is only one way to each chamber
    walls: float = parameter(0.25, 0.6, 1.0, "")

    def obstacles(self, ground: Heightfield, rng: np.random.Generator, /) -> tuple[Obstacle, ...]:
        """Returns outer and inner walls, all of them hazards."""
        tree_rng, wall_rng = rng.spawn(2)
        doors = _doors(tree_rng)
        inner = [
            box
            for along_y in (False, True)
            for box in _boxes(
                ~doors[int(along_y)] & (wall_rng.random(doors[0].shape) < self.walls), along_y
            )
        ]
        walls = (
            (x, y, Form(ObstacleKind.HAZARD, "box", (half_x, half_y, 0.5 * height)))
            for x, y, half_x, half_y, height in (*_outer_boxes(), *inner)
        )
        return tuple(place(form, ground, x, y) for x, y, form in walls)


def _outer_boxes() -> list[Box]:
    centre, half, thin = 0.5 * (ARENA + THICKNESS), 0.5 * ARENA + THICKNESS, 0.5 * THICKNESS
    along_x: list[Box] = [(0.0, side * centre, half, thin, OUTER_HEIGHT) for side in (-1, 1)]
    return [*along_x, *(_mirrored(box) for box in along_x)]


def _doors(rng: np.random.Generator) -> tuple[Walls, Walls]:
    """Edges that stay open, for the grid lines along x and along y: a random spanning tree."""
    open_along_x, open_along_y = (np.zeros((CHAMBERS - 1, CHAMBERS), dtype=bool) for _ in range(2))
    path, seen = [(0, 0)], {(0, 0)}
    while path:
        col, row = path[-1]
        around = ((col + 1, row), (col - 1, row), (col, row + 1), (col, row - 1))
        unseen = [c for c in around if c not in seen and min(c) >= 0 and max(c) < CHAMBERS]
        if not unseen:
            path.pop()
            continue
        to_col, to_row = unseen[rng.integers(len(unseen))]
        if to_col == col:
            open_along_x[min(row, to_row), col] = True
        else:
            open_along_y[min(col, to_col), row] = True
        seen.add((to_col, to_row))
        path.append((to_col, to_row))
    return open_along_x, open_along_y


def _boxes(walls: Walls, along_y: bool) -> list[Box]:
    """Boxes over the runs of walls of every grid line, without those around the spawn."""
    boxes: list[Box] = []
    for line, row in enumerate(walls):
        across = (line + 1) * PITCH - 0.5 * ARENA
        standing = [i for i, wall in enumerate(row) if wall and not _at_spawn(i, across)]
        for start, stop in _runs(standing):
            middle = 0.5 * (start + stop) * PITCH - 0.5 * ARENA
            half_length = 0.5 * ((stop - start) * PITCH + THICKNESS)
            box = (middle, across, half_length, 0.5 * THICKNESS, INNER_HEIGHT)
            boxes.append(_mirrored(box) if along_y else box)
    return boxes


def _runs(indices: list[int]) -> list[tuple[int, int]]:
    """Start and stop of each run of neighbours, cut to LONGEST_RUN."""
    runs: list[tuple[int, int]] = []
    for _, group in groupby(enumerate(indices), key=lambda item: item[1] - item[0]):
        run = [index for _, index in group]
        stop = run[-1] + 1
        runs += [(start, min(start + LONGEST_RUN, stop)) for start in range(run[0], stop, LONGEST_RUN)]
    return runs


def _at_spawn(index: int, across: float) -> bool:
    """Whether the wall on that edge of a grid line would come too close to the origin."""
    start, stop = index * PITCH - 0.5 * ARENA, (index + 1) * PITCH - 0.5 * ARENA
    along = max(start, -stop, 0.0)
    return float(np.hypot(along, across)) < SPAWN_CLEARANCE + THICKNESS


def _mirrored(box: Box) -> Box:
    x, y, half_x, half_y, height = box
    return (y, x, half_y, half_x, height)
