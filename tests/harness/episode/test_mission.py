"""Missions judged: stops, gates and routes of walks through known places, and in a whole scenario."""

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.episode.assembly import route_progress, world_of
from harness.episode.mission import MissionAccount, MissionOutcome, MissionState
from harness.scenario.attempt import attempt
from harness.scenario.case import plan
from harness.spec.run import Run

RUN = Run.of(
    terrain="flat",
    driver="goal",
    targets=["aruco:x=5,y=0", "gate:x=3,y=3,yaw=1.5707963267948966", "post:x=-5,y=0,reach=1"],
    route="4,0/gate",
)


def walked(*places: tuple[float, float, float]) -> MissionState:
    """How the mission stands after a walk."""
    return walk(*places)[0]


def walk(*places: tuple[float, float, float]) -> tuple[MissionState, MissionOutcome]:
    """A walk in straight lines at 20 Hz: time [s] and place of its corners; a reset at a time of two."""
    world, resets = world_of(RUN), 0
    account, state = MissionAccount(world.targets, route_progress(RUN, world)), MissionState()
    for (t, x, y), (u, v, w) in pairwise(places):
        resets += u == t
        for step in range(round((u - t) * 20)):
            share = step / ((u - t) * 20)
            state = account.take(t + step / 20, (x + share * (v - x), y + share * (w - y)), resets)
    return state, account.outcome()


def test_who_passes_by_has_not_stopped_and_who_stops_near_has_reached() -> None:
    assert walked((0, 0, 0), (10, 10, 0)).reached == 0
    state = walked((0, 0, 0), (4, 3.5, 0), (6, 3.5, 0), (12, 9, -5))
    assert (state.reached, state.gates) == (1, 0)
    assert state.stops["aruco"] == pytest.approx(1.5)
    assert math.isnan(walked((0, 0, 0), (2, 8, 0)).stops["post"])


def test_a_gate_counts_between_its_posts_and_not_beside_them() -> None:
    assert walked((0, 3, 1), (2, 3, 5)).gates == 1
    assert walked((0, 1, 1), (2, 1, 5)).gates == 0
    assert walked((0, 3, 1), (2, 3, 2), (2, 3, 4), (4, 3, 5)).gates == 0  # it was carried through
    carried = walked((0, 0, 0), (4, 4, 0), (6, 3, 2), (6, 3, 4), (8, 3, 5))
    assert (carried.points, carried.gates) == (1, 0)  # nor is that a step of its route
    before = walked((0, 3, 0), (2, 3, 2.5), (4, 3, 2.5), (5, 5, 2))
    assert before.stops["gate"] == pytest.approx(0.5)
    assert before.reached == 0  # who stops there is not through


def test_a_route_is_done_in_its_order() -> None:
    done = walked((0, 0, 0), (4, 4, 0), (6, 3, 1), (8, 3, 5), (9, 3, 6))
    assert done.points == 2
    assert done.done_s == pytest.approx(7.0, abs=0.06)
    backwards = walked((0, 3, 1), (2, 3, 5), (4, 4, 0), (9, 9, 0))
    assert (backwards.points, math.isnan(backwards.done_s)) == (1, True)


def test_a_run_tells_what_it_reached_and_when() -> None:
    _, outcome = walk((0, 0, 0), (4, 4, 0), (6, 4, 0), (8, 3, 1), (10, 3, 5), (11, 3, 6))
    points: list[Any] = [(p.name, p.reached_s) for p in outcome.way_points]
    assert points == [
        ("", pytest.approx(3.0, abs=0.06)),  # 1 m before it
        ("gate", pytest.approx(9.0, abs=0.06)),
    ]
    targets: list[Any] = [(t.name, t.reached_s, t.stop_distance) for t in outcome.targets]
    assert targets == [
        ("aruco", pytest.approx(5.0, abs=0.06), pytest.approx(1.0, abs=0.05)),  # after a second
        ("gate", pytest.approx(9.0, abs=0.06), pytest.approx(math.sqrt(10.0), abs=0.05)),
        ("post", pytest.approx(math.nan, nan_ok=True), pytest.approx(9.0, abs=0.05)),
    ]
    assert [words.split(" by ")[0] for _, words in outcome.rows()] == ["2 of 2", "2 of 3"]


SCENARIO = """
about: A gate, then a post.
terrain: flat
driver: goal
duration: 22
targets: ["gate:x=3,y=0.5", "aruco:x=6,y=1.5", "post:x=-9,y=9"]
route: {points: [{target: gate}, {target: aruco, radius: 1.5}]}
events: [{at: 3, abort: true}, {at: 5, resume: true}]
expect:
  truth.route_s: {over: end, max: 21}
  truth.route_points: {over: end, min: 2}
  truth.targets_reached: [{over: end, min: 2}, {over: end, min: 3}]
  truth.target.aruco.stop_distance: {over: end, max: 1.5}
  truth.gates_passed: [{over: end, min: 1}, {over: end, min: 2}]
"""


def test_a_mission_in_a_file_is_driven_and_judged(tmp_path: Path) -> None:
    (tmp_path / "m.scenario.yaml").write_text(SCENARIO)
    (case,) = plan([tmp_path / "m.scenario.yaml"])
    assert attempt(case, tmp_path / "out").breaches == (
        "truth.targets_reached: at the end 2 < 3, not post",
        "truth.gates_passed: at the end 1 < 2",
    )
    (manifest,) = (
        json.loads(file.read_text()) for file in (tmp_path / "out").rglob("metrics_log*.json")
    )
    points, (gate, post, _) = (manifest["truth"]["mission"][kind] for kind in ("way_points", "targets"))
    assert 3.0 < points[0]["reached_s"] == gate["reached_s"] < points[1]["reached_s"] < 21.0
    assert post["reached_s"] <= 22.0
    assert post["stop_distance"] <= 1.5


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("route: {", "#route: {", "it needs a route"),
        ("target.aruco", "target.arucco", "did you mean 'aruco'"),
        ("{target: gate}", "{target: gates}", "gate"),
        ("{target: gate}", "{at: [1, 2], radius: 0}", "more than 0"),
        ("abort: true", "abort: 1.5", "abort"),
        ("targets: [", "#targets: [", "it needs targets"),
    ],
)
def test_a_mistake_in_a_mission_is_told_with_its_mend(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    path = tmp_path / "m.scenario.yaml"
    path.write_text(SCENARIO.replace(old, new))
    with pytest.raises(UsageError) as told:
        plan([path])
    assert words in str(told.value)
