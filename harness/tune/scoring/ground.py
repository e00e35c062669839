"""rough_terrain_threshold and smoothness_threshold: telling rough ground from smooth, and at what speed.

The simulator knows how rough the ground under the wheels is; the metrics only feel it through the IMU.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord, Table
from harness.tune.scoring import estimate as est
from harness.tune.scoring.choose import Records, Scoring, Verdict, judged
from harness.tune.scoring.estimate import Counts, Estimate, Measure, Sums, recall, specificity

ROUGH = 0.003  # [m] RMS over 0.3 m: half of what the ERC Marsyard DEM has (5.5-6.2 mm)
STANDING = 0.05  # [m/s]: slower, no IMU can feel the ground
COLUMN_WINDOWS = 5  # seconds that Current Smoothness covers: 100 IMU samples at 20 Hz
FEWEST_WINDOWS = 50  # seconds of each class and part: fewer do not support a threshold
FEWEST_IN_BIN = 20  # of each class
SPEED_BINS = ((0.05, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 2.0))  # [m/s]
GRID = np.round(np.arange(9.8, 30.0, 0.05), 2)  # from gravity up


class ImuEvents(NamedTuple):
    """What a metric says of stretches of an episode, and whether they are rough; each of shape (n,)."""

    signal: NDArray[np.float64]  # what is compared with the threshold
    rough: NDArray[np.bool_]  # the truth
    speed: NDArray[np.float64]  # mean true speed [m/s]

    @classmethod
    def joined(cls, each: Sequence["ImuEvents"]) -> "ImuEvents":
        """Returns those of several episodes, in their order."""
        none = cls(np.empty(0), np.empty(0, dtype=bool), np.empty(0))
        return cls(*map(np.concatenate, zip(*each, strict=True))) if each else none

    def within(self, low: float, high: float) -> "ImuEvents":
        """Returns those at a speed of at least `low` and less than `high` [m/s]."""
        inside = (self.speed >= low) & (self.speed < high)
        return ImuEvents(self.signal[inside], self.rough[inside], self.speed[inside])


@dataclass(frozen=True)
class Signal:
    """What one of the two thresholds is compared with, by its name on the page, from an episode."""

    parameter: str
    name: str
    imu_events: Callable[[EpisodeRecord], ImuEvents]


def _usable(windows: Table) -> NDArray[np.bool_]:
    # Rocks and hazards move the IMU but are not in the height map, whose roughness is the truth here.
    touching = windows["contact"] | (windows["rocks"] > 0.0)
    return np.asarray(~touching & (windows["speed"] >= STANDING))


def peak_acceleration(record: EpisodeRecord) -> ImuEvents:
    """Returns seconds with the largest acceleration in each."""
    windows = record.windows[_usable(record.windows)]
    return ImuEvents(windows["peak_acceleration"], windows["roughness"] > ROUGH, windows["speed"])


def current_smoothness(record: EpisodeRecord) -> ImuEvents:
    """Returns seconds, with the value that the column Current Smoothness has at their end."""
    windows, kernel = record.windows, np.full(COLUMN_WINDOWS, 1.0 / COLUMN_WINDOWS)
    if len(windows) < COLUMN_WINDOWS:
        return ImuEvents.joined([])
    means = {
        name: np.convolve(windows[name].astype(np.float64), kernel, mode="valid")
        for name in ("mean_smoothness", "roughness", "speed")
    }
    usable = np.convolve(_usable(windows), np.ones(COLUMN_WINDOWS), mode="valid") == COLUMN_WINDOWS
    return ImuEvents(
        means["mean_smoothness"][usable], means["roughness"][usable] > ROUGH, means["speed"][usable]
    )


SIGNALS = (
    Signal("rough_terrain_threshold", "largest |a| of a second", peak_acceleration),
    Signal("smoothness_threshold", "Current Smoothness, |a| + |w| over 5 s", current_smoothness),
)


@dataclass(frozen=True, kw_only=True)
class SpeedBin:
    """How a signal separates the classes at one speed."""

    speeds: tuple[float, float]  # from, to [m/s]
    windows: int  # how many seconds
    rough: int  # how many of them are
    auc: float | None  # area under the ROC curve; None with too little of a class, as is `best`
    best: float | None  # threshold with the highest balanced accuracy there


@dataclass(frozen=True, kw_only=True)
class GroundStudy:
    """One of the two thresholds for one robot."""

    verdict: Verdict
    what: str  # name of the signal on the page
    auc: dict[Part, Estimate]  # area under the ROC curve by part
    speed_bins: tuple[SpeedBin, ...]  # over all episodes


def study_ground(records: Records, signal: Signal) -> GroundStudy:
    """Judges the default of the signal's threshold and chooses a better value, if there is one."""

    def count(some: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]) -> Counts:
        return counts_of([signal.imu_events(record) for record in some], thresholds)

    scoring = Scoring(count, MEASURES, "balanced accuracy", GRID, "terrain")
    verdict = judged(signal.parameter, scoring, records, lack=_lack(records, signal))
    everything = ImuEvents.joined([signal.imu_events(one) for some in records.values() for one in some])
    return GroundStudy(
        verdict=verdict,
        what=signal.name,
        auc={part: _auc(count(some, GRID), some) for part, some in records.items()},
        speed_bins=tuple(_speed_bin(speeds, everything.within(*speeds)) for speeds in SPEED_BINS),
    )


