"""Recordings of every kind, whole and damaged, through the command replay. No ROS."""

import csv
import json
import os
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pytest
import zstandard
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.interfaces import Nodetype
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.typesys import Stores, get_typestore

from rover_metrics.bag.bag_reader import Bag
from rover_metrics.core.columns import Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.replay import main
from rover_metrics.topics import SENSORS, TRUTH
from tests.support.complaint import complaint

NANOSECONDS = 1_000_000_000
REAL_BAG = Path(__file__).parents[3] / "shared/data/roboterrain/bags/rover_trajectory"
STORE = get_typestore(Stores.LATEST)
CLOCK = "/clock"
TYPES = {source.name: source.message_type for source in SENSORS} | {CLOCK: "rosgraph_msgs/msg/Clock"}

Capsys = pytest.CaptureFixture[str]
Recorded = tuple[str, int, bytes]  # topic, recorded time [ns], CDR


def blank(kind: str) -> Any:  # noqa: ANN401 - a message of any type
    """A message of zeros and empty lists."""
    values: dict[str, Any] = {}
    fields: Any = STORE.fielddefs[kind][1]
    for name, (node, of) in fields:
        if node is Nodetype.NAME:
            values[name] = blank(of)
        elif node is Nodetype.BASE:
            values[name] = "" if of[0] == "string" else 0
        else:
            values[name] = np.zeros(of[1], of[0][1][0]) if of[0][0] is Nodetype.BASE else []
    return STORE.types[kind](**values)


def fill(message: Any, **values: object) -> Any:  # noqa: ANN401
    """The same message with some of its fields set."""
    for name, value in values.items():
        setattr(message, name, value)
    return message


def stamped(kind: str, stamp_ns: int) -> Any:  # noqa: ANN401
    message = blank(kind)
    time = message.header.stamp if hasattr(message, "header") else message.clock
    time.sec, time.nanosec = divmod(stamp_ns, NANOSECONDS)
    return message


def cdr(message: Any) -> bytes:  # noqa: ANN401
    return bytes(STORE.serialize_cdr(message, message.__msgtype__))


def recorded(topic: str, stamp_ns: int, value: float = 0.0) -> bytes:
    """A message of a topic, the value in the field of which its metric is made."""
    message = stamped(TYPES[topic], stamp_ns)
    if topic == "/scan":
        ranges = np.array([np.inf, value, 9.0], dtype=np.float32)
        fill(message, range_min=0.1, range_max=10.0, ranges=ranges)
    elif topic == "/imu/data":
        fill(message.linear_acceleration, x=0.3, y=-3.0, z=value)
        fill(message.angular_velocity, x=0.1, y=-0.2, z=0.3)
    elif topic == "/rover/pose_array":
        message.poses = [blank("geometry_msgs/msg/Pose") for _ in range(2)]
        fill(message.poses[0].position, x=value, y=-value, z=value / 3)
        fill(message.poses[1].position, x=9.0)
    elif topic == "/odometry/wheels":
        fill(message.twist.twist.linear, x=value, y=0.1, z=-0.2)
        fill(message.twist.twist.angular, x=5.0)
    return cdr(message)


def drive(seconds: float = 4.5, offset_s: float = 0.0, *, clock: bool = True) -> list[Recorded]:
    """A drive at 10 Hz whose recorder's clock is ahead of the stamps by an offset."""
    ahead = round(offset_s * NANOSECONDS)
    return [(topic, t + ahead, data) for topic, t, data in driven(seconds) if clock or topic != CLOCK]


@cache
def driven(seconds: float) -> list[Recorded]:
    messages: list[Recorded] = []
    for tick in range(1, round(seconds * 10) + 1):
        t = tick * NANOSECONDS // 10
        values = (0.1 + tick / 50, 9.8 + tick % 7, tick / 10, 1 + tick / 100, 0.0)
        messages += [(topic, t, recorded(topic, t, v)) for topic, v in zip(TYPES, values, strict=True)]
    return messages


