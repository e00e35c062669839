"""A recording as what was seen of each rover at each time, and the clock by which it is played.

Its manifest says what run it is of.
"""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from harness.base.documents import parse_json
from harness.base.errors import UsageError
from harness.base.made_of_files import modified_ns
from harness.base.message_types import read_message
from harness.base.sim_time import CONTROL_PERIOD_NS, NANOSECONDS
from harness.episode.assembly import actor_names
from harness.episode.helm import Helm
from harness.robots import find_rover
from harness.samples import ActorPoses, Truth
from harness.spec.run import Run
from harness.view.live.watch import MOST_POINTS, Sight, Watch
from harness.view.states import PERIOD_NS, people_row
from rover_metrics.bag.bag_reader import Bag
from rover_metrics.bag.mcap_stream import BagError
from rover_metrics.topics import quaternion, vector

FRAME = 0.05  # [s] of wall time between two states that are shown
POSE, JOINTS, SCAN = "/rover/pose_array", "/joint_states", "/scan"


@dataclass
class Series:
    """Values and since when [ns] each holds."""

    times: list[int] = field(default_factory=list)
    values: list[Any] = field(default_factory=list)

    def put(self, time_ns: int, value: object) -> None:
        """Takes the next value."""
        self.times.append(time_ns)
        self.values.append(value)

    def at(self, time_ns: int) -> Any:  # noqa: ANN401 - whatever it holds
        """Returns the value that holds at a time; None before the first."""
        index = bisect_right(self.times, time_ns)
        return self.values[index - 1] if index else None


class Track:
    """What a recording has of one rover."""

    def __init__(self) -> None:
        self.poses, self.joints, self.scans, self.people = Series(), Series(), Series(), Series()

    def show(self, watch: Watch, time_ns: int) -> None:
        """Shows a watch what was recorded for a time."""
        pose, joints, people = (s.at(time_ns) for s in (self.poses, self.joints, self.people))
        watch.people = watch.people if people is None else people
        driven = self.poses.values[: bisect_right(self.poses.times, time_ns)]
        stride = 1 + len(driven) // MOST_POINTS
        watch.path = [position for position, _ in driven[::stride]]
        sight = None if pose is None or joints is None else Sight(pose[0], pose[1], joints)
        watch.see(sight, Truth(time_ns), self.scans.at(time_ns))


class Player:
    """The time of a recording that is played, `time_ns` of `end_ns`; it may be put elsewhere."""

    def __init__(self, end_ns: int) -> None:
        self.end_ns, self.time_ns = end_ns, 0

    @property
    def end_s(self) -> float:
        """When the recording ends [s]."""
        return self.end_ns / NANOSECONDS

    def seek(self, time_s: float) -> None:
        """Goes to a time."""
        self.time_ns = round(time_s * NANOSECONDS)

    def go_on(self, helm: Helm) -> None:
        """Goes on by a frame at the helm's rate, or by a step; at its end it stands."""
        if not helm.paused:
            self.time_ns += round(FRAME * NANOSECONDS * (helm.rate or self.end_s))
        elif helm.take_step():
            self.time_ns += CONTROL_PERIOD_NS
        self.time_ns = min(self.time_ns, self.end_ns)


def manifests_near(*folders: Path) -> list[Path]:
    """Returns files that may be manifests, of folders and of those in them, the latest last."""
    recorded = (
        file for folder in folders for form in ("*.json", "*/*.json") for file in folder.glob(form)
    )
    return sorted(recorded, key=modified_ns)


def run_of(recording: Path, given: Sequence[Path], near: Sequence[Path]) -> Run:
    """Returns the run that a recording is of.

    Args:
        recording: The file.
        given: Manifests of the run, one per rover; empty to look for them.
        near: Where to look: files among which they are, the latest last.

    Raises:
        UsageError: The file is not there, one that is given is not of that recording, or none is found.
    """
    if not recording.exists():
        raise UsageError(f"{recording} does not exist")
    runs = dict(_run_in(file, recording) for file in given) or dict(_runs_in(near, recording))
    if not runs:
        raise UsageError(f"{recording}: no manifest of its run is near; give it: --manifest FILE.json")
    return runs[min(runs)].but(rovers=tuple(runs[number].rover for number in sorted(runs)))


