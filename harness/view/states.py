"""The states of an episode on disk: all that it takes to draw the run afterwards, in another process.

One line of JSON (what the scene is made from), then rows of float64: time [s], pose of the model frame
(position, w, x, y, z), joint positions in the order of the rover's `joints`, of each person the middle
and the heading. They come from the samples that are published: nothing in the episode knows of it.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.base.documents import parse_json
from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS
from harness.episode.assembly import actor_names
from harness.episode.batch import Batch
from harness.robots import find_rover
from harness.samples import ActorPoses, JointStates, Pose
from harness.spec.run import Run
from harness.spec.value import made

PERIOD_NS = 40_000_000  # 25 states a second, as a video shows them
POSE_SIZE, PERSON_SIZE = 7, 4
HALF_WINDOW = 0.25  # [s] of a speed that can be read


class StateWriter:
    """Appends the states of an episode to a new file until it is closed.

    Args:
        path: The file, which is overwritten.
        run: What the scene is made of.
        number: The rover's place in the run.
    """

    def __init__(self, path: Path, run: Run, number: int = 0) -> None:
        self.path = path
        self._file = path.open("wb")
        self._people: tuple[float, ...] = (0.0,) * PERSON_SIZE * len(actor_names(run.world))
        header = {"run": run.model_dump(mode="json"), "number": number}
        self._file.write(json.dumps(header).encode() + b"\n")

    def close(self) -> None:
        """Completes the file."""
        self._file.close()

    def take(self, batch: Batch) -> None:
        """Writes the states of a batch; a fault may have taken one."""
        for tick in batch.ticks:
            if self._people and (people := tick.of(ActorPoses)):
                self._people = people_row(people)  # not on every tick of a state: the latest
            if tick.stamp_ns % PERIOD_NS:
                continue
            pose, joints = tick.of(Pose), tick.of(JointStates)
            if pose is not None and joints is not None:
                x, y, z, w = pose.orientation
                row = (tick.stamp_ns / NANOSECONDS, *pose.position, w, x, y, z, *joints.position)
                row += self._people
                self._file.write(np.array(row).tobytes())


def people_row(people: ActorPoses) -> tuple[float, ...]:
    """Returns x, y, z [m] and heading [rad] of each person, one after the other."""
    places = zip(people.position, people.orientation, strict=True)
    return tuple(
        n for (x, y, z), (_, _, sin, cos) in places for n in (x, y, z, 2 * math.atan2(sin, cos))
    )


@dataclass(frozen=True, eq=False)
class States:
    """What was recorded."""

    run: Run
    number: int
    times: NDArray[np.float64]  # simulation times [s], shape (n,)
    path: NDArray[np.float64]  # position of the rover's model frame at those times [m], shape (n, 3)
    orientations: NDArray[np.float64]  # its attitude as (w, x, y, z), shape (n, 4)
    joints: NDArray[np.float64]  # positions of the rover's joints, shape (n, number of joints)
    people: NDArray[np.float64]  # x, y, z [m] and heading [rad] of each person, shape (n, people, 4)

    @property
    def yaw(self) -> NDArray[np.float64]:
        """Heading at those times [rad], continuous, shape (n,).

        NumPy's arctan2 differs from math's in the last bit, so that this is not core.rotation's.
        """
        w, x, y, z = self.orientations.T
        return np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))

    @property
    def speed(self) -> NDArray[np.float64]:
        """Path over time, from HALF_WINDOW before to HALF_WINDOW after each state [m/s], shape (n,)."""
        steps = np.linalg.norm(np.diff(self.path, axis=0), axis=1)
        length = np.concatenate(([0.0], np.cumsum(steps)))
        early = np.maximum(self.times - HALF_WINDOW, self.times[0])
        late = np.minimum(self.times + HALF_WINDOW, self.times[-1])
        driven = np.interp(late, self.times, length) - np.interp(early, self.times, length)
        return np.asarray(driven / np.maximum(late - early, PERIOD_NS / NANOSECONDS))


def read_states(path: Path) -> States:
    """Reads what a `StateWriter` wrote; a UsageError where that is no recording or has no state."""
    try:
        header, _, body = path.read_bytes().partition(b"\n")
        content = parse_json(header, str(path))
        run, number = made(Run, content["run"]), int(content["number"])
        robot = run.rovers[number].robot
    except (OSError, ValueError, TypeError, LookupError, UsageError) as error:
        raise UsageError(f"{path} is no recording of an episode: {error}") from error
    joints, people = len(find_rover(robot).joints), len(actor_names(run.world))
    end_of_joints = 1 + POSE_SIZE + joints
    width = end_of_joints + PERSON_SIZE * people
    rows = np.frombuffer(body[: len(body) // (8 * width) * 8 * width], np.float64).reshape(-1, width)
    rows = rows[np.isfinite(rows).all(axis=1)]
    if not len(rows):
        raise UsageError("nothing to be drawn: the run ended before its first state")
    persons = rows[:, end_of_joints:].reshape(len(rows), people, PERSON_SIZE)
    parts = (rows[:, 0], rows[:, 1:4], rows[:, 4:8], rows[:, 8:end_of_joints])
    return States(run, number, *parts, persons)