def expected_rows(seconds: int = 4) -> list[Row]:
    """The rows of `drive`, computed without messages."""
    metrics, rows = TraversalMetrics(), []
    for tick in range(1, seconds * 10 + 1):
        metrics.add_scan(np.array([np.inf, 0.1 + tick / 50, 9.0], dtype=np.float32))
        metrics.add_imu((0.3, -3.0, 9.8 + tick % 7), (0.1, -0.2, 0.3))
        metrics.add_pose((tick / 10, -tick / 10, tick / 30))
        metrics.add_odometry((1 + tick / 100, 0.1, -0.2))
        if tick % 10 == 0:
            rows.append(metrics.row(tick // 10))
    return rows


def write_folder(
    path: Path,
    messages: list[Recorded],
    *,
    storage: StoragePlugin = StoragePlugin.SQLITE3,
    compression: CompressionMode = CompressionMode.NONE,
    types: dict[str, str] = TYPES,
    silent: tuple[str, ...] = (),
) -> Path:
    """A recording as rosbag2 leaves it, which also lists topics that were silent."""
    writer = Rosbag2Writer(path, version=8, storage_plugin=storage)
    if compression is not CompressionMode.NONE:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        topics = dict.fromkeys([*(topic for topic, _, _ in messages), *silent])
        connections = {t: writer.add_connection(t, types[t], typestore=STORE) for t in topics}
        for topic, time_ns, data in messages:
            writer.write(connections[topic], time_ns, data)
    return path


def write_mcap(
    path: Path,
    messages: list[Recorded],
    encoding: str = "cdr",
    types: dict[str, str] = TYPES,
    chunk_size: int = 1000,
    compression: CompressionType = CompressionType.NONE,
) -> Path:
    """A bare file of many uncompressed chunks, about one per tenth of a second, unless it is told."""
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=chunk_size, compression=compression)
        writer.start(profile="ros2")
        channels = {}
        for topic in dict.fromkeys(topic for topic, _, _ in messages):
            schema = writer.register_schema(types[topic], "ros2msg", b"")
            channels[topic] = writer.register_channel(topic, encoding, schema)
        for topic, time_ns, data in messages:
            writer.add_message(channels[topic], time_ns, data, publish_time=1)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap half types itself
    return path


def replay(bag: Path, *words: str, code: int = 0) -> list[list[str]]:
    """Runs the command, which must end with that code; gives the cells of its rows."""
    output = bag.parent / "out" / "rows.csv"
    assert main([str(bag), "-o", str(output), "--overwrite", *words]) == code
    with output.open(newline="") as file:
        return list(csv.reader(file))[1:]


def cells(rows: list[Row]) -> list[list[str]]:
    return [[str(cell) for cell in row.as_fields()] for row in rows]


@pytest.mark.skipif(not REAL_BAG.exists(), reason="needs ../shared/data")
def test_real_bag_gives_its_path_length_and_names_its_gaps(tmp_path: Path, capsys: Capsys) -> None:
    output = tmp_path / "rows.csv"
    assert main([str(REAL_BAG), "-o", str(output)]) == 0
    with output.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[-1]["Distance Traveled"]) == pytest.approx(30.5, abs=0.05)
    assert [int(row["Timestamp"]) for row in rows] == list(range(1735179281, 1735179357))
    told = capsys.readouterr().err.splitlines()
    expected = ["/scan", "/imu/data", "/odometry/wheels"]
    assert [line.split()[1:3] for line in told] == [["warning:", topic] for topic in expected]


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize(
    "compression", [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE]
)
def test_every_kind_of_folder_gives_its_rows(
    tmp_path: Path, storage: StoragePlugin, compression: CompressionMode
) -> None:
    bag = write_folder(tmp_path / "bag", drive(), storage=storage, compression=compression)
    metadata = bag / "metadata.yaml"
    told = metadata.read_text()
    assert "compression_mode: message" in told or compression is not CompressionMode.MESSAGE
    metadata.write_text(told.replace("mode: message", "mode: MESSAGE"))  # as rosbag2 itself writes it
    assert replay(bag) == cells(expected_rows())
    (file,) = set(bag.iterdir()) - {metadata}  # bare it is a recording too
    assert replay(file) == cells(expected_rows())


def test_files_are_read_in_the_order_of_their_numbers(tmp_path: Path, capsys: Capsys) -> None:
    messages = drive(12.0)
    bag = tmp_path / "bag"
    bag.mkdir()
    for number in range(12):
        write_mcap(bag / f"bag_{number}.mcap", messages[number * 50 : number * 50 + 50])
    assert replay(bag, code=1) == cells(expected_rows(12))
    assert "no metadata.yaml (a killed recording?)" in capsys.readouterr().err


