"""What a file may say: each mistake is one line with file, line, column and what would be valid."""

import re
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.scenario.bound import Bound
from harness.scenario.case import cases_of
from harness.scenario.reading import read_scenario
from harness.scenario.spec import Goal
from harness.spec.fault import parse_fault
from harness.spec.plan import Plan

HEAD = "about: a test\nduration: 10\n"
EXPECT = "expect: {truth.speed: {min: 0}}\n"


def read(text: str, folder: Path) -> Any:  # noqa: ANN401 - events of several kinds
    path = folder / "a.scenario.yaml"
    path.write_text(text)
    return read_scenario(path)


FILES = [
    ("about: [", ":1:9:", "not valid YAML"),
    ("about: a\nabout: b\n", ":2:1:", 'duplicate key "about"'),
    ("[1, 2]", ":", "beginning with 'about:'"),
    ("\0", ":", "not valid YAML"),
    ("about: 2026-13-01", ":", "month must be in 1..12"),
    (HEAD, ":", "key 'expect' is missing"),
    (HEAD + "pass_rate: {min: 1, q: 1}\n", ":3:21:", "key 'q' does not exist"),
    (HEAD + "expect: {}\n", ":3:1:", "give at least 1"),
]
PARTS = [
    ("sed: 4", ":4:1:", "did you mean 'seed'?"),
    ("seed: -1", ":4:1:", "give 0 or more"),
    ("seed: '1'", ":4:1:", "seed '1' is not valid; give a whole number"),
    ("timestep: 0.0031", ":4:1:", "timestep"),
    ("lidar_beams: 1", ":4:1:", "give 2 to 100000"),
    ("seed: 1\nseeds: 2", ":4:1:", "one of seed and seeds"),
    ("seeds: []", ":4:1:", "give at least 1"),
    ("seeds: [3, 1, 3]", ":4:1: seeds:", "seed 3 is given 2 times"),
    ("matrix: {robot: []}", ":4:10: matrix.robot", "an empty list"),
    ("seeds: 0", ":4:1: seeds:", "0 seeds are not valid; give 1 to 100000"),
    ("seeds: 100000000", ":4:1: seeds:", "give 1 to 100000, or a list of them"),
    ("start: [1, 2]", ":4:1:", "too few values"),
    ("robot: leo\nmatrix: {robot: [leo]}", ":4:1:", "one of robot and matrix: robot"),
    ("events:\n- {at: 3}", ":5:3: events.0:", "one of the keys fault, command, reset"),
    ("events: [3]", ":4:10: events.0:", "one of the keys fault, command, reset"),
    ("events: [{at: 3, command: [1, 0], reset: true}]", ":4:35:", "key 'reset' does not exist"),
    ("events: [{at: 1, pause: 0}]", ":4:18: events.0.pause", "0 is not valid"),
    ("events:\n- {at: 3, fault: scan:nan, four: 2}", ":5:28:", "did you mean 'for'?"),
    ("events:\n- {at: 10, reset: true}", ":5:3: events.0:", "after the run of 10 s"),
    ("events:\n- {at: 0, command: [1, 0]}", ":5:3: events.0:", "need 'driver: cmd_vel'"),
    (
        *("driver: cmd_vel\nevents:\n- {at: 0, command: [.inf, 0]}", ":6:21: events.0.command.0"),
        "give a finite number",
    ),
    ("events:\n- {at: 1, pause: 2}", ":5:3: events.0:", "it needs 'launch:' or"),
    ("launch: [a b, 'c \"d']", ":4:15: launch.1:", "No closing quotation"),
    ("launch: [{command: a, wait_for: node}]", ":4:23: launch.0.wait_for:", "give one such as"),
    ("launch: [{comand: a}]", ":4:11:", "did you mean 'command'?"),
    ("launch: [[]]", ":4:10: launch.0", "give at least 1"),
    ("pass_rate: {min: 1.5}", ":4:13: pass_rate.min", "give 0 to 1"),
    ("matrix: {q: 1}", ":4:10:", "available: robot, terrain, difficulty, driver"),
    ("goal: {q: 1}", ":4:8:", "available: at, yaw, radius"),
    ("events: [{at: 1, fault: a, q: 1}]", ":4:28:", "available: at, fault, for"),
    ("events: [{at: 1, command: [0, 0], q: 1}]", ":4:35:", "available: at, command"),
    ("events: [{at: 1, reset: true, q: 1}]", ":4:31:", "available: at, reset"),
    ("events: [{at: 1, pause: 1, q: 1}]", ":4:28:", "available: at, pause"),
    ("launch: [{q: 1}]", ":4:11:", "available: command, wait_for"),
    ("expected_to_fail: [{q: 1}]", ":4:21:", "available: reason, robot, terrain"),
    ("pass_rate: {q: 1}", ":4:13:", "available: min"),
]
BOUNDS = [  # where no other place is given, the quantity's own
    ("truth.sped: {min: 0}", "did you mean 'truth.speed'?"),
    ("truth.speed: {mix: 0}", "did you mean 'min'?", ":4:17:"),
    ("truth.speed: {}", "give min, max, or relative"),
    ("truth.speed: {min: 2, max: 1}", "min 2 is above max 1"),
    ("truth.speed: {min: 2, over: share}", "belong together"),
    ("truth.speed: {min: 2, share: 0.5}", "belong together"),
    (
        "truth.speed: {min: 2, over: often}",
        "give one of 'always', 'end'",
        ":4:25: expect.truth.speed.over",
    ),
    ("truth.speed:\n  - {min: 2}\n  - {min: 0, window: [5, 5]}", "does not begin", ":6:5: expect."),
    ("truth.speed: {min: 0, window: [5, 11]}", "ends after the run of 10 s"),
    ("truth.speed: {min: 0, relative: 0.1, over: end}", "two bounds"),
    ("truth.speed: {max: 0, relative: 0.1, over: end}", "two bounds"),
    ("truth.speed: {absolute: 0}", "give over: end, mean, p95"),
    ("truth.goal_s: {max: 1}", "it needs a goal"),
    ("topic./scan.rat: {min: 1}", "'rat' does not exist; available: header,"),
    ("topic./scan.latency: {max: 1}", "e.g. of: /scan"),
    ("topic./scan.rate: {max: 1, of: /imu}", "'of' belongs to the latency"),
    ("topic./scan.count: {max: 1, over: mean}", "leave out 'over: mean'"),
]