def counts_of(episodes: Sequence[ImuEvents], thresholds: NDArray[np.float64]) -> Counts:
    """Returns counts of `confusion` at every threshold, above which ground is called rough."""
    return est.confusion([(-one.signal, one.rough) for one in episodes], -thresholds)


def balanced_accuracy(sums: Sums) -> NDArray[np.float64]:
    """Returns the mean of both rates, where a miss costs as much as a false alarm, whatever is rarer."""
    return (recall(sums) + specificity(sums)) / 2


MEASURES: dict[str, Measure] = {
    "balanced accuracy": balanced_accuracy,
    "recall": recall,
    "specificity": specificity,
}


def _auc(counts: Counts, records: Sequence[EpisodeRecord]) -> Estimate:
    """Area under the ROC curve over the thresholds of the first axis, by trapezoids."""
    thresholds, episodes, kinds = counts.shape
    flat = np.moveaxis(counts, 0, 1).reshape(episodes, -1)

    def area(sums: Sums) -> NDArray[np.float64]:
        at = sums.reshape(*sums.shape[:-1], thresholds, kinds)
        ends = [(0, 0)] * (at.ndim - 2) + [(1, 1)]
        hits, misses = (
            np.pad(rate, ends, constant_values=((1.0, 0.0),))
            for rate in (recall(at), 1.0 - specificity(at))
        )
        return np.asarray(-np.trapezoid(hits, misses, axis=-1))

    return est.estimate(flat, area, [record.terrain for record in records])


def _lack(records: Records, signal: Signal) -> str | None:
    """Why the data support no value, or None."""
    for part, some in records.items():
        each = np.concatenate([signal.imu_events(record).rough for record in some])
        rough, smooth = np.count_nonzero(each), np.count_nonzero(~each)
        if min(rough, smooth) < FEWEST_WINDOWS:
            return (
                f"{rough} s on rough ground (over {ROUGH * 1e3:g} mm RMS) and {smooth} s on smooth in "
                f"the {part} episodes; {FEWEST_WINDOWS} s of each are needed"
            )
    return None


def _speed_bin(speeds: tuple[float, float], events: ImuEvents) -> SpeedBin:
    windows, rough = len(events.rough), int(np.count_nonzero(events.rough))
    auc = best = None
    if min(rough, windows - rough) >= FEWEST_IN_BIN:
        scores = balanced_accuracy(counts_of([events], GRID)[:, 0])
        from sklearn.metrics import roc_auc_score  # noqa: PLC0415 - not for --help

        auc = float(roc_auc_score(events.rough, events.signal))
        best = float(GRID[int(np.argmax(scores))])
    return SpeedBin(speeds=speeds, windows=windows, rough=rough, auc=auc, best=best)
