"""Samples as rows: what a scan and a second come down to, and how an episode ends."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view

from harness.base.errors import Diverged, PluginFailed, RunFailed
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.episode.metrics_feed import SampleFeed, extended_settings
from harness.episode.together import Together
from harness.robots.lidar import LidarSpec
from harness.samples import LaserScan, Pose, Sample, Tick, Truth, TruthState
from harness.spec.run import Run
from harness.tune.episodes import sweep
from harness.tune.episodes.recompute import Collected
from harness.tune.episodes.record import Ending
from harness.tune.episodes.store import decode, encode
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.session import MetricsSession
from tests.support.documents import ROOT
from tests.support.rovers import LEO, ROVER_ZERO4WD

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
MS = 1_000_000


def state(stamp_ms: int, *, speed: float = 0.0, **more: bool | float) -> TruthState:
    values = {"hazard_contact": False, "rock_contact": False, "path_length": 0.0, "roughness": 0.0}
    return TruthState(
        stamp_ns=stamp_ms * MS,
        scrape=False,
        contact_force=0.0,
        speed=speed,
        slip=(0.0, 0.0, 0.0, 0.0),
        **values | more,  # type: ignore[arg-type]  # of four types
    )


def batch(*samples: Sample, tipped: bool = False) -> Batch:
    """One whose samples stand in a tick for each stamp."""
    stamps = sorted({sample.stamp_ns for sample in samples})
    ticks = (Tick(at, tuple(one for one in samples if one.stamp_ns == at)) for at in stamps)
    return Batch(tuple(ticks), Truth(tipped_over=tipped))


def test_a_scan_stands_at_the_pose_nearest_in_time() -> None:
    poses = [Pose(ms * MS, (float(ms), 0.0, 0.0), UPRIGHT) for ms in (20, 40, 60, 80)]
    scans = [LaserScan(ms * MS, np.zeros(2, np.float32)) for ms in (1, 29, 31, 60, 99)]
    collected = Collected(LEO, LidarSpec(beams=2))
    collected.take(batch(state(1), *poses, *scans))
    placed = collected.placed_scans()
    assert [item.scan.stamp_ns // MS for item in placed] == [1, 29, 31, 60, 99]
    assert [item.pose.position[0] for item in placed] == [20.0, 20.0, 40.0, 60.0, 80.0]
    assert (len(Collected(LEO).scan_rows()), len(Collected(LEO).window_rows())) == (0, 0)


def test_a_scan_without_a_return_is_near_nothing_whatever_the_one_before_saw() -> None:
    inf, collected = np.inf, Collected(LEO, LidarSpec(beams=2))
    seen = enumerate(((1.0, 2.0), (inf, inf), (-inf, inf)), 1)
    scans = [LaserScan(50 * MS * n, np.array(ranges, np.float32)) for n, ranges in seen]
    collected.take(batch(state(1), *scans))
    rows = collected.scan_rows()
    assert rows["nearest"].tolist() == [1.0, inf, inf]
    assert rows["near_returns"].tolist() == [0, 0, 1]


def test_rows_tell_of_any_threshold_what_a_metrics_session_with_it_counts() -> None:
    """What the scoring compares with thresholds is what the node compares."""
    run = Run.of(robot="rover_zero4wd", terrain="rocky", driver="ram", seed=3, duration=12.0)
    ticks = [tick for one in Episode(run).batches() for tick in one.ticks]
    record = sweep.drive(run)
    scans, windows = record.scans, record.windows
    smoothness = sliding_window_view(windows["mean_smoothness"], 5).mean(axis=1)
    for distance, acceleration, step in ((0.2, 10.5, 0.005), (0.5, 12.0, 0.01), (1.0, 14.0, 0.02)):
        thresholds = Thresholds(
            collision_threshold=distance, rough_terrain_threshold=acceleration, distance_threshold=step
        )
        settings = replace(extended_settings(ROVER_ZERO4WD), footprint_threshold=distance)
        session = MetricsSession(thresholds, settings)
        feed = SampleFeed(session, LidarSpec())
        rough, short, current = np.zeros(12, bool), np.ones(12, bool), []
        for tick in ticks:
            second = -(-tick.stamp_ns // 1_000_000_000) - 1  # (0, 1] is the first
            for sample in tick.samples:
                feed.take(sample)
                short[second] &= not isinstance(sample, Pose) or session.metrics.last_step < step
            row = session.row(tick.stamp_ns)
            rough[second] |= bool(row.is_rough_terrain)
            if tick.stamp_ns % 1_000_000_000 == 0:
                current.append(row.current_smoothness)
        # Half floats: what rounds across the threshold may count on the other side.
        counted = session.metrics.total_collisions, row.extended["Footprint Collisions"]
        ours = np.sum(scans["nearest"] < distance), np.sum(scans["footprint"] < distance)
        assert ours == pytest.approx(counted, abs=2)
        assert np.sum(scans["near_returns"] > 0) == row.extended["Near Return Scans"]
        assert (windows["peak_acceleration"] > acceleration).tolist() == rough.tolist()
        assert (windows["largest_step"] < step).tolist() == short.tolist()
        assert smoothness == pytest.approx(current[4:], rel=1e-5)  # 100 IMU samples are 5 s
    *_, last = (one for tick in ticks for one in tick.samples if isinstance(one, TruthState))
    about = ("ram", "rocky", record.ending, last.path_length)
    for one in (record, decode(encode(record))):
        assert (one.driver, one.terrain, one.ending, one.path_length) == about


@pytest.mark.parametrize(
    ("tipped", "error", "ending", "scans"),
    [
        ((False, False), None, Ending.COMPLETE, 2),
        ((False, True, False), None, Ending.TIPPED_OVER, 2),
        ((False, True), None, Ending.TIPPED_OVER, 2),
        ((False,), RunFailed("off the map"), Ending.LEFT_THE_MAP, 1),
        ((False,), Diverged("too fast"), Ending.DIVERGED, 1),
    ],
)
def test_an_episode_is_kept_up_to_its_end_with_how_it_ended(
    tipped: tuple[bool, ...],
    error: Exception | None,
    ending: Ending,
    scans: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def scripted(_: object) -> Iterator[tuple[Batch, ...]]:
        for number, over in enumerate(tipped, start=1):
            ms = 50 * number
            ranges = np.full(640, 2.0, np.float32)
            samples = LaserScan(ms * MS, ranges), state(ms), Pose(ms * MS, (0.0, 0.0, 0.0), UPRIGHT)
            yield (batch(*samples, tipped=over),)
        if error is not None:
            raise error

    monkeypatch.setattr(Together, "batches", scripted)
    record = sweep.drive(Run.of(terrain="flat", duration=1.0))
    assert (record.ending, len(record.scans)) == (ending, scans)


def test_a_driver_that_raises_is_no_rover_that_left_the_map(tmp_path: Path) -> None:
    text = (ROOT / "examples/plugin/my_rover_parts.py").read_text()
    (file := tmp_path / "mine.py").write_text(text.replace("rate = 0.5", "rate = 1 // 0"))
    with pytest.raises(PluginFailed, match="ZeroDivisionError"):
        sweep.drive(Run.of(terrain="flat", duration=1.0, driver=f"{file}:Weave"))
