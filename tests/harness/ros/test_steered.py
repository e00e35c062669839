"""A run through ROS that is steered: what was ordered can be driven again, also without ROS."""

from pathlib import Path

import pytest

from harness.base.interrupt import StopRequest
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.helm import Helm, Order
from harness.episode.result import Outputs
from harness.samples import Twist
from harness.spec.ros import RosOptions
from harness.spec.run import Run

RUN = Run.of(terrain="rocky", driver="straight", duration=4.0, lidar_beams=36)
LEFT, ON = Order(driver="cmd_vel", command=Twist(0.3, 0.4)), Order(driver="")


class Steering:
    """An observer that steers by what it sees."""

    def __init__(self, helm: Helm) -> None:
        self._helm, self._orders = helm, {1.0: LEFT, 2.0: Order(command=Twist(0.1, 0.0)), 3.0: ON}

    def take(self, batch: Batch) -> None:
        for at in [at for at in self._orders if at * 1e9 <= batch.truth.time_ns]:
            self._helm.order(0, self._orders.pop(at))


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
