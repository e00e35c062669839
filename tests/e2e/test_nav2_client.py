"""What can be proved of Nav2 without it: a client like its nodes, and a listener of another DDS."""

import math
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.base.interrupt import StopRequest
from harness.base.message_types import typestore
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.episode.result import Outputs
from harness.robots import find_rover
from harness.ros.context import spin_until
from harness.ros.network import reserved_domain
from harness.ros.session import run_through_ros
from harness.samples import GroundTruth
from harness.spec.ros import FrameOptions, RosOptions
from harness.spec.run import Run
from harness.world.occupancy import occupancy
from tests.support.nav2_client import TF, XY_TOLERANCE, Nav2Client
from tests.support.waiting import PATIENCE

GOALS = [(0.6, 0.15), (1.1, 0.15), (1.6, -0.1)]
CONFIG = Run.of(terrain="rocky", driver="cmd_vel", duration=5.5, lidar_beams=45)
Drive = Any  # a client, a Bystander and the run's result
TOPICS = {"/tf", "/tf_static", "/robot_description", "/map", "/scan"}
JOINS_LATE = 3 * 10**9  # [ns]


@dataclass
class Bystander:
    """Remembers the true poses and the graph, and lets Cyclone DDS listen where it is installed."""

    client: Nav2Client
    cyclone: Any
    truth: dict[int, GroundTruth] = field(default_factory=dict)
    hashes: dict[str, tuple[str, str]] = field(default_factory=dict)

    def take(self, batch: Batch) -> None:
        for tick in batch.ticks:
            self.truth |= {s.stamp_ns: s for s in tick.samples if isinstance(s, GroundTruth)}
        if self.cyclone is not None:
            self.cyclone.take()
        if batch.ticks[-1].stamp_ns == JOINS_LATE:
            self.look_around()

    def look_around(self) -> None:
        seen = spin_until(self.client.executor, self.sees_the_graph, PATIENCE)
        assert seen, self.hashes
        if self.cyclone is not None:
            self.cyclone.join_late(PATIENCE)

    def sees_the_graph(self) -> bool:
        """Keeps what the graph says; whether the node is known as the one that publishes all of TOPICS.

        DDS matches a topic before the graph knows whose it is.
        """
        node = self.client.node
        for topic, _ in node.get_topic_names_and_types():
            for info in node.get_publishers_info_by_topic(topic):
                if info.node_name == "harness":
                    self.hashes[topic] = info.topic_type, str(info.topic_type_hash)
        return set(self.hashes) >= TOPICS


def another_dds(domain: int) -> Any:  # noqa: ANN401 - a CycloneListener, if there is one
    if find_spec("cyclonedds") is None:
        return None
    from tests.support.cyclone import CycloneListener  # noqa: PLC0415 - only where it can be

    return CycloneListener(domain)


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Drive]:
    frames, folder = FrameOptions(map_tf=True), tmp_path_factory.mktemp("drive")
    options = RosOptions(log_dir=folder, host_metrics=False, frames=frames)
    with pytest.MonkeyPatch.context() as patch, reserved_domain() as domain, ExitStack() as at_end:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        client = Nav2Client(at_end, GOALS)
        bystander = Bystander(client, another_dds(domain))
        outputs = [Outputs(log_dir=options.log_dir, observers=[client, bystander])]
        (result,) = run_through_ros(CONFIG, outputs, options, StopRequest())
        yield client, bystander, result


def test_a_client_that_does_as_nav2_does_drives_to_three_goals_on_rocky(drive: Drive) -> None:
    client, bystander, result = drive
    assert (result.failure, result.lost) == (None, 0)
    assert len(client.reached) == len(GOALS)
    for at_ns, goal in zip(client.reached, GOALS, strict=True):
        place = bystander.truth[at_ns - at_ns % (20 * 10**6)]  # at 50 Hz
        assert math.dist((place.x, place.y), goal) < XY_TOLERANCE + 0.02
    assert result.commands.refused == 0
    assert client.told - 2 <= result.commands.taken <= client.told


def test_every_scan_can_be_transformed_when_it_comes_and_shows_what_is_on_the_map(drive: Drive) -> None:
    client, *_ = drive
    assert client.scans > 0.5 * CONFIG.duration * 20
    assert client.late_transforms == 0
    points = np.concatenate([hits for hits in client.hits if len(hits)])
    assert len(points) > 20
    assert not any(client.is_free((x, y), margin=0.05) for x, y, _ in points)


def test_the_graph_shows_the_hash_of_every_type(drive: Drive) -> None:
    _, bystander, _ = drive
    assert bystander.hashes["/tf"][0] == TF
    known = {t: one for t, one in bystander.hashes.items() if one[0] in typestore().types}
    assert set(known) >= TOPICS
    assert all(told == typestore().hash_rihs01(kind) for kind, told in known.values())


def test_another_dds_implementation_hears_tf_and_joining_late_what_is_latched(drive: Drive) -> None:
    pytest.importorskip("cyclonedds", reason="needs another DDS: pip install cyclonedds")
    _, bystander, _ = drive
    messages, latched = bystander.cyclone.moving, bystander.cyclone.latched
    assert len(messages) > 60  # a second of them: discovery takes its time
    for message in messages:
        (base,) = [each for each in message.transforms if each.child_frame_id == "base_footprint"]
        at, stamp = base.transform, base.header.stamp
        if truth := bystander.truth.get(stamp.sec * 10**9 + stamp.nanosec):
            moved = at.translation
            assert (moved.x, moved.y, moved.z) == pytest.approx((truth.x, truth.y, 0.0))
            assert 2 * math.atan2(at.rotation.z, at.rotation.w) == pytest.approx(truth.yaw)
    fixed = {each.child_frame_id: each for each in latched["rt/tf_static"].transforms}
    assert fixed["base_link"].transform.translation.z == pytest.approx(0.19783)
    assert fixed["odom"].header.frame_id == "map"
    assert latched["rt/robot_description"].data.startswith('<robot name="leo">')
    rover, grid = find_rover("leo"), latched["rt/map"]
    cells = occupancy(world_of(CONFIG), rover.slope_limit, rover.step_limit).cells
    assert (np.array(grid.data).reshape(grid.info.height, -1) == cells).all()
