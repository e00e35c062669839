"""What a run says of what went wrong with its rover."""

from dataclasses import replace

import pytest

from harness.episode.mishaps import KINDS, mishaps
from harness.episode.result import RunResult
from harness.episode.truth_account import TruthAlong
from harness.samples import ContactEvent, Truth
from harness.spec.run import Run

BUMP = ContactEvent("rock", 6_200_000_000, 6_300_000_000, "chassis", "rock_7", 90.0, (0.1, 0.2, 0.0))
POST = replace(BUMP, kind="hazard", start_ns=2_000_000_000, part="wheel_FL", other="hazard_1")
ROLLED = replace(BUMP, part="wheel_FL", other="rock_2", start_ns=1_000_000_000)


def result(*events: ContactEvent, **more: float | str) -> RunResult:
    tipped = float(more.pop("tipped_over_s", float("nan")))
    along = TruthAlong(events=events, event_count=len(events), tipped_over_s=tipped)
    truth = Truth(time_ns=42_000_000_000)
    return RunResult(
        run=Run(), mode="", truth=truth, along=along, failure=str(more.get("failure", "")) or None
    )


def test_an_ordinary_drive_came_to_nothing_though_its_wheels_met_rocks() -> None:
    assert mishaps(result(ROLLED)) == ()


def test_what_went_wrong_is_told_in_the_order_of_time_each_kind_once() -> None:
    failure = "the rover reached the edge of the map at t = 42.00 s"
    came_to = mishaps(result(POST, BUMP, POST, tipped_over_s=41.0, failure=failure))
    told = [mishap.text for mishap in came_to]
    assert told == [
        "hit hazard_1 at 2.0 s, 2 times in all",
        "struck rock_7 with its chassis at 6.2 s",
        "tipped over at 41.0 s",
        "left the map at 42.0 s",
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_can_be_asked_for_alone(kind: str) -> None:
    scrape = replace(BUMP, kind="scrape", other="ground")
    failure = "the rover reached the edge of the map at t = 42.00 s"
    everything = result(POST, BUMP, scrape, tipped_over_s=41.0, failure=failure)
    assert [mishap.kind for mishap in mishaps(everything, (kind,))] == [kind]  # type: ignore[arg-type]
