"""The table of topics; its messages go through a real node in test_extended_node.py."""

from types import SimpleNamespace

import pytest
from rosbags.typesys import Stores, get_typestore

from rover_metrics.health.rejections import NO_TIME
from rover_metrics.session import MetricsSession, Remark
from rover_metrics.topics import CLOCK, SENSORS, TRUTH


@pytest.mark.parametrize(
    ("sec", "nanosec", "remark"),
    [
        *((sec, nanosec, None) for sec, nanosec in ((0, 0), (9, 999_999_999))),
        *((sec, nanosec, Remark(NO_TIME)) for sec, nanosec in ((-1, 5), (9, 10**9))),
    ],
)
def test_a_clock_that_tells_no_time_is_remarked_upon(
    sec: int, nanosec: int, remark: Remark | None
) -> None:
    message = SimpleNamespace(clock=SimpleNamespace(sec=sec, nanosec=nanosec))
    assert CLOCK.take(MetricsSession(), message, 0) == remark


def test_every_type_exists_and_has_a_header_where_the_table_says_so() -> None:
    types = get_typestore(Stores.LATEST).types
    for source in (*SENSORS, *TRUTH, CLOCK):
        assert ("header" in types[source.message_type].__annotations__) is source.has_stamp