def test_rows_follow_clock_recorded_or_header_time(tmp_path: Path, capsys: Capsys) -> None:
    plain = cells(expected_rows())
    bag = write_mcap(tmp_path / "bag.mcap", drive(4.0, offset_s=1e9))  # ends with a full second
    for time, row in (("auto", plain[0][0]), ("header", plain[0][0]), ("recorded", "1000000001")):
        rows = replay(bag, "--time", time)
        assert (rows[0][0], [row[1:] for row in rows]) == (row, [row[1:] for row in plain])
    capsys.readouterr()
    bag = write_mcap(tmp_path / "bag.mcap", drive(offset_s=1e9, clock=False))
    assert replay(bag)[0][0] == "1000000001"
    assert "--time header follows them" in capsys.readouterr().err
    assert replay(bag, "--time", "header") == plain
    assert capsys.readouterr().err == ""
    told = complaint(main, [str(bag), "--time", "sim"], capsys)
    assert "--time sim needs /clock, but /clock is missing" in told


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_silent_topic_is_missing(tmp_path: Path, storage: StoragePlugin, capsys: Capsys) -> None:
    messages = [m for m in drive(offset_s=1e9, clock=False) if m[0] != "/scan"]
    bag = write_folder(tmp_path / "bag", messages, storage=storage, silent=("/scan", CLOCK))
    assert [row[0] for row in replay(bag)] == [str(1_000_000_000 + n) for n in range(1, 5)]
    assert "/scan is missing" in capsys.readouterr().err
    for file in bag.glob("*.mcap"):  # cut off before its end, as by a kill: its channels are scanned
        file.write_bytes(file.read_bytes()[:-8])
        assert [row[0] for row in replay(file, code=1)] == [str(1_000_000_000 + n) for n in range(1, 5)]
        assert "/scan is missing" in capsys.readouterr().err


def test_a_clock_that_is_no_time_is_left_out(tmp_path: Path, capsys: Capsys) -> None:
    messages = drive()
    for sec, nanosec in ((-1, 0), (-(2**31), 7), (2, 10**9)):
        message = blank(TYPES[CLOCK])
        fill(message.clock, sec=sec, nanosec=nanosec)
        messages.insert(70, (CLOCK, messages[70][1], cdr(message)))
    assert replay(write_mcap(tmp_path / "bag.mcap", messages)) == cells(expected_rows())
    assert "/clock: 3 messages are empty, not finite or impossible, left out" in capsys.readouterr().err


def test_missing_topics_are_named_and_others_go_on(tmp_path: Path, capsys: Capsys) -> None:
    clocks = [("/scan", t, data) for topic, t, data in drive() if topic == CLOCK]  # in their place
    messages = [m for m in drive() if m[0] not in {"/scan", "/imu/data"}]
    bag = write_folder(tmp_path / "bag", messages + clocks, types=TYPES | {"/scan": TYPES[CLOCK]})
    rows = replay(bag)
    assert [row[6:8] for row in rows] == [row[6:8] for row in cells(expected_rows())]
    assert capsys.readouterr().err.splitlines() == [
        f"replay: warning: {reason}; name another with --remap"
        for reason in (
            "/scan is rosgraph_msgs/msg/Clock, not sensor_msgs/msg/LaserScan",
            "/imu/data is missing",
        )
    ]
    assert replay(bag, "--require-all", code=1) == rows
    assert replay(write_mcap(tmp_path / "whole.mcap", drive()), "--require-all") != rows


def test_a_topic_that_another_node_would_make_is_told(tmp_path: Path, capsys: Capsys) -> None:
    kind = "sensor_msgs/msg/PointCloud2"
    messages = [message for message in drive() if message[0] != "/scan"]
    messages.append(("/points", messages[-1][1], cdr(blank(kind))))
    replay(write_folder(tmp_path / "bag", messages, types=TYPES | {"/points": kind}))
    assert "(pointcloud_to_laserscan makes one of /points)" in capsys.readouterr().err


def test_remapped_topics_are_read_as_recorded(tmp_path: Path, capsys: Capsys) -> None:
    messages = [(f"/rover1{topic}", t, data) for topic, t, data in drive()]
    types = {f"/rover1{topic}": kind for topic, kind in TYPES.items()}
    bag = write_folder(tmp_path / "bag", messages, types=types)
    names = ["scan", "imu/data", "/rover/pose_array", "odometry/wheels", "/clock"]
    words = [w for name in names for w in ("--remap", f"{name}:=rover1/{name.lstrip('/')}")]
    assert replay(bag, *words) == cells(expected_rows())
    told = complaint(main, [str(bag)], capsys)
    assert "no topic to replay" in told
    assert "/scan is missing (/rover1/scan would do)" in told


