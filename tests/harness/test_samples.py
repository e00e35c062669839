"""What samples are: values that cannot be changed and that arrive in another process as they were."""

import pickle
from dataclasses import FrozenInstanceError, fields, is_dataclass

import numpy as np
import pytest

from harness import samples
from harness.episode.batch import Batch
from harness.samples import Odometry, Pose, Tick, TruthState
from harness.sensors.ranging import RangeReading

KINDS = [kind for kind in vars(samples).values() if isinstance(kind, type) and is_dataclass(kind)]


@pytest.mark.parametrize("kind", [*KINDS, Batch], ids=lambda kind: kind.__name__)
def test_a_sample_arrives_as_it_was_sent_field_by_field_and_cannot_be_changed(kind: type) -> None:
    values = {field.name: (index, field.name) for index, field in enumerate(fields(kind))}
    sent = kind(**values)
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        arrived = pickle.loads(pickle.dumps(sent, protocol))  # noqa: S301 - its own
        assert type(arrived) is kind
        assert {name: getattr(arrived, name) for name in values} == values
    with pytest.raises(FrozenInstanceError):
        setattr(sent, next(iter(values)), 1)


def test_a_sample_is_known_by_its_sensors_name_or_else_by_what_it_is() -> None:
    reading = RangeReading(0, "top", np.zeros(0, np.float32), np.zeros(0, bool))
    pose = Pose(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    assert (samples.source(reading), samples.source(pose)) == ("top", Pose)
    tick = Tick(0, (reading, pose, Pose(1, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0))))
    assert (tick.of(Pose), tick.of(RangeReading), tick.of(Odometry)) == (pose, reading, None)


def test_the_traversal_has_the_order_that_docs_topics_promises() -> None:
    state = TruthState(0, True, False, True, 5.0, 0.1, 0.2, (0.3, 0.4), 0.5)
    assert state.traversal == (5.0, False, True, 0.1, 0.2, 0.3, 0.4, 0.5)