def _runs_in(files: Sequence[Path], recording: Path) -> Iterator[tuple[int, Run]]:
    """The runs of what are manifests of a recording among files, by the number of their rover."""
    for file in files:
        with suppress(UsageError):
            yield _run_in(file, recording)


def _run_in(file: Path, recording: Path) -> tuple[int, Run]:
    """The number of the rover and the run of a manifest; UsageError if it is not of that recording."""
    try:
        said = parse_json(file.read_bytes(), str(file))
    except OSError as error:
        raise UsageError(f"{file} cannot be read: {error.strerror}") from error
    arguments, name = (
        (said.get("arguments"), said.get("recording")) if isinstance(said, dict) else (0, 0)
    )
    if not isinstance(arguments, dict) or Path(str(name)).name != recording.name:
        raise UsageError(f"{file} is no manifest of a run with the recording {recording.name}")
    values = {key: value for key, value in arguments.items() if key not in ("number", "world_robot")}
    return int(arguments.get("number", 0)), Run.of(**values)


def read_tracks(recording: Path, run: Run) -> list[Track]:
    """Returns what a recording has of each rover of a run.

    Raises:
        UsageError: It cannot be read, or has no pose of a rover.
    """
    tracks = [Track() for _ in run.rovers]
    try:
        with Bag(recording) as bag:
            takers = {
                topic: (track, kind, find_rover(rover.robot).joints)
                for rover, track in zip(run.rovers, tracks, strict=True)
                for topic, kind in _topics(_space(rover.name, bag), actor_names(run.world))
            }
            for message in bag.messages(takers.keys()):
                if message.topic in takers:
                    track, kind, joints = takers[message.topic]
                    read = read_message(message.data, bag.topics[message.topic])
                    _take(track, kind, joints, message.time_ns, read)
    except (BagError, OSError, ValueError) as error:
        raise UsageError(f"{recording}: {error}") from error
    if not all(track.poses.times for track in tracks):
        raise UsageError(f"{recording} has no {POSE} of a rover of the run")
    return tracks


def _space(name: str, bag: Bag) -> str:
    """The namespace of a rover's topics with its slash; one without a name has it of --namespace."""
    given = [topic.removesuffix(POSE) for topic in bag.topics if topic.endswith(POSE)]
    return f"/{name}" if name else min(given, key=len, default="")


def _topics(space: str, people: Sequence[str]) -> list[tuple[str, str | int]]:
    """The topics of a rover that are read, each with what it brings: of a person, the number."""
    persons = [(f"{space}/{name}/pose", index) for index, name in enumerate(people)]
    return [*((f"{space}{topic}", topic) for topic in (POSE, JOINTS, SCAN)), *persons]


def _take(track: Track, kind: str | int, joints: Sequence[str], time_ns: int, read: Any) -> None:  # noqa: ANN401
    """Takes a message; of poses and joints as many as a video shows."""
    if kind == SCAN:
        track.scans.put(time_ns, np.asarray(read.ranges))
    elif isinstance(kind, int):
        before = track.people.values[-1] if track.people.values else np.zeros((0, 4))
        rows = np.zeros((max(len(before), kind + 1), 4))
        rows[: len(before)] = before
        places = (vector(read.position),), (quaternion(read.orientation),)
        rows[kind] = people_row(ActorPoses(time_ns, *places))
        track.people.put(time_ns, rows)
    elif time_ns % PERIOD_NS == 0:
        if kind == JOINTS:
            positions = dict(zip(read.name, read.position, strict=False))
            track.joints.put(time_ns, tuple(float(positions.get(name, 0.0)) for name in joints))
        elif read.poses:
            x, y, z, w = quaternion(read.poses[0].orientation)
            track.poses.put(time_ns, (vector(read.poses[0].position), (w, x, y, z)))