def test_topics_of_programs_that_leave_out_the_first_slash_are_read(tmp_path: Path) -> None:
    messages = [(topic.lstrip("/"), t, data) for topic, t, data in drive()]
    types = {topic.lstrip("/"): kind for topic, kind in TYPES.items()}
    for storage in StoragePlugin:
        bag = write_folder(tmp_path / storage.name, messages, types=types, storage=storage)
        assert replay(bag) == cells(expected_rows())
        for file in bag.glob("*.mcap"):  # cut off before its end, as by a kill
            file.write_bytes(file.read_bytes()[:-8])
            assert replay(file, code=1) == cells(expected_rows())


def test_one_odometry_gives_poses_and_speeds(tmp_path: Path) -> None:
    messages = []
    for topic, time_ns, data in drive():
        message = STORE.deserialize_cdr(data, TYPES[topic])
        if topic == "/odometry/wheels":
            value = round(time_ns * 10 / NANOSECONDS) / 10
            fill(message.pose.pose.position, x=value, y=-value, z=value / 3)  # type: ignore[attr-defined]  # as below
        if topic != "/rover/pose_array":
            messages.append((topic, time_ns, cdr(message)))
    bag = write_folder(tmp_path / "bag", messages)
    assert replay(bag, "--remap", "rover/pose_array:=odometry/wheels") == cells(expected_rows())


@pytest.mark.parametrize("storage", StoragePlugin)
def test_messages_that_were_shuffled_are_played_in_the_order_of_their_times(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    messages = sorted(drive(), key=lambda message: message[1] + crc32(message[2]) % 10**9)
    assert replay(write_folder(tmp_path / "bag", messages, storage=storage)) == cells(expected_rows())


def test_topics_in_files_of_their_own_are_played_together(tmp_path: Path) -> None:
    for number, topic in enumerate(reversed(TYPES)):
        write_mcap(tmp_path / f"{number}.mcap", [message for message in drive() if message[0] == topic])
    assert replay(tmp_path, code=1) == cells(expected_rows())  # 1: there is no metadata.yaml


@pytest.mark.parametrize(
    ("topic", "value", "told"),
    [
        ("/scan", 0.0, "/scan: 45 messages: range of zero or less, taken as a reading; if 0"),
        ("/scan", 1.0, "/scan: 45 messages: angles of more than a turn"),
        ("/imu/data", 1e-3, "look like g"),
        ("/odometry/wheels", 0.0, "the speeds of /odometry/wheels"),
    ],
)
def test_samples_that_count_but_cannot_be_meant_so_are_told(
    tmp_path: Path, capsys: Capsys, topic: str, value: float, told: str
) -> None:
    def changed(data: bytes) -> bytes:
        message = STORE.deserialize_cdr(data, TYPES[topic])
        if topic == "/imu/data":
            fill(message.linear_acceleration, x=0.0, y=0.0, z=1.0)  # type: ignore[attr-defined]  # as below
        elif value:
            fill(message, angle_increment=3.0)
        stamp = message.header.stamp  # type: ignore[attr-defined]  # as below
        return cdr(message) if value else recorded(topic, stamp.sec * NANOSECONDS + stamp.nanosec)

    messages = [(t, time, changed(data) if t == topic else data) for t, time, data in drive()]
    replay(write_mcap(tmp_path / "bag.mcap", messages))
    assert told in capsys.readouterr().err


def test_stamps_that_are_missing_or_stand_still_are_told_and_make_no_numbers(
    tmp_path: Path, capsys: Capsys
) -> None:
    columns = ("Roughness RMS [m/s^2]", "Collision Events")

    def of(name: str, messages: list[Recorded]) -> list[tuple[str, ...]]:
        write_mcap(tmp_path / f"{name}.mcap", messages)
        rows = tmp_path / f"{name}.csv"
        assert main([str(tmp_path / f"{name}.mcap"), "-o", str(rows), "--extended"]) == 0
        with rows.open(newline="") as lines:
            return [tuple(row[column] for column in columns) for row in csv.DictReader(lines)]

    whole = drive(clock=False)
    assert all(of("whole", whole)[-1])
    assert "stamp" not in capsys.readouterr().err
    assert of("twice", [m for m in whole for _ in "ab"]) == of("again", whole)
    assert "/imu/data: 45 messages: stamp stands still" in capsys.readouterr().err
    unset = [(t, at, recorded(t, 0, 0.1 if t == "/scan" else 9.8)) for t, at, _ in whole]
    assert set(of("unset", unset)) == {("", "")}
    told = capsys.readouterr().err
    assert "/imu/data: 45 messages: no stamp" in told
    assert "the speeds of" not in told


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_recording_written_topic_by_topic_is_played_in_the_order_of_its_times(
    tmp_path: Path, storage: StoragePlugin, capsys: Capsys
) -> None:
    """As programs write them that make a bag of tables; what is wrong with it is told once."""
    messages = sorted(drive(offset_s=1e9, clock=False), key=lambda message: message[0])
    rows = replay(bag := write_folder(tmp_path / "bag", messages, storage=storage))
    assert [row[1:] for row in rows] == [row[1:] for row in cells(expected_rows())]
    (file,) = (path for path in bag.iterdir() if path.suffix != ".yaml")
    cut_off(file)
    capsys.readouterr()
    replay(file, code=1)
    told = capsys.readouterr().err.splitlines()
    assert sorted(told) == sorted({*told})


@pytest.mark.parametrize(
    "kind",
    [
        "geometry_msgs/msg/PoseStamped",
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        "nav_msgs/msg/Odometry",
    ],
)
def test_poses_of_a_real_rover_are_no_arrays(tmp_path: Path, kind: str) -> None:
    messages = []
    for topic, time_ns, data in drive():
        if topic == "/rover/pose_array":
            (pose, _), message = STORE.deserialize_cdr(data, TYPES[topic]).poses, stamped(kind, time_ns)  # type: ignore[attr-defined]  # rosbags' classes have no types
            of = message if isinstance(message.pose, type(pose)) else message.pose
            of.pose = pose
            topic, data = "/where", cdr(message)  # noqa: PLW2901 - another message in its place
        messages.append((topic, time_ns, data))
    bag = write_folder(tmp_path / "bag", messages, types=TYPES | {"/where": kind})
    assert replay(bag, "--remap", "rover/pose_array:=where") == cells(expected_rows())


def test_a_recording_without_the_time_that_is_asked_for_says_so(tmp_path: Path, capsys: Capsys) -> None:
    messages = [(topic, t, recorded(topic, 0)) for topic, t, _ in drive()]
    assert replay(write_mcap(tmp_path / "bag.mcap", messages), "--time", "header") == []
    assert "no full second of header time" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--remap", "camera:=front"], "FROM is one of scan, imu/data"),
        (["--remap", "scan"], "give FROM:=TO"),
        (["--time", "wall"], "invalid choice: 'wall'"),
        (["--params", "/nowhere.yaml"], "/nowhere.yaml: No such file or directory"),
        (["-o", "/proc/rows.csv"], "cannot create a log in /proc"),
        (["-o", "-"], "'-' is not valid"),
    ],
)
def test_a_bad_argument_is_one_line(
    tmp_path: Path, capsys: Capsys, words: list[str], expected: str
) -> None:
    bag = write_mcap(tmp_path / "bag.mcap", drive(1.0))
    assert expected in complaint(main, [str(bag), *words], capsys)


