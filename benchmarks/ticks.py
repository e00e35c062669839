"""Where the time of an episode goes: MuJoCo's by its own timers, that of the rest by a stopwatch."""

import time
from collections import defaultdict
from typing import Any

import mujoco

from benchmarks.measuring import Effort, Table
from harness.episode.episode import Episode
from harness.spec.run import Run

ROBOTS = ("leo", "rover_zero4wd")
BEGINNING = 10  # batches that are not measured: the first scan and the first truth build what they need
TIMERS = {  # MuJoCo's, and what they are called here
    "mjTIMER_POS_COLLISION": "MuJoCo: collisions",
    "mjTIMER_CONSTRAINT": "MuJoCo: constraint solver",
}
OTHER_PHYSICS = "MuJoCo: all else"
SCAN, TRUTH, OTHERS = "lidar, 640 beams", "truth: slip, roughness", "other sensors"
DRIVER, REST = "driver", "ticks, batches, wheel commands"
PARTS = (*TIMERS.values(), OTHER_PHYSICS, SCAN, TRUTH, OTHERS, DRIVER, REST)


def measure(effort: Effort) -> Table:
    """Processor time of each part, per clock tick of 10 ms."""
    rows = []
    for robot in ROBOTS:
        parts = spent(Run.of(robot=robot, duration=effort.seconds))
        total = sum(parts.values())
        rows += [
            (robot, part, f"{1e6 * parts[part]:.1f} us", f"{parts[part] / total:.0%}") for part in PARTS
        ]
    return Table(
        title=f"Where a tick of 10 ms goes, {effort.seconds:g} simulated seconds on rocky",
        columns=("robot", "part", "processor time", "share"),
        rows=tuple(rows),
    )


def spent(run: Run) -> dict[str, float]:
    """Returns the processor time of each of PARTS in a drive, per tick [s]."""
    episode, watch = Episode(run), Stopwatch()
    data, batches = episode.simulation.data, episode.batches()
    for sensor in episode._sensors._sensors:  # noqa: SLF001 - a stopwatch at each
        kinds = {"LidarSensor": SCAN, "TruthSensor": TRUTH}
        watch.on(sensor, "read", kinds.get(type(sensor).__name__, OTHERS))
    watch.on(episode.pilot._driver, "command", DRIVER)  # noqa: SLF001 - likewise
    watch.on(episode.simulation.physics._span, "advance", OTHER_PHYSICS)  # noqa: SLF001 - likewise
    for _ in range(BEGINNING):
        next(batches)
    watch.spent.clear()
    before, begun = data.timer.duration.copy(), time.process_time()
    ticks = sum(len(batch.ticks) for batch in batches)
    total, timers = time.process_time() - begun, data.timer.duration - before
    parts = dict(watch.spent)
    physics = parts[OTHER_PHYSICS]
    for timer, name in TIMERS.items():
        share = timers[int(getattr(mujoco.mjtTimer, timer))] / timers[int(mujoco.mjtTimer.mjTIMER_STEP)]
        parts[name] = share * physics
        parts[OTHER_PHYSICS] -= share * physics
    parts[REST] = total - sum(watch.spent.values())
    return {part: parts[part] / ticks for part in PARTS}


class Stopwatch:
    """Measures what calls take.

    Attributes:
        spent: Processor time [s] by what it went to.
    """

    def __init__(self) -> None:
        self.spent: dict[str, float] = defaultdict(float)

    def on(self, thing: Any, method: str, part: str) -> None:  # noqa: ANN401 - whatever has methods
        """Measures the calls of a method of one object."""
        work = getattr(thing, method)

        def measured(*args: object, **named: object) -> object:
            begun = time.process_time()
            result = work(*args, **named)
            self.spent[part] += time.process_time() - begun
            return result

        setattr(thing, method, measured)
