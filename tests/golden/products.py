"""What is made of a run: live page, film, record of a sweep, quantities of a scenario, page, summary."""

import hashlib
import re
from collections.abc import Callable, Iterable, Iterator
from io import StringIO
from pathlib import Path

import numpy as np
from rich.console import Console

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS
from harness.cli.console import print_summary
from harness.episode.assembly import route_progress, world_of
from harness.episode.batch import Batch
from harness.episode.mission import MissionAccount
from harness.episode.result import RunResult
from harness.robots import find_rover
from harness.robots.lidar import LidarSpec
from harness.scenario.quantities import QUANTITIES
from harness.scenario.series import TruthSeries
from harness.spec.run import Run
from harness.tune.episodes.recompute import Collected, event_rows
from harness.validate.recordings.bags import recording_of_bag
from harness.view.camera import scale_of
from harness.view.live.recording import read_tracks
from harness.view.live.watch import Watch
from harness.view.marks import path_marks, track_marks
from harness.view.picture import chase
from harness.view.states import StateWriter, read_states

GOAL = (1.0, 0.3, 0.5)  # x, y, how near [m]
LOG = r"(metrics|social)_log_\d+_\d+"
OF_NOW = rf'; written [^<]*|{LOG}|<section aria-labelledby="facts-.*?</section>|(?<=policy:)[^<]*/'


class Onlookers:
    """Observers of a rover, each with what it makes of the run.

    Args:
        run: What is driven.
        number: The rover's place in it.
        folder: Gets what a video is made of.
    """

    def __init__(self, run: Run, number: int, folder: Path) -> None:
        self._world, setup = world_of(run), run.rovers[number]
        self._rover, self._run = find_rover(setup.robot), run
        self._sweep = Collected(self._rover, LidarSpec(beams=setup.lidar_beams))
        mission = MissionAccount(self._world.targets, route_progress(run, self._world))
        self._live, self._quantities = Watch(), TruthSeries(QUANTITIES, GOAL, mission)
        self._states = StateWriter(folder / f"{number}.states", run, number)

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        for each in (self._sweep, self._live, self._quantities, self._states):
            each.take(batch)

    def products(self) -> dict[str, str]:
        """Returns hashes of what they have made, by name."""
        live, sweep, ground = self._live, self._sweep, self._world.ground
        self._states.close()
        seen, scans = read_states(self._states.path), sweep.scan_rows()
        in_world = [one for one in sweep.events if one.other.rpartition("_")[2].isdecimal()]
        events = event_rows(in_world, sweep.placed_scans(), scans["speed"], self._world, self._rover)
        marks = *path_marks(seen, ground), *track_marks(seen, ground, self._rover)
        drawn = [
            (
                *one.position,
                *one.frame.ravel(),
                *(one.position if one.end is None else one.end),
                one.since,
            )
            for one in marks
        ]
        looked = [(*one.eye, *one.target) for one in chase(seen, scale_of(self._rover))]
        values = [series.values for series in self._quantities.series().values()]
        made = {
            "live": (live.sight, live.truth, live.speed, live.ranges, live.people, live.path),
            "states": (seen.times, seen.path, seen.yaw, seen.speed, seen.joints, seen.people),
            "film": (*drawn, np.array(looked)),
            "sweep": (scans, sweep.window_rows(), events),
            "quantities": (np.array(values),),
        }
        return {name: hashed(*parts) for name, parts in made.items()}


def hashed(*parts: object) -> str:
    """Returns a hash of values, some of them arrays."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode())
    return digest.hexdigest()[:16]


def of_summary(result: RunResult) -> dict[str, str]:
    """Returns a hash of what a terminal says at the end, without what is of this machine."""
    print_summary(Console(file=(said := StringIO()), width=120), result)
    return {"summary": hashed(re.sub(rf"in \S*{LOG}|people: \S+", "", said.getvalue()))}


def of_page(page: str) -> dict[str, str]:
    """Returns hashes of a page's text and of its figures, without what is of this machine."""
    (figures,) = re.findall(r'id="figures">(.*?)</script>', page, re.DOTALL)
    text = re.sub(rf"<(script|style).*?</\1>|<meta.*?>|{OF_NOW}", "", page, flags=re.DOTALL)
    return {"page": hashed(text), "figures": hashed(figures)}


def of_recording(bag: Path, run: Run) -> dict[str, str]:
    """Returns hashes of what a recording shows when it is played, and of what is fitted to it."""
    return {"played": hashed(*_told(_played, bag, run)), "read": hashed(*_told(_read, bag, run))}


def _told(make: Callable[[Path, Run], Iterable[object]], bag: Path, run: Run) -> Iterable[object]:
    try:
        return list(make(bag, run))
    except UsageError as error:
        return [type(error)]


def _played(bag: Path, run: Run) -> Iterator[object]:
    for track in read_tracks(bag, run):
        for share in (0.4, 1.0):
            track.show(watch := Watch(), round(share * run.duration * NANOSECONDS))
            yield from (watch.sight, watch.ranges, watch.people, watch.path)


def _read(bag: Path, run: Run) -> Iterator[object]:
    recording = recording_of_bag(bag, find_rover(run.rovers[0].robot))
    yield from (recording.sources, *recording.series.values())