def test_existing_file_is_replaced_only_on_request(tmp_path: Path, capsys: Capsys) -> None:
    bag = write_mcap(tmp_path / "bag.mcap", drive())
    output = tmp_path / "rows.csv"
    output.write_text("precious")
    told = complaint(main, [str(bag), "-o", str(output)], capsys)
    assert "rows.csv exists already, not overwriting" in told
    assert output.read_text() == "precious"
    assert main([str(bag), "-o", str(output), "--overwrite"]) == 0
    assert output.read_text().startswith("Timestamp,")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bag.mcap", "rows.csv"]
    os.mkfifo(pipe := tmp_path / "a.csv")
    for wrong, told in ((bag, "is the recording itself"), (pipe, "is no file; name another")):
        assert told in complaint(main, [str(bag), "-o", str(wrong), "--overwrite"], capsys)
    assert pipe.is_fifo()


@pytest.mark.parametrize("seconds", [4.5, 0.5])
def test_what_came_of_it_is_a_page_and_json_too(seconds: float, tmp_path: Path) -> None:
    bag = write_mcap(tmp_path / "bag.mcap", drive(seconds))
    page, told = tmp_path / "a.html", tmp_path / "a.json"
    rows = replay(bag, "--page", str(page), "--json", str(told))
    said = json.loads(told.read_text())
    assert (said["rows"], said["topics"]["/scan"]["used"]) == (len(rows), round(seconds * 10))
    assert ("<svg" in page.read_text()) == bool(rows)
    assert "/imu/data" in page.read_text()


def test_without_a_name_the_log_goes_where_the_nodes_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bag = write_mcap(tmp_path / "bag.mcap", drive())
    assert main([str(bag)]) == main([str(bag)]) == 0
    logs = list(tmp_path.glob("metrics_analyzer/data/metric_logs/metrics_log_*.csv"))
    assert len(logs) == 2


