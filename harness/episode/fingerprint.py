"""What a run came to, in two hashes: of every sample and truth of its stream, and of its CSV's bytes.

Two runs are the same run if and only if their fingerprints are equal, wherever they took place.
"""

import hashlib
import multiprocessing
import signal
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from harness.base.errors import RunFailed
from harness.base.interrupt import Interrupted, StopRequest
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.result import Drive, Outputs
from harness.samples import Transforms
from harness.spec.ros import RosOptions
from harness.spec.run import Run


@dataclass(frozen=True, slots=True)
class Fingerprint:
    """A finished run in numbers.

    Attributes:
        samples: Sensor readings of the stream.
        lost: Messages that were published but not handled.
        stream: SHA-256 over the stream, hexadecimal; `csv` is that over the file.
    """

    samples: int
    rows: int
    lost: int
    stream: str
    csv: str


class StreamHash:
    """Takes a stream by batches; `samples` counts its sensor readings, of which transforms are none."""

    def __init__(self) -> None:
        self.samples = 0
        self._digest = hashlib.sha256()

    def take(self, batch: Batch) -> None:
        """Takes the next batch: everything in its ticks, its truth and its contact events."""
        for tick in batch.ticks:
            self._digest.update(repr(replace(tick, samples=())).encode())
            for sample in tick.samples:  # repr writes a float out exactly, but not a long array
                if isinstance(sample, Transforms):
                    continue  # only runs through ROS have them, and they follow from the rest
                canonical: object = sample
                values = [getattr(sample, name) for name in sample.__dataclass_fields__]
                if any(isinstance(value, np.ndarray) for value in values):
                    canonical = tuple(v.tobytes() if isinstance(v, np.ndarray) else v for v in values)
                self._digest.update(repr(canonical).encode())
                self.samples += 1
        self._digest.update(repr((batch.truth, batch.events)).encode())

    def hexdigest(self) -> str:
        """Returns the hash of everything taken so far."""
        return self._digest.hexdigest()


def fingerprint(drive: Drive, run: Run, stop: StopRequest, ros_args: Sequence[str] = ()) -> Fingerprint:
    """Returns the fingerprint of a run with one rover, in a folder that is gone afterwards.

    Args:
        drive: `run_direct` or `run_through_ros`.
        run: What is driven.
        stop: Ends it.
        ros_args: From --ros-args on.

    Raises:
        RunFailed: It did not come to its planned end.
        Interrupted: Somebody stopped it.
    """
    stream = StreamHash()
    with TemporaryDirectory(prefix="harness_check_") as folder:
        options = RosOptions(log_dir=Path(folder), ros_args=tuple(ros_args))
        outputs = (Outputs(log_dir=options.log_dir, observers=[stream]),)
        (result,) = drive(run, outputs, options, stop, None, None)
        if stop.signal is not None:
            raise Interrupted(stop.signal)
        if result.failure is not None or result.log_path is None:
            raise RunFailed(result.failure or "the run wrote no log")
        csv = hashlib.sha256(result.log_path.read_bytes()).hexdigest()
    return Fingerprint(stream.samples, result.rows, result.lost, stream.hexdigest(), csv)


def direct_in_fresh_process(run: Run) -> Fingerprint:
    """Returns the fingerprint of a run without ROS in a fresh interpreter; RunFailed if it fails."""
    # The signal is this process's to handle; it then waits for the child, whose run is short.
    pool = ProcessPoolExecutor(
        max_workers=1,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    )
    with pool:
        try:
            return pool.submit(fingerprint, run_direct, run, StopRequest()).result()
        except BrokenProcessPool as error:
            raise RunFailed("the fresh process died") from error
