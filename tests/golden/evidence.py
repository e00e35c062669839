"""What a golden run has left behind, driven every way, and its messages."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mcap.reader import make_reader

from harness.base.message_types import typestore
from harness.cli.options import RunOptions
from harness.page.run.content import render
from rover_metrics.bag.bag_reader import Bag
from rover_metrics.bag.playback import Playback
from rover_metrics.extended.settings import Settings
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.session import MetricsSession
from rover_metrics.topics import ENERGY, SENSORS, TRUTH
from tests.golden.drive import (
    Driven,
    drive_direct,
    drive_through_ros,
    files_below,
    run_options,
)
from tests.golden.table import GoldenRun
from tests.support.pages import without_plotly


@dataclass(frozen=True)
class Message:
    """A recorded message.

    Attributes:
        time_ns: When it went out.
        data: Its bytes.
    """

    topic: str
    type_name: str
    time_ns: int
    data: bytes

    @cached_property
    def content(self) -> Any:  # noqa: ANN401 - rosbags makes its classes
        """Its fields."""
        return typestore().deserialize_cdr(self.data, self.type_name)


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """A golden run, driven every way; each sequence has an entry a rover.

    Attributes:
        options: What was asked for.
        direct: Without ROS.
        recorded: What was recorded then, if there is ROS.
        recording: That file.
        extra: The sensor of a second run, which nobody records.
        with_extra: That run, without ROS; empty where it is not thorough.
        ros: Through ROS 2; empty where it is not installed, and so are the rest.
        messages: What was recorded there, in the order of the file.
        replayed: The logs that the recording gives.
        files: All files of the run through ROS.
        recordings: Of a fleet driven twice through ROS, byte for byte; none where a camera draws or it
            is not thorough.
    """

    run: GoldenRun
    options: RunOptions
    direct: Sequence[Driven]
    extra: str
    with_extra: Sequence[Driven]
    recorded: Sequence[Message] = ()
    recording: Path | None = None
    ros: Sequence[Driven] = ()
    messages: Sequence[Message] = ()
    replayed: Sequence[str] = ()
    files: Sequence[str] = ()
    recordings: Sequence[bytes] = ()

    @cached_property
    def pages(self) -> list[str]:
        """The page of each rover, with the ways of the others, without Plotly's own code."""
        return [
            without_plotly(
                render(
                    own.lasting,
                    own.recorder,
                    {each.name: each.recorder.track for each in self.direct if each is not own},
                )
            )
            for own in self.direct
        ]

    @property
    def namespaces(self) -> list[str]:
        """That of each rover's topics, with its slash; "" for the root."""
        if self.run.ros == "namespace":
            return ["/below"]
        return [f"/{rover.name}" if rover.name else "" for rover in self.options.run.rovers]


def gather(run: GoldenRun, files: dict[str, Path], folder: Path, *, with_ros: bool) -> Evidence:
    """Drives a run every way.

    Args:
        run: A line of the table.
        files: What its words in braces stand for.
        folder: Gets all logs; must be empty.
        with_ros: Whether there is ROS 2.
    """
    bag, live, without_ros = folder / "run.mcap", folder / "ros", folder / "direct.mcap"
    options = run_options(run, files, live)
    carried = {str(sensor) for rover in options.run.rovers for sensor in rover.sensors or ()}
    extra = next(name for name in ("magnetometer", "height_scan", "gnss") if name not in carried)
    for name in ("direct", "extra", "ros", "ros_again"):
        (folder / name).mkdir()
    evidence = Evidence(
        run=run,
        options=options,
        direct=drive_direct(options, folder / "direct", recording=without_ros if with_ros else None),
        extra=extra,
        with_extra=drive_direct(options, folder / "extra", extra) if run.is_thorough else (),
    )
    if not with_ros:
        return evidence
    ros = drive_through_ros(run, options, live, bag)
    logs = zip(evidence.options.settings, evidence.namespaces, strict=True)
    replayed = [replay(bag, *log, folder / "replayed") for log in logs]
    later = {"ros": ros, "messages": list(read(bag)), "replayed": replayed, "files": files_below(live)}
    later["recorded"], later["recording"] = list(read(without_ros)), without_ros
    if run.is_fleet and run.is_thorough and "camera" not in run.sensors:  # drawing takes longest
        once_more = folder / "again.mcap"
        drive_through_ros(run, options, folder / "ros_again", once_more)
        later["recordings"] = [each.read_bytes() for each in (bag, once_more)]
    return Evidence(**vars(evidence) | later)


def read(bag: Path) -> Iterator[Message]:
    """Yields the messages of a recording in the order of the file."""
    with bag.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages(log_time_order=False):
            assert schema is not None
            yield Message(channel.topic, schema.name, message.log_time, message.data)


def replay(bag: Path, settings: Settings, namespace: str, folder: Path) -> str:
    """Returns the log that a recording gives.

    Args:
        bag: The recording.
        settings: Of the metrics.
        namespace: Of the rover's topics, with its slash; "" for the root.
        folder: Gets the log.
    """
    session = MetricsSession(
        settings.thresholds, settings.extended if settings.extended_columns else None
    )
    remaps = {source.name: namespace + source.name for source in (*SENSORS, *TRUTH, *ENERGY)}
    path = folder / (namespace.strip("/") or "root")
    with Bag(bag) as recording, CsvLog(path, None, stem="log", columns=session.columns) as log:
        for row in Playback(recording, session, remaps).rows():
            log.write(row)
    return log.path.read_text()