@pytest.mark.parametrize(
    ("text", "place", "mend"),
    [
        *FILES,
        *((f"{HEAD}{EXPECT}{part}\n", place, mend) for part, place, mend in PARTS),
        *(
            (
                f"{HEAD}expect:\n  {bound}\n",
                (*place, f":4:3: expect.{bound.partition(':')[0]}:")[0],
                mend,
            )
            for bound, mend, *place in BOUNDS
        ),
    ],
)
def test_a_mistake_is_one_line_with_its_place_and_what_would_be_valid(
    text: str, place: str, mend: str, tmp_path: Path
) -> None:
    with pytest.raises(UsageError) as caught:
        read(text, tmp_path)
    message = str(caught.value).removeprefix(str(tmp_path / "a.scenario.yaml"))
    assert message.startswith(place)
    assert mend in message
    assert "\n" not in message


def test_a_key_without_a_value_counts_as_left_out(tmp_path: Path) -> None:
    left_out = read(f"{HEAD}{EXPECT}difficulty:\nstart: null\n", tmp_path)
    assert left_out == read(f"{HEAD}{EXPECT}", tmp_path)
    assert left_out.run_values() == {"duration": 10.0}


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=re.escape(f"cannot read {tmp_path}: Is a directory")):
        read_scenario(tmp_path)


def test_what_a_file_says_is_what_the_scenario_holds(tmp_path: Path) -> None:
    text = """
about: all of it
robot: rover_zero4wd
seeds: [3, 5]
driver: cmd_vel
duration: 10
start: [1, 2, 0.5]
goal: {at: [5, 0]}
launch: [a --b 'c d', [e, f g, "b:={folder}/c"],
  {command: h, wait_for: /i}, {command: [j], wait_for: []}]
events: [{at: 1, command: [0.3, 0]}, {at: 2, reset: true}, {at: 3, fault: "scan:nan", for: 2},
  {at: 4, pause: 1}, {at: 5, abort: true}, {at: 6, resume: true}, {at: 7, link_loss: 0.5}]
expect:
  truth.tilt_deg: {max: 20}
  truth.speed: [{min: 0.1, over: mean, window: [1, 2]}, {over: end, relative: 0.1, absolute: 0.05}]
pass_rate: {min: 0.5}
"""
    scenario = read(text, tmp_path)
    assert scenario.run_values() == {
        "robot": "rover_zero4wd",
        "driver": "cmd_vel",
        "duration": 10.0,
        "start": (1.0, 2.0, 0.5),
    }
    assert (scenario.about, scenario.all_seeds) == ("all of it", (3, 5))
    assert scenario.goal == Goal(at=(5.0, 0.0), yaw=0.0, radius=0.5)
    command, reset, fault, pause, *_ = scenario.events
    assert (command.at, command.command, reset.at) == (1.0, (0.3, 0.0), 2.0)
    assert (fault.spec, pause.at, pause.pause) == ("scan:nan@3.0+2.0", 4.0, 1.0)
    assert scenario.bounds == (
        ("truth.tilt_deg", Bound(max=20.0)),
        ("truth.speed", Bound(min=0.1, over="mean", window=(1.0, 2.0))),
        ("truth.speed", Bound(over="end", relative=0.1, absolute=0.05)),
    )
    assert scenario.pass_rate is not None
    assert scenario.pass_rate.min == 0.5
    words = [["a", "--b", "c d"], ["e", "f g", "b:=/w/c"], ["h"], ["j"]]
    assert [launch.words("/w") for launch in scenario.launch] == words
    assert [launch.wait_for for launch in scenario.launch] == [None, None, ("/i",), ()]
    assert scenario.needs_ros
    case, _ = cases_of(tmp_path / "a.scenario.yaml", scenario)
    assert case.run.rover.faults == (parse_fault(fault.spec),)
    assert case.run.plan == Plan(
        commands=((1.0, 0.3, 0.0),),
        resets=(2.0,),
        aborts=(5.0,),
        resumes=(6.0,),
        link_losses=((7.0, 0.5),),
    )