def cut_off(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 6 // 10])


def damage_the_middle(file: Path) -> None:
    data = bytearray(file.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 40] = b"\xa5" * 40
    file.write_bytes(data)


def damage_a_page(file: Path) -> None:
    data = bytearray(file.read_bytes())
    page = 4096 * round(len(data) // 4096 * 0.5)
    data[page : page + 4096] = b"\xa5" * 4096
    file.write_bytes(data)


@pytest.mark.parametrize(
    ("name", "damage", "told", "kept_rows"),
    [
        ("bag.mcap", cut_off, "has no end", range(5, 7)),
        ("bag.mcap", damage_the_middle, "damaged", range(4, 10)),
        ("bag.db3", cut_off, "messages were lost", range(4, 7)),
        ("bag.db3", damage_a_page, "messages were lost in 1 place(s)", range(9, 10)),
    ],
)
def test_damaged_recording_keeps_what_can_be_read(
    tmp_path: Path,
    capsys: Capsys,
    name: str,
    damage: Callable[[Path], None],
    told: str,
    kept_rows: range,
) -> None:
    if name == "bag.mcap":
        file = write_mcap(tmp_path / name, drive(9.5))
    else:
        file = write_folder(tmp_path / "bag", drive(9.5)) / name
    whole = replay(file)
    damage(file)
    rows = replay(file, code=1)
    assert len(rows) in kept_rows
    assert rows[:3] == whole[:3]
    assert told in capsys.readouterr().err


def test_a_database_cut_off_within_a_page_has_an_end(tmp_path: Path) -> None:
    """The page reads as rows with the number 0, after which the ones before came again, for ever."""
    file = tmp_path / "bag.db3"
    with closing(sqlite3.connect(file)) as database:
        database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT)")
        database.execute("INSERT INTO topics VALUES(1, '/a', 'b/msg/C')")
        columns = "id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB"
        database.execute(f"CREATE TABLE messages({columns})")
        rows = ((1, time_ns, bytes(700)) for time_ns in range(400))
        database.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", rows)
        database.commit()
    file.write_bytes(file.read_bytes()[: 8 * 4096 + 700])
    with Bag(file) as bag:
        times = [message.time_ns for message in islice(bag.messages({"/a"}), 1000)]
        assert times == sorted(times)
        assert 0 < len(times) < 400
        assert "is damaged" in bag.problems[0]


@pytest.mark.parametrize("packed", [CompressionType.NONE, CompressionType.ZSTD])
def test_a_recording_cut_off_in_its_only_chunk_keeps_the_rows_before(
    tmp_path: Path, capsys: Capsys, packed: CompressionType
) -> None:
    file = write_mcap(tmp_path / "bag.mcap", drive(90.5), chunk_size=2**24, compression=packed)
    whole = replay(file)
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 3 // 10])  # behind it: its index
    rows = replay(file, code=1)
    assert len(rows) > 20
    assert rows == whole[: len(rows)]
    assert "has no end" in capsys.readouterr().err


def test_a_recording_without_a_whole_message_is_said_to_be_cut_off(
    tmp_path: Path, capsys: Capsys
) -> None:
    file = write_mcap(tmp_path / "bag.mcap", drive(90.5), chunk_size=2**24)
    file.write_bytes(file.read_bytes()[:200])
    told = complaint(main, [str(file), "-o", str(tmp_path / "rows.csv")], capsys)
    assert "before its first message" in told
    assert "mcap recover" in told
    assert "was read" not in told


def test_bad_messages_and_files_are_left_out(tmp_path: Path, capsys: Capsys) -> None:
    messages, bag = drive(), tmp_path / "bag"
    messages[1] = ("/imu/data", messages[1][1], b"\x00\x01\x00\x00garbage")
    messages[6] = ("/imu/data", messages[6][1], recorded("/imu/data", messages[6][1], float("nan")))
    bag.mkdir()
    write_mcap(bag / "bag_0.mcap", messages)
    (bag / "bag_1.mcap").touch()
    (bag / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n"
        "  relative_file_paths: [bag_0.mcap, ../../bag_1.mcap, bag_2.mcap]\n"
    )
    rows = replay(bag, code=1)
    assert [row[6:8] for row in rows] == [row[6:8] for row in cells(expected_rows())]
    told = capsys.readouterr().err.splitlines()
    assert [line.partition(", left out")[0] for line in told] == [
        "replay: warning: /imu/data: 1 messages are empty, not finite or impossible",
        "replay: bag_2.mcap is missing from the bag",
        "replay: bag_1.mcap: the file is empty; left out",
        "replay: /imu/data: 1 messages are not readable",
    ]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "the file is empty"),
        (b"Timestamp,Total Collisions\r\n", "neither MCAP nor sqlite3"),
        (b"#ROSBAG V2.0\n", "rosbags-convert"),
        (b"\x1f\x8b\x08", "packed by gzip; unpack it first"),
        (b"SQLite format 3\0 and no more", "not readable as a rosbag2 database"),
        (b"\x89MCAP0\r\n", "ends before its first message"),
    ],
)
def test_file_that_is_no_recording_is_refused(
    tmp_path: Path, capsys: Capsys, content: bytes, expected: str
) -> None:
    file = tmp_path / "bag.mcap"
    file.write_bytes(content)
    assert expected in complaint(main, [str(file), "-o", str(tmp_path / "rows.csv")], capsys)
    assert list(tmp_path.iterdir()) == [file]


