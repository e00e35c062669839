"""Learns a track of the Course by imitation: a network that does what the gap follower does.

python examples/imitate.py rocky.npz --track rocky --worlds 40

The gap follower looks at one scan and remembers nothing, so a network can do the same. It drives with
noise first, so that what it does off its way is learnt too; then the pupil drives and the teacher says
what it should have done (DAgger, Ross et al. 2011). Needs the extra [tune].
"""

import argparse
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from sklearn.neural_network import MLPRegressor

from harness.course.attempt import drive_with
from harness.course.tracks import find_track
from harness.drivers import point_nav
from harness.drivers.base import DriverContext, Observation
from harness.drivers.gap import Gap
from harness.drivers.policy import LIMITS, Policy, write_policy
from harness.samples import LIDAR_RANGE_MAX, Twist

EVERY, FAR = 5, 3.0  # of the lidar's beams that are looked at, and how far [m]
NOISE = 0.25  # standard deviation of what is added to the teacher's actions
ROUNDS = 2  # in the first one the teacher drives, then its pupil
FIRST = 5_000_000  # seed: far from those of the track


class Lesson(Gap):
    """Drives as teacher or as pupil, and keeps what was observed and what the teacher would do."""

    senses: ClassVar[Any] = point_nav.SENSED
    pupil: ClassVar[Policy | None] = None

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        self._rng, rover = context.rng, context.rover
        self._full = np.array([rover.top_speed, rover.cruise_yaw_rate])
        self.rows: list[tuple[Any, Any]] = []

    def command(self, observation: Observation) -> Twist:
        """Returns the command that is driven."""
        twist = super().command(observation)
        if self._goal is None or not observation.readings.keys() >= point_nav.SENSED:
            return twist
        values = point_nav.observed(observation.readings, self._goal, LIDAR_RANGE_MAX)
        arrays = {name: point_nav.clipped(values[name], *ends) for name, ends in LIMITS.items()}
        wanted = np.clip(np.array([twist.linear, twist.angular]) / self._full, -1.0, 1.0)
        self.rows.append((np.concatenate([arrays[name] for name in sorted(arrays)]), wanted))
        noisy = wanted + NOISE * self._rng.standard_normal(2)
        driven = noisy if self.pupil is None else self.pupil.act(arrays)
        return Twist(*(np.clip(driven, -1.0, 1.0) * self._full).tolist())


def lesson(track: str, seed: int, pupil: Policy | None) -> tuple[Any, Any, bool]:
    """Returns what was observed, what the teacher did, and whether the drive was a success."""
    Lesson.pupil = pupil
    result, driver = drive_with(find_track(track).unseen(seed), Lesson)
    observed, wanted = zip(*driver.rows, strict=True)
    return np.array(observed, np.float32), np.array(wanted), result.is_success


def fixed_layer(size: int) -> tuple[Any, Any]:
    """Returns weights and bias of the first layer, of goal, imu, lidar and velocities in this order."""
    beams = size - 13
    units = [(11 + beam, -1.0 / FAR, 1.0) for beam in range(0, beams, EVERY)]
    units += [(0, 0.2, 0.0), (0, -0.5, 1.0)]  # distance: far, near
    signed = {1: 1.0, 2: 1.0, size - 2: 1.0, size - 1: 1.0}
    units += [(index, sign * scale, 0.0) for index, scale in signed.items() for sign in (1.0, -1.0)]
    weights = np.zeros((size, len(units)), np.float32)
    for unit, (index, scale, _) in enumerate(units):
        weights[index, unit] = scale
    return weights, np.array([bias for *_, bias in units], np.float32)


def learnt(observed: NDArray[np.float32], wanted: NDArray[np.float64]) -> Policy:
    """Returns the network that does most nearly what the teacher did."""
    weights, bias = fixed_layer(observed.shape[1])
    features = np.maximum(observed @ weights + bias, 0.0)
    network = MLPRegressor(
        hidden_layer_sizes=(96, 64), max_iter=60, early_stopping=True, random_state=0, alpha=1e-4
    )
    network.fit(features, wanted)
    layers = zip(network.coefs_, network.intercepts_, strict=True)
    return Policy(
        ((weights, bias), *((w.astype(np.float32), b.astype(np.float32)) for w, b in layers)), "relu"
    )


def main() -> None:
    """Learns, and writes the policy after each round."""
    parser = argparse.ArgumentParser(description="Learns a track by imitation of `gap`.")
    parser.add_argument("policy", type=Path, metavar="FILE.npz", help="where to write the policy")
    parser.add_argument("--track", default="rocky", metavar="NAME", help="default %(default)s")
    about = "worlds of each round, default %(default)s"
    parser.add_argument("--worlds", type=int, default=40, metavar="N", help=about)
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="default %(default)s")
    given = parser.parse_args()
    pupil, observed, wanted = None, [], []
    for number in range(ROUNDS):
        seeds = range(FIRST + number * given.worlds, FIRST + (number + 1) * given.worlds)
        lessons = (delayed(lesson)(given.track, seed, pupil) for seed in seeds)
        for seen, done, _ in (got := Parallel(given.jobs)(lessons)):
            observed.append(seen)
            wanted.append(done)
        share = np.mean([success for *_, success in got])
        print(
            f"round {number}: {share:.0%} of {given.worlds} worlds, {sum(map(len, wanted)):,} samples",
            flush=True,
        )
        pupil = learnt(np.concatenate(observed), np.concatenate(wanted))
        write_policy(given.policy, pupil)


if __name__ == "__main__":
    main()
