"""What samples are: values that cannot be changed and that arrive in another process as they were."""

import pickle
from dataclasses import FrozenInstanceError, astuple, fields, is_dataclass

import numpy as np
import pytest

from harness import samples
from harness.episode.batch import Batch
from harness.samples import Odometry, Pose, Tick, Twist
from harness.sensors.ranging import RangeReading
from harness.truth.traversal import ContactEvent, Truth

KINDS = [kind for kind in vars(samples).values() if isinstance(kind, type) and is_dataclass(kind)]


@pytest.mark.parametrize("kind", [*KINDS, Batch, Truth, ContactEvent], ids=lambda kind: kind.__name__)
def test_a_sample_arrives_as_it_was_sent_field_by_field_and_cannot_be_changed(kind: type) -> None:
    values = {field.name: (index, field.name) for index, field in enumerate(fields(kind))}
    sent = kind(**values)
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        arrived = pickle.loads(pickle.dumps(sent, protocol))  # noqa: S301 - its own
        assert type(arrived) is kind
        assert {name: getattr(arrived, name) for name in values} == values
    assert sent.__reduce__() == (kind, tuple(values.values())), "the short way"
    with pytest.raises(FrozenInstanceError):
        setattr(sent, next(iter(values)), 1)


def test_a_sample_is_known_by_its_sensors_name_or_else_by_what_it_is() -> None:
    reading = RangeReading(0, "top", np.zeros(0, np.float32), np.zeros(0, bool))
    pose = Pose(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    assert (samples.source(reading), samples.source(pose)) == ("top", Pose)


def test_beyond_ten_metres_roboterrains_lidar_sees_nothing() -> None:
    assert samples.LIDAR_RANGE_MAX == 10.0


def test_what_is_left_out_is_nothing_out_of_the_ordinary() -> None:
    assert Twist() == Twist(linear=0.0, angular=0.0)
    assert not Pose(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)).empty
    assert Tick(0, ()).tells_time
    assert set(astuple(Truth())) == {0, (0.0, 0.0, 0.0), ()}
    assert Odometry(1, 2.0, 3.0, 4.0, Twist(5.0, 6.0)) == Odometry(
        stamp_ns=1, x=2.0, y=3.0, yaw=4.0, twist=Twist(linear=5.0, angular=6.0)
    )
