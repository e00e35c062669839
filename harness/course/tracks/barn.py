"""Track barn: the static worlds of the BARN challenge, its start, goal, limits and score.

Daffan/the-barn-challenge at bf5a226, MIT licence (worlds/LICENSE): a plane with cylinders of radius
0.075 m on a grid of 0.15 m. worlds/barn.csv holds the 50 worlds 0, 6, ... 294 of its test, and the
length of each world's path. Other worlds come from files or tables, unseen ones from the
generator that made BARN's.
"""

from collections.abc import Iterable, Sequence
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.base.streams import generator
from harness.course.planner import Planner
from harness.course.task import Case, Rule, Task, WorldFile
from harness.course.tracks.barn_files import GOAL, RADIUS, read_worlds
from harness.course.tracks.barn_files import START as PLACE
from harness.course.tracks.base import Track, to
from harness.course.tracks.sdf import Circle, world_text
from harness.episode.assembly import world_of
from harness.robots import find_rover

START, NEAR = (*PLACE, 1.57), 1.0  # [m] from the goal that counts as reached
CELL = 0.15  # [m] of the grid
SIDE, FIRST_ROW = 30, 34  # cells of the field's side; the field's first row
CORNER = (-4.425, 0.075)  # [m] of the grid's first cell
REFERENCE_SPEED = 2.0  # [m/s] of the optimal time
# Of the generator's twelve sets: share of filled cells, rounds of smoothing.
FILLS, ROUNDS = (0.15, 0.20, 0.25, 0.30), (2, 3, 4)
UNSEEN = 15  # stream of the generator's cells

RULE = Rule(limit=100.0, fastest=2.0, slowest=8.0, begins_at=0.1, touch_ends=True, penalties=False)

Field = NDArray[np.int64]


class Barn(Track):
    """Ten metres through cylinders; any contact ends the episode."""

    name, summary = "barn", "BARN's worlds, rules and score (0.5 at best)"
    rule, robot = RULE, "jackal"

    def cases(self, seeds: int, folder: Path | None = None) -> list[Case]:
        """Returns BARN's own test worlds, or those of a folder, one per seed."""
        worlds = shipped() if folder is None else read_worlds(folder)
        return [Case(self.name, seed, world) for seed, world in enumerate(worlds[:seeds])]

    def unseen(self, seed: int) -> Case:
        """Returns a world of BARN's generator that is in no folder."""
        draw = 0
        while True:
            field = generated(seed, draw)
            if is_passable(field):
                return Case(self.name, seed, _world_of_field(f"unseen_{seed}", field))
            draw += 1

    def task(self, case: Case, folder: Path) -> Task:
        """Returns the task of a world, whose path is the published one or else the shortest."""
        assert case.world is not None  # noqa: S101 - as `cases` and `unseen` make them
        file = folder / case.world.name
        file.write_bytes(case.world.text)
        run = self.run(
            terrain=str(file), start=START, route=to(GOAL, NEAR), seed=case.seed, lidar_beams=960
        )
        length = case.world.length
        if length is None:
            length = Planner(world_of(run), find_rover(self.robot)).length((PLACE, GOAL))
        return Task(run=run, shortest=length, speed=REFERENCE_SPEED, rule=RULE)


BARN = Barn()


def shipped() -> list[WorldFile]:
    """Returns the worlds that ship, in the order of their numbers."""
    lines = files("harness.course").joinpath("worlds/barn.csv").read_text().splitlines()[1:]
    worlds = []
    for line in lines:
        number, length, code = line.split(",")
        bits = [int(bit) for bit in f"{int(code, 16):0{SIDE * SIDE}b}"]
        field = np.array(bits, np.int64).reshape(SIDE, SIDE)
        worlds.append(_world_of_field(f"barn_{number}", field, float(length)))
    return worlds


def _world_of_field(name: str, field: Field, length: float | None = None) -> WorldFile:
    """Returns the world with cylinders where a field is 1, and the corridor that leads there."""
    corridor = {(0, row) for row in range(FIRST_ROW)} | {(SIDE - 1, row) for row in range(FIRST_ROW)}
    corridor |= {(column, 0) for column in range(SIDE)}
    rows, columns = np.nonzero(field)
    standing = zip(columns.tolist(), (rows + FIRST_ROW).tolist(), strict=True)
    return WorldFile(f"{name}.sdf", world_text(name, cylinders([*corridor, *standing])), length)


def cylinders(cells: Iterable[tuple[int, int]]) -> Sequence[Circle]:
    """Returns the cylinder of each cell, which is its column and its row."""
    x, y = CORNER
    return [(round(x + CELL * i, 3), round(y + CELL * j, 3), RADIUS) for i, j in sorted(cells)]


def generated(seed: int, draw: int) -> Field:
    """Returns a field of BARN's generator (dperille/jackal-map-creation), 1 where a cylinder stands.

    A cellular automaton: cells are filled at random, then again and again those are filled that have
    more than four filled neighbours, those emptied that have fewer than two; walls stand at both sides.
    """
    rng = generator(seed, UNSEEN, draw)
    kind = seed % (len(FILLS) * len(ROUNDS))
    field = (rng.random((SIDE, SIDE)) < FILLS[kind // len(ROUNDS)]).astype(np.int64)
    field[:, (0, -1)] = 1
    for _ in range(ROUNDS[kind % len(ROUNDS)]):
        walled = np.zeros((SIDE + 2, SIDE + 2), np.int64)
        walled[:, (0, -1)] = 1
        walled[1:-1, 1:-1] = field
        rows = walled[:-2] + walled[1:-1] + walled[2:]
        neighbours = rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:] - field
        field = np.where(neighbours > 4, 1, np.where(neighbours < 2, 0, field))
    return np.asarray(field)


def is_passable(field: Field) -> bool:
    """Returns whether a robot of 0.75 m across, BARN's, gets from the first row to the last."""
    from scipy.ndimage import binary_dilation, label  # noqa: PLC0415 - slow to import

    free = ~binary_dilation(field.astype(bool), np.ones((5, 5), bool))
    parts, _ = label(free)
    first, last = set(parts[0].tolist()) - {0}, set(parts[-1].tolist()) - {0}
    return bool(first & last)
