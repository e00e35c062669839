"""What a row says to whoever watches; over DDS in test_metrics_publisher.py."""

from dataclasses import replace

import pytest

from rover_metrics.core.columns import COLUMNS, Row
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.health.live_view import Level, LiveView, Status
from rover_metrics.health.reception import TopicState

CALM = Row(7, 0, 0, 98000.0, 9.8, 2.0, 1.0, 0.4, 9.8, 0, 9.8)
HEARD = TopicState("/rover1/imu/data", 100, 0, 0, 6_900_000_000, is_silent=False, publishers=1)


def traversal(row: Row) -> Status:
    return LiveView().statuses(row, (), Thresholds(), 0)[0]


def topic(*states: TopicState) -> Status:
    """The status of the last of some states, a second apart."""
    view = LiveView()
    for second, state in enumerate(states):
        _, status = view.statuses(CALM, [state], Thresholds(), (6 + second) * 10**9)
    return status


def test_a_calm_row_is_ok_and_has_every_column_as_plain_decimals() -> None:
    status = traversal(CALM)
    assert (status.level, status.message) == (Level.OK, "within all thresholds")
    values = dict(status.values)
    assert tuple(values) == COLUMNS
    assert values["Smoothness Metric"] == "98000.0000"
    assert values["Total Collisions"] == "0"
    assert "e" not in dict(traversal(replace(CALM, smoothness_metric=1e20)).values)["Smoothness Metric"]


LOW = "clearance {} m is below min_safe_clearance"


@pytest.mark.parametrize(
    ("changes", "level", "message"),
    [
        ({"total_collisions": 3}, Level.ERROR, "collision: 3 scans since the row before"),
        ({"collision_status": 1}, Level.ERROR, "collision: the mean clearance is that of a contact"),
        ({"obstacle_clearance": 0.4999}, Level.WARN, LOW.format("0.4999")),
        ({"is_rough_terrain": 1}, Level.WARN, "rough terrain"),
        ({"current_smoothness": 10.1}, Level.WARN, "smoothness 10.1000 is above smoothness_threshold"),
        ({"obstacle_clearance": 0.5, "current_smoothness": 10.0}, Level.OK, "within all thresholds"),
        (
            {"total_collisions": 1, "is_rough_terrain": 1, "obstacle_clearance": 0.1},
            Level.ERROR,
            f"collision: 1 scans since the row before; {LOW.format('0.1000')}; rough terrain",
        ),
    ],
)
def test_what_is_beyond_a_threshold_is_told(
    changes: dict[str, float], level: Level, message: str
) -> None:
    status = traversal(replace(CALM, **changes))  # type: ignore[arg-type]
    assert (status.level, status.message) == (level, message)


def test_a_collision_is_an_error_once_not_for_ever() -> None:
    view = LiveView()
    rows = (replace(CALM, total_collisions=total) for total in (0, 3, 3, 4, 3))
    told = [view.statuses(row, (), Thresholds(), 0)[0] for row in rows]
    assert [status.level for status in told] == [Level.OK, Level.ERROR] * 2 + [Level.OK]
    assert told[3].message == "collision: 1 scans since the row before"


def test_a_topic_tells_rate_age_and_losses() -> None:
    heard = HEARD._replace(lost=5, rejected=7)
    status = topic(heard._replace(received=80), heard)
    assert (status.level, status.message, status.name) == (Level.OK, "heard", "topic rover1 imu data")
    assert status.values[:3] == (("topic", heard.topic), ("rate [Hz]", "20.0000"), ("age [s]", "0.1000"))
    assert status.values[3:] == (("lost", "5"), ("rejected", "7"), ("publishers", "1"))


@pytest.mark.parametrize(
    ("state", "level", "words"),
    [
        (HEARD._replace(is_silent=True, publishers=0), Level.STALE, "silent, publishers: 0"),
        (HEARD._replace(received=0), Level.STALE, "not heard yet, publishers: 1"),
        (HEARD._replace(received=1), Level.OK, "heard"),
        (HEARD._replace(lost=2, rejected=1), Level.WARN, "2 lost and 1 rejected since the row before"),
        (HEARD._replace(publishers=2), Level.WARN, "2 publishers"),
    ],
)
def test_a_topic_that_is_not_well_says_why(state: TopicState, level: Level, words: str) -> None:
    status = topic(HEARD, state)
    assert status.level is level
    assert status.message.startswith(words)


def test_losses_of_long_ago_are_no_warning_any_more() -> None:
    old = HEARD._replace(lost=5, rejected=7)
    assert topic(HEARD, old, old).level is Level.OK
    assert topic(old).message == "5 lost and 7 rejected since the row before"
    for what, new in (("lost", old._replace(lost=6)), ("rejected", old._replace(rejected=8))):
        assert topic(old, new).message == f"1 {what} since the row before"


def test_a_rate_needs_two_rows_and_time_between_them() -> None:
    view, rates = LiveView(), []
    for received, half_seconds in ((100, 4), (110, 5), (150, 9), (200, 9), (251, 5)):
        state = HEARD._replace(received=received)
        _, status = view.statuses(CALM, [state], Thresholds(), half_seconds * 500_000_000)
        rates.append(dict(status.values).get("rate [Hz]"))
    assert rates == [None, "20.0000", "20.0000", None, None]
