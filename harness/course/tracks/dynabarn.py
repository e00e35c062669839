"""Track dynabarn: cylinders of 0.5 m that move, as in DynaBARN.

worlds/dynabarn.csv has the key frames of twenty of its worlds, read out of its compiled plug-ins (MIT
licence, worlds/LICENSE). A seed is a world and the time at which the rover enters the motion.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from harness.base.streams import COURSE, generator
from harness.course.task import Case, Task
from harness.course.tracks.barn import NEAR, REFERENCE_SPEED, RULE
from harness.course.tracks.base import Track, to
from harness.course.tracks.sdf import Circle, actors_text, world_text

START, GOAL = (11.0, 0.0, 3.14), (-9.0, 0.0)
LENGTH = 20.0  # [m]
MOVER = "radius=0.5,height=1.2"  # a capsule, whose straight part is where the lidar looks
JUMP = 1e-3  # [s] in which a mover is back where it began, as its plug-in puts it

LATEST, TRIES = 60.0, 1000  # [s] at which a rover may enter the motion; times that are tried
CLEAR, CLEAR_FOR = 2.0, (0.0, 1.0, 2.0, 3.0)  # [m] around the start without a mover, at these times [s]

KeyFrames = Sequence[Circle]  # x, y [m] and time [s] of each


class DynaBarn(Track):
    """Twenty metres between movers; any contact ends the episode."""

    name, summary = (
        "dynabarn",
        "DynaBARN's moving cylinders, its rules, its score over 20 m (0.5 at best)",
    )
    rule, robot = RULE, "jackal"

    def task(self, case: Case, folder: Path) -> Task:
        """Returns the task of a seed: the plane, and the movers from a time of their own on."""
        worlds = key_frames()
        names = sorted(worlds)
        movers = worlds[names[case.seed % len(names)]]
        rng = generator(case.seed, COURSE, self.name)
        entered = next(
            time for time in rng.uniform(0.0, LATEST, TRIES).tolist() if is_fair(movers, time)
        )
        world, actors = folder / "plane.sdf", folder / "movers.sdf"
        world.write_bytes(world_text("dynabarn", ()))
        actors.write_bytes(actors_text(entering(frames, entered) for frames in movers))
        run = self.run(
            terrain=str(world),
            actors=(f"{actors}:{MOVER}",),
            start=START,
            route=to(GOAL, NEAR),
            seed=case.seed,
            lidar_beams=960,
        )
        return Task(run=run, shortest=LENGTH, speed=REFERENCE_SPEED, rule=RULE)


DYNABARN = DynaBarn()


@cache
def key_frames() -> dict[int, list[KeyFrames]]:
    """Returns the key frames of each mover of each world, by the world's number."""
    by_mover: dict[tuple[int, int], list[Circle]] = defaultdict(list)
    lines = files("harness.course").joinpath("worlds/dynabarn.csv").read_text().splitlines()
    for world, mover, t, x, y in (line.split(",") for line in lines[1:]):
        by_mover[int(world), int(mover)].append((float(x), float(y), float(t)))
    worlds: dict[int, list[KeyFrames]] = defaultdict(list)
    for (world_number, _), frames in sorted(by_mover.items()):
        worlds[world_number].append(frames)
    return dict(worlds)


def is_fair(movers: Sequence[KeyFrames], time: float) -> bool:
    """Returns whether nobody comes near the start right after a time [s]."""
    places = [_at(frames, (time + later) % frames[-1][2]) for frames in movers for later in CLEAR_FOR]
    return all(math.dist(place, START[:2]) > CLEAR for place in places)


def entering(frames: KeyFrames, time: float) -> list[Circle]:
    """Returns the motion from a time [s] on, over and over: straight lines between key frames.

    At the end of its period a mover is back where it began at once; most curves do not close.
    """
    period = frames[-1][2]
    since = time % period
    x, y = _at(frames, since)
    later = [(a, b, t - since) for a, b, t in frames if t > since]
    earlier = [(a, b, t - since + period) for a, b, t in frames if t < since]
    if earlier:
        earlier[0] = (*earlier[0][:2], earlier[0][2] + JUMP)
    last = [(x, y, period)] if since > JUMP else []
    return [(x, y, 0.0), *later, *earlier, *last]


def _at(frames: KeyFrames, time: float) -> tuple[float, float]:
    x, y, times = zip(*frames, strict=True)
    return float(np.interp(time, times, x)), float(np.interp(time, times, y))