def test_place_without_a_recording_is_refused(tmp_path: Path, capsys: Capsys) -> None:
    assert "does not exist" in complaint(main, [str(tmp_path / "nothing")], capsys)
    assert complaint(main, [str(tmp_path)], capsys).endswith("holds no .mcap and no .db3 file\n")
    for name in ("a", "b", "deep/down", "empty"):
        (tmp_path / "runs" / name).mkdir(parents=True)
    for name in ("a/a.mcap", "b/b.db3", "deep/down/no.mcap"):
        (tmp_path / "runs" / name).touch()
    assert complaint(main, [str(tmp_path / "runs")], capsys).endswith("; bags in it: a, b\n")
    bag = write_mcap(tmp_path / "bag.mcap", drive(1.0), encoding="json")
    assert "/scan is json-encoded" in complaint(main, [str(bag)], capsys)


def test_a_packed_recording_is_unpacked_within_a_bound(
    tmp_path: Path, capsys: Capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = write_mcap(tmp_path / "bag.mcap", drive(1.0)).read_bytes()
    packed = tmp_path / "packed.mcap.zstd"
    packed.write_bytes(zstandard.ZstdCompressor().compress(plain))
    assert main([str(packed), "-o", str(tmp_path / "a.csv")]) == 0
    capsys.readouterr()
    monkeypatch.setattr("rover_metrics.bag.bag_reader.LARGEST_UNPACKED", len(plain) - 1)
    assert "unpack it where there is room" in complaint(main, [str(packed)], capsys)


def test_without_its_libraries_replay_says_so_in_one_line_and_exits_2() -> None:
    script = "import sys; sys.modules['mcap'] = None; import rover_metrics.replay"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert run.stderr.startswith("replay needs two libraries: pip install rosbags mcap (")
    assert run.stderr.count("\n") == 1


def test_parameters_and_truth_give_the_extended_columns(tmp_path: Path, capsys: Capsys) -> None:
    contact, truth = "/rover/truth/contact", "/rover1/odom_ground_truth"
    types = TYPES | {contact: "std_msgs/msg/Bool", truth: TYPES["/odometry/wheels"]}
    messages = drive()
    last = messages[-1][1]
    messages += [(contact, last, cdr(fill(blank("std_msgs/msg/Bool"), data=True)))] * 2
    messages += [
        (truth, last, recorded("/odometry/wheels", last, speed)) for speed in (0.2, float("nan"))
    ]
    bag = write_folder(tmp_path / "bag", messages, types=types)
    file, output = tmp_path / "params.yaml", tmp_path / "rows.csv"
    file.write_text(
        "rover1/metrics_node:\n  ros__parameters:\n"
        "    extended_columns: true\n"
        "    distance_threshold: 0.01\n"
        "    lidar_pose: [0.1, 0.0, 0.0]\n"
        "    footprint: [-0.2, -0.2, 0.0, -0.2, 0.0, 0.2, -0.2, 0.2]\n"
        "    footprint_threshold: 0.35\n"
    )
    words = [str(bag), "-o", str(output), "--time", "header", "--remap", f"odom_ground_truth:={truth}"]
    assert main([*words, "--params", str(file)]) == 0
    with output.open(newline="") as rows:
        first, *_, final = csv.DictReader(rows)
    assert list(first) == list(EXTENDED_HEADER)
    assert first["Footprint Clearance [m]"] == "0.22"  # 0.12 m ahead of a lidar 0.1 m ahead of it
    assert (first["Footprint Collisions"], final["Footprint Collisions"]) == ("7", "7")
    assert (final["Odometry Rate [Hz]"], final["Distance Traveled"]) == ("10.0", "0.0")
    told = capsys.readouterr()
    sensors = ("/imu/data", "/odometry/wheels", "/rover/pose_array")
    counts = [*((topic, "45") for topic in sensors), (contact, "2"), (truth, "1"), ("/scan", "45")]
    assert [line.split() for line in told.out.splitlines()] == [
        ["rows", "follow", "header", "time"],
        *([topic, count, "messages"] for topic, count in counts),
        ["0.00", "m", "travelled,", "4", "collisions"],
        f"4 rows in {output}".split(),
    ]
    left_out = f"{truth}: 1 messages are empty, not finite or impossible, left out"
    assert f"replay: warning: {left_out}\n" in told.err
    assert "/rover/pose_array: 44 messages: step of distance_threshold or more" in told.err
    assert main([*words, "--extended", "--overwrite", "--require-all"]) == 1
    assert output.read_text().startswith(",".join(EXTENDED_HEADER))


def test_every_type_exists_and_has_a_header_where_the_table_says_so() -> None:
    for source in (*SENSORS, *TRUTH):
        assert ("header" in STORE.types[source.message_type].__annotations__) is source.has_stamp


@pytest.mark.parametrize(("ahead", "other"), [(86400.0, 0), (86400.5, 1), (-86400.0, 0), (-86400.5, 1)])
def test_stamps_over_a_day_off_are_of_another_clock(
    tmp_path: Path, capsys: Capsys, ahead: float, other: int
) -> None:
    late = 500_000 * NANOSECONDS
    at = late - round(ahead * NANOSECONDS)
    messages = [("/imu/data", at, recorded("/imu/data", stamp, 9.8)) for stamp in (0, late, late)]
    bag = write_mcap(tmp_path / "bag.mcap", messages)
    for time, notes in (("recorded", other), ("header", 0)):
        replay(bag, "--time", time)
        told = capsys.readouterr()
        assert told.err.count("note: header stamps (500000.00 s) are of another clock") == notes
        assert "/imu/data                   3 messages" in told.out


def test_of_many_jumps_five_are_told_and_types_may_lack_msg(tmp_path: Path, capsys: Capsys) -> None:
    seconds = [1, 2, 100, 1, 100, 1, 100, 1]
    messages = [("/imu/data", t * NANOSECONDS, recorded("/imu/data", 0, 9.8)) for t in seconds]
    older = {topic: kind.replace("/msg/", "/") for topic, kind in TYPES.items()}
    for count, more in ((7, 0), (8, 1)):
        replay(write_mcap(tmp_path / "bag.mcap", messages[:count], types=older))
        notes = [line for line in capsys.readouterr().err.splitlines() if " jumps " in line]
        assert notes[0] == "replay: note: time jumps from 2.00 s to 100.00 s"
        assert notes[5:] == ["replay: note: 1 more jumps of time"] * more
    with Bag(tmp_path / "bag.mcap") as bag:  # as every reader of bags has them
        assert bag.topics == {"/imu/data": TYPES["/imu/data"]}


NOT_READABLE = Path("/proc/self/mem")  # whose first byte is an EIO


@pytest.mark.parametrize("metadata", ["[" * 5000, "a: !!int x"])
def test_a_bag_with_nonsense_beside_it_is_read_by_name(tmp_path: Path, metadata: str) -> None:
    bag = write_folder(tmp_path / "bag", drive())
    (bag / "metadata.yaml").write_text(metadata)
    assert replay(bag, code=1) == cells(expected_rows())


@pytest.mark.skipif(not NOT_READABLE.exists(), reason="needs /proc")
def test_a_disk_that_fails_while_it_is_read_is_one_line(tmp_path: Path, capsys: Capsys) -> None:
    bag = write_folder(tmp_path / "bag", drive())
    whole = str(bag)
    assert "mem: Input/output error" in complaint(main, [whole, "--params", str(NOT_READABLE)], capsys)
    assert "mem: Input/output error" in complaint(main, [str(NOT_READABLE)], capsys)
    (bag / "metadata.yaml").unlink()
    (bag / "metadata.yaml").symlink_to(NOT_READABLE)
    (bag / "bag_1.mcap").symlink_to(NOT_READABLE)
    assert replay(bag, code=1) == cells(expected_rows())
    assert "bag_1.mcap: Input/output error; left out" in capsys.readouterr().err
