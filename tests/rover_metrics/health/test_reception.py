import pytest

from rover_metrics.health.reception import LOST, NOT_HEARD, Reception, TopicState
from rover_metrics.health.watches import MISSING

SECOND = 10**9
TICK = SECOND // 20


class Listener:
    """A Reception of one topic, and what it has told."""

    def __init__(self) -> None:
        self.told: list[str] = []
        self.reception = Reception(self.told.append)
        self.reception.listen("/scan")

    def hear(self, *numbers: int) -> None:
        for number in numbers:
            self.reception.arrived("/scan", (number + 1) * TICK)

    def look(self, *seconds: int, limit: int = 5) -> None:
        for second in seconds:
            self.reception.look(second * SECOND, limit * SECOND)


@pytest.fixture
def listener() -> Listener:
    return Listener()


def test_what_is_rejected_is_always_counted_and_told_ever_more_rarely(listener: Listener) -> None:
    for _ in range(1000):
        listener.reception.reject("/parameters", "not readable", ", see above")
    assert listener.told == [
        f"/parameters: not readable, see above, left out ({2**power} so far)" for power in range(10)
    ]
    counted = {"rejected": 1000, "lost": 0, "remarks": {"not readable": 1000}}
    assert listener.reception.account()["/parameters"] == {"received": None, **counted}
    assert [state.topic for state in listener.reception.states()] == ["/scan"]


def test_a_detail_does_not_split_a_count(listener: Listener) -> None:
    for times in (5, 1, 4):  # a power of two is passed by the first and the last
        listener.reception.remark("/scan", LOST, times)
    for detail in (": best effort", ": transient"):
        listener.reception.remark("/scan", NOT_HEARD, detail=detail)
    assert listener.told == [
        *(f"/scan: lost on the way ({total} so far)" for total in (5, 10)),
        "/scan: publisher is not heard: best effort (1 so far)",
        "/scan: publisher is not heard: transient (2 so far)",
    ]


@pytest.mark.parametrize(
    ("remarks", "lost"),  # what the middleware tells is missing by the stamps too
    [({LOST: 3}, 3), ({LOST: 3, MISSING: 4}, 4), ({LOST: 5, MISSING: 4}, 5)],
)
def test_a_topics_state_is_what_is_known(listener: Listener, remarks: dict[str, int], lost: int) -> None:
    reception = listener.reception
    reception.listen("/truth", may_be_missing=True)
    reception.publishers("/scan", 3)
    listener.hear(*range(20))
    for what, times in remarks.items():
        reception.remark("/scan", what, times)
    for _ in range(2):
        reception.reject("/scan", "not finite")
    assert reception.states() == [TopicState("/scan", 20, 2, lost, 20 * TICK, False, 3)]
    counted = {"received": 20, "rejected": 2, "lost": remarks[LOST]}
    assert reception.account()["/scan"] == {**counted, "remarks": {**remarks, "not finite": 2}}
    listener.look(*range(9))
    assert [state.is_silent for state in reception.states()] == [True]
    reception.arrived("/truth", None)
    assert reception.states()[1] == TopicState("/truth", 1, 0, 0, 0, False, 0)
    assert TopicState("/new") == ("/new", 0, 0, 0, 0, False, 0)


def test_each_topic_is_missed_once_it_is_expected(listener: Listener) -> None:
    """Those that were left out count too; one that may be missing is expected once it has spoken."""
    reception = Reception(listener.told.append)
    for topic in ("/imu", "/scan", "/pose", "/truth", "/never"):
        reception.listen(topic, may_be_missing=topic in ("/truth", "/never"))
    for second in range(20):
        reception.arrived("/imu", None)
        reception.rejected["/imu"] += 1
        for topic in ("/truth", "/scan", "/pose") if second == 9 else ():
            reception.arrived(topic, None)
        reception.look(second * SECOND, 5 * SECOND)
    silence = "nothing for 5 s (publishers: 0); its columns show what was last heard"
    again = "heard again after 9 s of silence"
    assert listener.told == [
        *(f"{topic}: {told}" for told in (silence, again) for topic in ("/scan", "/pose")),
        *(f"{topic}: {silence}" for topic in ("/scan", "/pose", "/truth")),
    ]


def test_a_second_publisher_is_told_when_it_comes_and_when_it_goes(listener: Listener) -> None:
    for number in (0, 1, 2, 2, 2, 3, 1, 1, 0, 2, 0):
        listener.reception.publishers("/scan", number)
    mixed, over = "publishers, whose messages mix in this log", "no second publisher any more"
    told = [line.split(";")[0].removeprefix("/scan: ") for line in listener.told]
    assert told == [f"2 {mixed}", f"3 {mixed}", over, f"2 {mixed}", over]
