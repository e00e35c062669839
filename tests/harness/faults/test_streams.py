"""Faults that remember earlier readings."""

from harness.base.sim_time import NANOSECONDS as SECOND
from harness.samples import LaserScan
from tests.harness.faults.faulty_ticks import scans, sent, times


def test_a_frozen_sensor_repeats_its_last_reading_or_else_its_first_with_new_stamps() -> None:
    frozen = scans("scan:freeze@1+1")
    assert times(frozen) == [n / 100 for n in range(1, 401)]
    assert {scan.ranges[0] for scan in frozen[98:199]} == {99.0}
    assert frozen[199].ranges[0] == 200.0
    assert {scan.ranges[0] for scan in scans("scan:freeze")} == {1.0}


def test_of_readings_that_come_together_the_last_is_frozen_or_the_first_of_a_frozen_sensor() -> None:
    """What was held back until 1.19 s arrives with what is read then, and that of 0.01 s with 0.06 s."""
    frozen = scans("scan:latency=0.2@0.5+0.5", "scan:freeze@1.2")
    assert {scan.ranges[0] for scan in frozen[-200:]} == {119.0}
    assert {scan.ranges[0] for scan in scans("scan:latency=0.05@0+0.02", "scan:freeze")} == {1.0}


def test_ticks_without_a_reading_are_no_readings() -> None:
    """As of a sensor that is slower than the clock: none is frozen, and none takes another's turn."""
    frozen = scans("scan:dropout@0.5+1", "scan:freeze@1+1")
    assert {scan.ranges[0] for scan in frozen if 1.0 <= scan.stamp_ns / SECOND < 2.0} == {49.0}
    slow = times(scans("scan:dropout@1+0.05", "scan:rate=5@1+1"))
    assert slow[98:102] == [0.99, 1.05, 1.2, 1.4]
    assert times(scans("scan:dropout@1.05+0.05", "scan:rate=5@1+1"))[98:102] == [0.99, 1.0, 1.2, 1.4]


def test_readings_that_come_together_come_late_pass_freeze_or_change_together() -> None:
    assert times(scans("scan:duplicate=2", "scan:latency=0.02"))[:4] == [0.01, 0.01, 0.02, 0.02]
    assert times(scans("scan:duplicate=2", "scan:rate=1"))[:4] == [0.01, 0.01, 1.0, 1.0]
    assert times(scans("scan:duplicate=2", "scan:freeze"))[:4] == [0.01, 0.01, 0.02, 0.02]
    shifted = times(scans("scan:latency=0.05@0+0.03", "scan:stamp-shift=1"))  # two come with another
    assert sorted(shifted) == [n / 100 for n in range(101, 501)]


def test_late_readings_come_in_order_with_their_own_stamps() -> None:
    late = sent("scan:latency=0.2@1+1")
    arrivals = [
        (one.stamp_ns, s.stamp_ns) for one in late for s in one.samples if isinstance(s, LaserScan)
    ]
    assert len(arrivals) == 400
    assert [stamp for _, stamp in arrivals] == sorted(stamp for _, stamp in arrivals)
    delays = {(then - stamp) / SECOND for then, stamp in arrivals if 1.0 <= stamp / SECOND < 2.0}
    assert delays == {0.2}
    assert {then - stamp for then, stamp in arrivals if not 1.0 <= stamp / SECOND < 2.2} == {0}


def test_lower_rate_leaves_readings_evenly_out_from_the_start_of_the_fault() -> None:
    assert times(scans("scan:rate=5@1+1"))[98:106] == [0.99, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.01]
    assert times(scans("scan:rate=100")) == [n / 100 for n in range(1, 401)], "nothing to leave out"
    assert times(scans("scan:rate=2@1.3+1.2"))[128:134] == [1.29, 1.3, 1.8, 2.3, 2.5, 2.51]
