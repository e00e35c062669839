"""Whatever differs between two streams shows in their hashes."""

import hashlib
import signal
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from harness.base.errors import RunFailed
from harness.base.interrupt import Interrupted, StopRequest
from harness.episode.batch import Batch
from harness.episode.fingerprint import Fingerprint, StreamHash, fingerprint
from harness.episode.result import Outputs, RunResult, TopicCount
from harness.samples import ContactEvent, LaserScan, Pose, Tick, Truth
from harness.spec.ros import RosOptions
from harness.spec.run import Run

SCAN = LaserScan(5, np.array([1.0, np.inf, 2.0], dtype=np.float32))
POSE = Pose(5, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
TICK = Tick(5, (SCAN, POSE))
EVENT = ContactEvent("rock", 0, 5, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))
BATCH = Batch((TICK,), Truth(time_ns=5), (EVENT,))


def digest(*batches: Batch) -> str:
    stream = StreamHash()
    for batch in batches:
        stream.take(batch)
    return stream.hexdigest()


def of_tick(**changes: object) -> Batch:
    return replace(BATCH, ticks=(replace(TICK, **changes),))  # type: ignore[arg-type]  # a table


@pytest.mark.parametrize(
    "other",
    [
        of_tick(stamp_ns=6),
        of_tick(tells_time=False),
        of_tick(samples=(POSE, SCAN)),
        of_tick(samples=(replace(SCAN, stamp_ns=6), POSE)),
        of_tick(samples=(replace(SCAN, ranges=SCAN.ranges[:2]), POSE)),
        of_tick(samples=(replace(SCAN, ranges=np.nextafter(SCAN.ranges, np.float32(0.0))), POSE)),
        of_tick(samples=(SCAN, replace(POSE, position=(1.0, 2.0, np.nextafter(3.0, 4.0))))),
        replace(BATCH, truth=Truth(time_ns=5, largest_tilt=1e-300)),
        replace(BATCH, events=()),
        replace(BATCH, ticks=(TICK, TICK)),
    ],
)
def test_every_bit_of_a_batch_counts(other: Batch) -> None:
    assert digest(other) != digest(BATCH)
    assert digest(BATCH, other) != digest(BATCH, BATCH)


def test_equal_streams_have_equal_hashes_and_counts() -> None:
    copied = replace(SCAN, ranges=SCAN.ranges.copy())
    assert digest(of_tick(samples=(copied, POSE)), BATCH) == digest(BATCH, BATCH)
    stream = StreamHash()
    stream.take(replace(BATCH, ticks=(TICK, TICK)))
    stream.take(BATCH)
    assert stream.samples == 6


def drive(_: Run, outputs: Sequence[Outputs], options: RosOptions, *__: Any, **changes: Any) -> Any:  # noqa: ANN401
    """A run of one batch that wrote a log of two rows."""
    for observer in outputs[0].observers:
        observer.take(BATCH)
    log = options.log_dir / "log.csv"
    log.write_bytes(b"a,b\r\n1,2\r\n")
    topics = {"/scan": TopicCount(4, 1, 3)}
    values: dict[str, Any] = {"log_path": log, "rows": 2, "topics": topics} | changes
    return (RunResult(run=Run(), mode="", **values),)


def test_a_fingerprint_is_that_of_the_stream_and_of_the_logs_bytes() -> None:
    csv = hashlib.sha256(b"a,b\r\n1,2\r\n").hexdigest()
    expected = Fingerprint(samples=2, rows=2, lost=3, stream=digest(BATCH), csv=csv)
    assert fingerprint(drive, Run(), StopRequest()) == expected


def test_a_run_that_failed_wrote_nothing_or_was_stopped_has_none() -> None:
    failing, silent = partial(drive, failure="it fell off"), partial(drive, log_path=None)
    with pytest.raises(RunFailed, match="it fell off"):
        fingerprint(failing, Run(), StopRequest())
    with pytest.raises(RunFailed, match="the run wrote no log"):
        fingerprint(silent, Run(), StopRequest())
    stop = StopRequest()
    stop.signal = signal.SIGINT
    with pytest.raises(Interrupted, match="SIGINT"):
        fingerprint(drive, Run(), stop)
