"""Runs through ROS: what was ordered can be driven again, also without ROS; topics stay apart."""

from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.episode.assembly import fleet
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.helm import Helm, Order
from harness.episode.loop import Observer
from harness.episode.result import Outputs
from harness.samples import Twist
from harness.spec.fleet import parse_rovers
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from tests.support.ros import Ros

RUN = Run.of(terrain="rocky", driver="straight", duration=4.0, lidar_beams=36)
LEFT, ON = Order(driver="cmd_vel", command=Twist(0.3, 0.4)), Order(driver="")


class Steering:
    """An observer that steers a rover by what it sees."""

    def __init__(self, helm: Helm, number: int = 0) -> None:
        self._helm, self._number = helm, number
        self._orders = {1.0: LEFT, 2.0: Order(command=Twist(0.1, 0.0)), 3.0: ON}

    def take(self, batch: Batch) -> None:
        for at in [at for at in self._orders if at * 1e9 <= batch.truth.time_ns]:
            self._helm.order(self._number, self._orders.pop(at))


def test_what_was_ordered_through_ros_gives_the_same_bytes_without(
    ros_domain: int,  # noqa: ARG001 - sets it
    tmp_path: Path,
) -> None:
    session = pytest.importorskip("harness.ros.session")
    helm = Helm(None, StopRequest())
    options, outputs = (
        RosOptions(log_dir=tmp_path),
        Outputs(log_dir=tmp_path, observers=(Steering(helm),)),
    )
    (steered,) = session.run_through_ros(RUN, (outputs,), options, StopRequest(), None, helm)
    again = Outputs(log_dir=tmp_path / "again")
    (direct,) = run_direct(helm.driven(RUN), (again,), options, StopRequest())
    assert (steered.failure, steered.lost, len(helm.given)) == (None, 0, 3)
    assert [at for at, *_ in helm.driven(RUN).plan.commands] == pytest.approx([1.0, 2.0], abs=0.101)
    assert steered.log_path is not None
    assert direct.log_path is not None
    assert steered.log_path.read_bytes() == direct.log_path.read_bytes()


class Stranger:
    """An observer that sends commands to a rover whose own driver obeys none."""

    def __init__(self, ros: Ros) -> None:
        from geometry_msgs.msg import TwistStamped as Message  # noqa: PLC0415 - there may be no ROS

        self._sent, self._publisher = (
            Message(),
            ros.node("stranger").create_publisher(Message, "/b/cmd_vel", 10),
        )

    def take(self, _: Batch) -> None:
        self._publisher.publish(self._sent)


def test_a_rover_of_a_fleet_that_is_steered_drives_through_ros_as_without(
    ros: Ros, tmp_path: Path
) -> None:
    session = pytest.importorskip("harness.ros.session")
    two = fleet(RUN, parse_rovers(("leo:a", "rover_zero4wd:b,x=3,y=3,yaw=1"), RUN.rover))
    logs, ways = list[list[bytes]](), {"ros": session.run_through_ros, "direct": run_direct}
    for way, drive in ways.items():
        helm, folder = Helm(None, StopRequest()), tmp_path / way
        watching: tuple[tuple[Observer, ...], ...] = (Steering(helm, 1), Stranger(ros)), ()
        outputs = [Outputs(log_dir=folder / str(n), observers=some) for n, some in enumerate(watching)]
        options = RosOptions(log_dir=folder, cmd_vel="stamped")
        results = drive(two, outputs, options, StopRequest(), None, helm)
        heard = [bool(result.commands.older) for result in results]  # their stamps are 0
        assert heard == [False, way == "ros"]
        assert [each.number for each in helm.given] == [1, 1, 1]
        logs.append([result.log_path.read_bytes() for result in results])
    assert logs[0] == logs[1]
    assert logs[0][0] != logs[0][1]


def test_topics_of_several_rovers_in_one_are_refused_before_there_is_a_log(
    ros_domain: int,  # noqa: ARG001 - sets it
    tmp_path: Path,
) -> None:
    session = pytest.importorskip("harness.ros.session")
    two = fleet(RUN, parse_rovers(("leo:a", "leo:b"), RUN.rover))
    options = RosOptions(log_dir=tmp_path, ros_args=("--ros-args", "-r", "imu/data:=/imu"))
    with pytest.raises(UsageError, match=r"^/imu .* remap"):
        session.run_through_ros(two, [Outputs(log_dir=tmp_path)] * 2, options, StopRequest())
    assert not [*tmp_path.iterdir()]
