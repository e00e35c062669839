"""What arrived on each topic, what of it was left out or odd, and what is missing. No ROS in here."""

from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

from rover_metrics.errors import is_worth_a_line
from rover_metrics.health.watches import MISSING, SilenceWatch, StampWatch

LOST = "lost on the way"
NOT_HEARD = "publisher is not heard"


class TopicState(NamedTuple):
    """What is known of a topic at one moment."""

    topic: str  # its resolved name
    received: int = 0  # messages so far
    rejected: int = 0  # of these, left out
    lost: int = 0  # on the way, as far as that shows
    stamp_ns: int = 0  # the latest stamp [ns]; 0 without one
    is_silent: bool = False  # for too long
    publishers: int = 0


class Reception:
    """The account of a node's topics; `tell` is given each line for the user.

    What repeats is reported at the 1st, 2nd, 4th, 8th ... time; all of it is counted.

    Attributes:
        received: Messages received, by topic.
        rejected: Those of them that were left out, by topic.
        remarks: By topic, how often something was odd, by its name; the reasons of `rejected` are
            among them.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self.received: dict[str, int] = {}
        self.rejected: dict[str, int] = {}
        self.remarks: dict[str, Counter[str]] = {}
        self._stamps: dict[str, StampWatch] = {}
        self._silences: dict[str, SilenceWatch] = {}
        self._publishers: dict[str, int] = {}
        self._silent_by_right: set[str] = set()

    def listen(self, topic: str, *, may_be_missing: bool = False) -> None:
        """Opens the account of a topic; one that may be missing is not missed before it has spoken."""
        if may_be_missing:
            self._silent_by_right.add(topic)
        self.received[topic] = self.rejected[topic] = 0
        self.remarks[topic] = Counter()
        self._stamps[topic] = StampWatch()
        self._silences[topic] = SilenceWatch()

    def arrived(self, topic: str, stamp_ns: int | None) -> None:
        """Counts a message with the stamp of its header [ns]; None if its type has none."""
        self.received[topic] += 1
        self._silent_by_right.discard(topic)
        finding = None if stamp_ns is None else self._stamps[topic].take(stamp_ns)
        if finding is not None:
            self.remark(topic, *finding)

    def reject(self, topic: str, reason: str, detail: str = "") -> None:
        """Counts a message that was left out.

        Args:
            topic: Where it was met; of a topic or a service that others listen to, rclpy itself for
                one, the account begins with that.
            reason: Its name, by which it is counted.
            detail: Text for the report; the count does not depend on it.
        """
        self.rejected[topic] = self.rejected.get(topic, 0) + 1
        self.remarks.setdefault(topic, Counter())
        self.remark(topic, reason, detail=f"{detail}, left out")

    def remark(self, topic: str, finding: str, times: int = 1, *, detail: str = "") -> None:
        """Counts something odd, and reports it ever more rarely.

        Args:
            topic: Where it was met.
            finding: Its name, by which it is counted.
            times: How often.
            detail: Text for the report; the count does not depend on it.
        """
        remarks = self.remarks[topic]
        before = remarks[finding]
        remarks[finding] = before + times
        if is_worth_a_line(before, before + times):
            self._tell(f"{topic}: {finding}{detail} ({before + times} so far)")

    def look(self, now_ns: int, stale_after_ns: int) -> None:
        """Looks once a second for topics that are silent for too long; 0 is never too long."""
        for topic, silence in self._silences.items():
            self._stamps[topic].learn()
            if topic in self._silent_by_right:
                continue
            change = silence.look(self.received[topic], now_ns, stale_after_ns)
            if change is not None and change.is_over:
                self._tell(f"{topic}: heard again after {change.seconds:.0f} s of silence")
            elif change is not None:
                self._tell(
                    f"{topic}: nothing for {change.seconds:.0f} s (publishers: "
                    f"{self._publishers.get(topic, 0)}); its columns show what was last heard"
                )

    def publishers(self, topic: str, number: int) -> None:
        """Takes how many publishers a topic has; more than one is reported, and when that is over."""
        before = self._publishers.get(topic, 0)
        self._publishers[topic] = number
        if number == before or max(number, before) < 2:
            return
        if number > 1:
            self._tell(
                f"{topic}: {number} publishers, whose messages mix in this log; stop all but one, or "
                "give each run a ROS_DOMAIN_ID (0 to 101) or a namespace of its own"
            )
        else:
            self._tell(f"{topic}: no second publisher any more")

    def states(self) -> list[TopicState]:
        """Returns the state of each topic, but for those that may be missing and are."""
        return [
            TopicState(
                topic=topic,
                received=self.received[topic],
                rejected=self.rejected[topic],
                lost=max(remarks[LOST], remarks[MISSING]),
                stamp_ns=self._stamps[topic].latest_ns,
                is_silent=self._silences[topic].is_silent,
                publishers=self._publishers.get(topic, 0),
            )
            for topic, remarks in self.remarks.items()
            if topic in self.received and topic not in self._silent_by_right
        ]

    def account(self) -> dict[str, Any]:
        """Returns all counts by topic, as JSON values; what is not counted as received is None."""
        return {
            topic: {
                "received": self.received.get(topic),
                "rejected": self.rejected[topic],
                "lost": remarks[LOST],
                "remarks": dict(remarks),
            }
            for topic, remarks in self.remarks.items()
        }
