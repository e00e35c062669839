"""What a client of Foxglove's WebSocket gets of a run, against the recording of the same run."""

import json
import re
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest
from mcap.reader import make_reader

pytest.importorskip("foxglove", reason="needs foxglove-sdk: pip install -e '.[foxglove]'")

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from harness.base.errors import UsageError
from harness.base.message_types import read_message
from harness.messages.foxglove import Foxglove
from harness.messages.outlets import CLOCK
from harness.messages.sink import endpoint
from harness.sensors.table import Topic
from tests.support.waiting import PATIENCE, free_port

WORDS = ("--terrain", "flat", "--duration", "600", "--rate", "3", "--lidar-beams", "45")
FLEET = ("--rover", "leo:a", "--rover", "rover_zero4wd:b", "--actor", "anna=random")
SECOND = 100  # of /clock
PLACED, LATCHED = struct.Struct("<BIQ"), {"/tf_static", "/robot_description", "/map"}


class Told(NamedTuple):
    """A message of a topic, at a simulation time [ns]."""

    topic: str
    time_ns: int
    data: bytes


class Client:
    """A client that subscribes to all topics as they are advertised."""

    def __init__(self, address: str) -> None:
        self.socket: ClientConnection = connect(
            address,
            subprotocols=[Subprotocol("foxglove.sdk.v1")],
            max_size=None,
            open_timeout=PATIENCE,
            close_timeout=0.0,
        )
        self.channels: dict[int, dict[str, str]] = {}
        self.now_ns = self.clocks = 0

    def told(self) -> Iterator[Told]:
        """Yields each message until the run has ended."""
        try:
            for frame in self.socket:
                if isinstance(frame, str):
                    self._subscribe(json.loads(frame))
                elif frame[0] == 2:
                    (self.now_ns,) = struct.unpack("<Q", frame[1:])
                else:
                    _, channel, time_ns = PLACED.unpack_from(frame)
                    topic = self.channels[channel]["topic"]
                    self.clocks += topic == "/clock"
                    yield Told(topic, time_ns, bytes(frame[PLACED.size :]))
        except ConnectionClosed:  # without a farewell
            return

    def _subscribe(self, said: dict[str, object]) -> None:
        new = {each["id"]: each for each in said.get("channels", ())}  # type: ignore[attr-defined]
        self.channels |= new
        wanted = [{"id": channel, "channelId": channel} for channel in new]
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))


@pytest.mark.parametrize("words", [("--direct", *FLEET), ()], ids=["direct", "ros"])
@pytest.mark.usefixtures("ros_domain")
def test_a_client_gets_what_is_recorded_byte_for_byte_whenever_it_comes(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    if "--direct" not in words:
        pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    bag, where = tmp_path / "bag.mcap", f"127.0.0.1:{free_port()}"
    own = ("--foxglove", where, "--record", str(bag), "--log-dir", str(tmp_path))
    command = [sys.executable, "-m", "harness.run", *WORDS, *words, *own]
    with (
        ThreadPoolExecutor() as others,
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as run,
    ):
        try:
            assert run.stdout is not None
            found = (re.match(r"foxglove: (ws://\S+?),", line) for line in run.stdout)
            address = next(match[1] for match in found if match)
            client = Client(address)
            idle = Client(address)  # never reads: nobody waits for it
            told, late = [], None
            for each in client.told():
                told.append(each)
                if late is None and client.clocks == SECOND:
                    late = Client(address)
                    hearing = others.submit(list, late.told())
                if late is not None and late.clocks > 3 * SECOND:
                    break
            run.send_signal(signal.SIGINT)
            told += client.told()
            told_late = hearing.result(PATIENCE)
            run.communicate(timeout=PATIENCE)
        finally:
            run.kill()
    idle.socket.close()
    recorded = {(e.topic, e.time_ns, e.data) for e in recording(bag)}
    assert run.returncode == 128 + signal.SIGINT
    assert client.now_ns == recording(bag)[-1].time_ns
    assert {c["topic"] for c in client.channels.values()} >= {e.topic for e in recording(bag)}
    for got in (told, told_late):
        stream = [e for e in got if not e.topic.endswith(tuple(LATCHED))]
        expected = [e for e in recording(bag) if not e.topic.endswith(tuple(LATCHED))]
        whole = max(one_of_each(stream))  # from where on every topic is heard
        assert [e for e in stream if e.time_ns > whole] == [e for e in expected if e.time_ns > whole]
        assert whole < client.now_ns - 1_000_000_000
        latched = {e for e in got if e.topic.endswith(tuple(LATCHED))}
        assert latched <= recorded
        assert {e.topic for e in latched} == {e.topic for e in recording(bag)} - {
            e.topic for e in expected
        }
    kinds = {each["topic"]: each["schemaName"] for each in client.channels.values()}
    for topic, data in {each.topic: each.data for each in told}.items():
        read_message(data, kinds[topic])
    encodings = {(each["encoding"], each["schemaEncoding"]) for each in client.channels.values()}
    assert encodings == {("cdr", "ros2msg")}


def recording(bag: Path) -> list[Told]:
    with bag.open("rb") as file:
        found = make_reader(file).iter_messages(log_time_order=False)
        return [Told(channel.topic, message.log_time, message.data) for _, channel, message in found]


def one_of_each(stream: list[Told]) -> list[int]:
    """When each topic was first heard."""
    return list({each.topic: each.time_ns for each in reversed(stream)}.values())


def test_a_port_that_is_taken_is_named_and_nothing_is_left(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        where = f"127.0.0.1:{server.getsockname()[1]}"
        command = [sys.executable, "-m", "harness.run", "--direct", "--duration", "1", "--foxglove"]
        command += [where, "--record", str(tmp_path / "bag.mcap"), "--log-dir", str(tmp_path)]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert f"--foxglove {where} cannot be served" in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "bag.mcap").exists()


def test_a_port_that_is_taken_since_it_was_tried_is_named() -> None:
    where = f"127.0.0.1:{free_port()}"
    host, port = where.split(":")
    taken = pytest.raises(UsageError, match=f"--foxglove {where} cannot be served")
    with Foxglove(where) as served, socket.create_server((host, int(port))), taken:
        served.open(endpoint(CLOCK, CLOCK.name)).take(0, b"")


def test_the_time_goes_out_though_no_client_subscribes_to_it() -> None:
    with Foxglove(f"127.0.0.1:{free_port()}") as served:
        topics = (CLOCK, "/clock"), (CLOCK, "/a/clock"), (Topic("a", "sensor_msgs/msg/Imu"), "/a")
        assert [served.open(endpoint(*each)).is_wanted() for each in topics] == [True, True, False]
