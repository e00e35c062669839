import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.episode.batch import Batch
from harness.page.run.recorder import RunRecorder
from harness.run import main
from harness.samples import ActorPoses, Imu, LaserScan, Pose, Sample, Tick, Truth

BATCH_NS = 50_000_000


def batch(index: int, *, az: float = 9.81, nearest: float = 5.0, contact_s: float = 0.0) -> Batch:
    """The batch that ends at (index + 1) * 50 ms, with a sample of each kind at its last tick."""
    stamp = (index + 1) * BATCH_NS
    samples: tuple[Sample, ...] = (
        LaserScan(stamp, np.array([np.inf, nearest, -np.inf, np.nan], dtype=np.float32)),
        Imu(stamp, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, az)),
    )
    if index % 2:
        samples += (Pose(stamp, (index * 0.02, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),)
    x = index * 0.02
    truth = Truth(time_ns=stamp, path_length=x, position=(x, 0.0, 0.0), hazard_contact_s=contact_s)
    return Batch((Tick(stamp, samples),), truth)


def test_a_stretch_is_a_tenth_of_a_second_with_its_extremes() -> None:
    recorder = RunRecorder()
    ticks = (*batch(0, az=8.0, nearest=0.5).ticks, *batch(0, az=13.0, nearest=0.9).ticks)
    recorder.take(Batch(ticks, Truth(time_ns=BATCH_NS)))
    recorder.take(batch(1, az=12.0, contact_s=0.03))
    (stretch,) = recorder.track
    assert stretch.time_s == pytest.approx(0.1)
    assert (stretch.lowest_acceleration, stretch.highest_acceleration) == (8.0, 13.0)
    assert stretch.nearest_range == 0.5
    assert stretch.contact_s == pytest.approx(0.03)
    assert (stretch.path_length, stretch.position) == (0.02, (0.02, 0.0, 0.0))
    recorder.take(batch(2, nearest=0.75, contact_s=0.07))
    recorder.take(batch(3, nearest=0.25, contact_s=0.07))
    assert recorder.track[1].contact_s == pytest.approx(0.04)
    assert recorder.track[1].nearest_range == 0.25


def test_a_stretch_has_people_at_its_end_and_the_nearest_of_all() -> None:
    recorder = RunRecorder()
    for index, far in enumerate((4.0, 3.0, 5.0, 6.0)):
        one, stamp = batch(index), (index + 1) * BATCH_NS
        places = ((9.0, 9.0, 1.0), (recorder.track[-1].position[0] if index else 0.0, far, 0.9))
        people = ActorPoses(stamp, places, ((0.0, 0.0, 0.0, 1.0),) * 2)
        later = replace(people, position=(places[0], places[0]))
        samples = (*one.ticks[0].samples, people, later)
        recorder.take(Batch((Tick(stamp, samples),), one.truth))
    assert [stretch.people[1][1] for stretch in recorder.track] == [9.0, 9.0]
    assert [stretch.nearest_person for stretch in recorder.track] == pytest.approx([3.0, 5.0], abs=1e-3)
    nearest = recorder.track[0].approaches[1]
    assert (nearest.time_s, *nearest.rover, *nearest.person) == pytest.approx((0.1, 0.02, 0.0, 0.0, 3.0))


def test_a_long_run_takes_no_more_memory_and_loses_neither_peak_nor_contact() -> None:
    recorder = RunRecorder(fewest_stretches=50)
    for index in range(10_001):
        peak, contact = (30.0, 0.05) if index >= 777 else (9.81, 0.0)
        recorder.take(batch(index, az=peak if index == 777 else 9.81, contact_s=contact))
    track = recorder.track
    assert 50 <= len(track) <= 101
    assert track[-1].time_s == pytest.approx(10_001 * 0.05)
    assert max(stretch.highest_acceleration for stretch in track) == 30.0
    assert sum(stretch.contact_s for stretch in track) == pytest.approx(0.05)
    lengths = np.diff([0.0, *(stretch.time_s for stretch in track[:-1])])
    assert lengths == pytest.approx(recorder.stretch_s)


def test_a_run_that_ends_within_a_stretch_has_its_end_and_the_last_scan_that_has_a_pose() -> None:
    recorder, quiet = RunRecorder(), RunRecorder()
    for index in range(3):
        recorder.take(batch(index))
    assert [stretch.time_s for stretch in recorder.track] == pytest.approx([0.1, 0.15])
    assert recorder.last_scan is not None
    assert recorder.last_scan.scan.stamp_ns == recorder.last_scan.pose.stamp_ns == 2 * BATCH_NS
    quiet.take(Batch((), Truth(time_ns=BATCH_NS)))  # of a tick without samples
    (stretch,) = quiet.track
    assert (stretch.nearest_range, stretch.highest_acceleration) == (math.inf, -math.inf)
    assert quiet.last_scan is None


QUICK = ["--direct", "--terrain", "flat", "--duration", "2"]


def test_report_option_writes_the_page_and_changes_no_byte_of_the_log(tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    assert main([*QUICK, "--log-dir", str(tmp_path / "with"), "--report", str(page)]) == 0
    assert main([*QUICK, "--log-dir", str(tmp_path / "without")]) == 0
    (with_report,), (without,) = ((tmp_path / d).glob("*.csv") for d in ("with", "without"))
    assert with_report.read_bytes() == without.read_bytes()
    assert "<h1>leo on flat</h1>" in page.read_text(encoding="utf-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "with", "without"]
