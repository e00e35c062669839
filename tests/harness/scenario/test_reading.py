"""What a file may say: each mistake is one line with file, line, column and what would be valid."""

import re
from pathlib import Path

import pytest

from harness.errors import UsageError
from harness.scenario.bound import Bound
from harness.scenario.launch import launch_of
from harness.scenario.reading import read_scenario

HEAD = "about: a test\nduration: 10\n"
EXPECT = "expect: {truth.speed: {min: 0}}\n"


LAUNCH = (
    *("a --b 'c d'", ("e", "f g")),
    *({"command": "h", "wait_for": "/i"}, {"command": ("j",), "wait_for": ()}),
)


def read(text: str, folder: Path) -> object:
    path = folder / "a.scenario.yaml"
    path.write_text(text)
    return read_scenario(path)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("about: [", ":1:9: not valid YAML: expected the node content, but found '<stream end>'"),
        ("about: a\nabout: b\n", ':2:1: not valid YAML: found duplicate key "about" with value "b"'),
        ("[1, 2]", ": it must hold keys with values, beginning with 'about:'"),
        ("\0", ": not valid YAML: "),
        (HEAD, ": the key 'expect' is missing"),
        (HEAD + "expect: {}\n", ":3:1: expect is empty; give one or more"),
        (HEAD + EXPECT + "sed: 4\n", ":4:1: key 'sed' does not exist; did you mean 'seed'?"),
        (HEAD + EXPECT + "seed: -1\n", ":4:1: seed = -1 is not valid: input should be greater than or"),
        (
            HEAD + EXPECT + "seed: '1'\n",
            ':4:1: seed = "1" is not valid: input should be a valid integer',
        ),
        (HEAD + EXPECT + "seed: 2020-01-01\n", ':4:1: seed = "2020-01-01" is not valid: input should'),
        (HEAD + EXPECT + f"seed: {'x' * 58}\n", f':4:1: seed = "{"x" * 58}" is not valid: '),
        (HEAD + EXPECT + f"seed: {'x' * 59}\n", f':4:1: seed = "{"x" * 56}... is not valid: '),
        (HEAD + EXPECT + "seed: 1\nseeds: 2\n", ":4:1: seed: give one of seed and seeds"),
        (HEAD + EXPECT + "seeds: []\n", ":4:1: seeds is empty; give one or more"),
        (HEAD + EXPECT + "start: [1, 2]\n", ":4:1: start has too few values"),
        (
            HEAD + EXPECT + "robot: leo\nmatrix: {robot: [leo]}\n",
            ":4:1: robot: give one of robot and matrix: robot",
        ),
        (
            HEAD + "expect:\n  truth.sped: {min: 0}\n",
            ":4:3: expect.truth.sped: quantity 'truth.sped' does not exist; did you mean 'truth.speed'?",
        ),
        (
            HEAD + "expect:\n  truth.speed: {mix: 0}\n",
            ":4:17: key 'mix' does not exist; did you mean 'min'?",
        ),
        (
            HEAD + "expect:\n  truth.speed: {}\n",
            ":4:3: expect.truth.speed: nothing is expected; give min, max, or relative",
        ),
        (
            HEAD + "expect:\n  truth.speed: {min: 2, max: 1}\n",
            ":4:3: expect.truth.speed: min 2 is above max 1: no value can be right",
        ),
        (
            HEAD + "expect:\n  truth.speed: {min: 2, over: share}\n",
            ":4:3: expect.truth.speed: 'over: share' and 'share: 0 to 1' belong together",
        ),
        (
            HEAD + "expect:\n  truth.speed: {min: 2, share: 0.5}\n",
            ":4:3: expect.truth.speed: 'over: share' and 'share: 0 to 1' belong together",
        ),
        (
            HEAD + "expect:\n  truth.speed: {min: 2, over: often}\n",
            ":4:25: expect.truth.speed.over = \"often\" is not valid: input should be 'always'",
        ),
        (
            HEAD + "expect:\n  truth.speed:\n  - {min: 2}\n  - {min: 0, window: [5, 5]}\n",
            ":6:5: expect.truth.speed.1: window [5.0, 5.0] does not begin before it ends",
        ),
        (
            HEAD + "expect:\n  truth.speed: {min: 0, window: [5, 11]}\n",
            ":4:3: expect.truth.speed: a window to 11 s ends after the run of 10 s",
        ),
        (
            HEAD + "expect:\n  truth.speed: {min: 0, relative: 0.1, over: end}\n",
            ":4:3: expect.truth.speed: limits and a tolerance about the baseline are two bounds",
        ),
        (
            HEAD + "expect:\n  truth.speed: {max: 0, relative: 0.1, over: end}\n",
            ":4:3: expect.truth.speed: limits and a tolerance about the baseline are two bounds",
        ),
        (
            HEAD + "expect:\n  truth.speed: {absolute: 0.1}\n",
            ":4:3: expect.truth.speed: a baseline holds one value; give over: end, mean, p95",
        ),
        (
            HEAD + "expect:\n  truth.goal_s: {max: 1}\n",
            ":4:3: expect.truth.goal_s: it needs a goal, e.g. goal: {at: [5, 0]}",
        ),
        (
            HEAD + EXPECT + "events:\n- {at: 3}\n",
            ":5:3: events.0: an event needs one of the keys fault, command, reset",
        ),
        (
            HEAD + EXPECT + "events: [3]\n",
            ":4:10: events.0: an event needs one of the keys fault, command, reset",
        ),
        (
            HEAD + EXPECT + "events:\n- {at: 3, command: [1, 0], reset: true}\n",
            ":5:28: key 'reset' does not exist",
        ),
        (
            HEAD + EXPECT + "events:\n- {at: 3, fault: scan:nan, four: 2}\n",
            ":5:28: key 'four' does not exist; did you mean 'for'?",
        ),
        (
            HEAD + EXPECT + "events:\n- {at: 10, reset: true}\n",
            ":5:3: events.0: an event at 10 s is after the run of 10 s",
        ),
        (
            HEAD + EXPECT + "events:\n- {at: 0, command: [1, 0]}\n",
            ":5:3: events.0: commands need 'driver: cmd_vel'; others drive by themselves",
        ),
        (
            HEAD + EXPECT + "driver: cmd_vel\nevents:\n- {at: 0, command: [.inf, 0]}\n",
            ":6:21: events.0.command.0 = Infinity is not valid: input should be a finite number",
        ),
        (
            HEAD + EXPECT + "events:\n- {at: 1, pause: 2}\n",
            ":5:3: events.0: without nodes nobody would notice a pause; it needs 'launch:' or",
        ),
        (
            HEAD + EXPECT + "launch: [a b, 'c \"d']\n",
            ":4:15: launch.1: No closing quotation",
        ),
        (
            HEAD + EXPECT + "launch: [{command: a, wait_for: node}]\n",
            ":4:23: launch.0.wait_for: 'node' is no full name of a topic or a node; give one such as",
        ),
        (
            HEAD + EXPECT + "launch: [{comand: a}]\n",
            ":4:11: key 'comand' does not exist; did you mean 'command'?",
        ),
        (HEAD + EXPECT + "launch: [[]]\n", ":4:10: launch.0 is empty; give one or more"),
        (
            HEAD + "expect:\n  topic./scan.rat: {min: 1}\n",
            ":4:3: expect.topic./scan.rat: /scan: field 'rat' does not exist; available: header,",
        ),
        (
            HEAD + "expect:\n  topic./scan.latency: {max: 1}\n",
            ":4:3: expect.topic./scan.latency: a latency needs the topic of the input, e.g. of: /scan",
        ),
        (
            HEAD + "expect:\n  topic./scan.rate: {max: 1, of: /imu}\n",
            ":4:3: expect.topic./scan.rate: 'of' belongs to the latency of a topic",
        ),
        (
            HEAD + "expect:\n  topic./scan.count: {max: 1, over: mean}\n",
            ":4:3: expect.topic./scan.count: a count is one number; leave out 'over: mean'",
        ),
        (
            HEAD + EXPECT + "pass_rate: {min: 1.5}\n",
            ":4:13: pass_rate.min = 1.5 is not valid: input should be less than or equal to 1",
        ),
    ],
)
def test_a_mistake_is_told_where_it_stands(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as caught:
        read(text, tmp_path)
    message = str(caught.value).removeprefix(str(tmp_path / "a.scenario.yaml"))
    assert message.startswith(told)
    assert "\n" not in message


@pytest.mark.parametrize(
    ("part", "keys"),
    [
        ("matrix: {q: 1}", "robot, terrain, difficulty, driver, noise, params"),
        ("goal: {q: 1}", "at, yaw, radius"),
        ("events: [{at: 1, fault: a, q: 1}]", "at, fault, for"),
        ("events: [{at: 1, command: [0, 0], q: 1}]", "at, command"),
        ("events: [{at: 1, reset: true, q: 1}]", "at, reset"),
        ("events: [{at: 1, pause: 1, q: 1}]", "at, pause"),
        ("launch: [{q: 1}]", "command, wait_for"),
        ("expected_to_fail: [{q: 1}]", "reason, robot, terrain"),
        ("pass_rate: {q: 1}", "min"),
    ],
)
def test_of_a_key_that_no_part_knows_those_of_its_part_are_told(
    part: str, keys: str, tmp_path: Path
) -> None:
    with pytest.raises(UsageError, match=rf":4:\d+: key 'q' does not exist; available: {keys}$"):
        read(f"{HEAD}{EXPECT}{part}\n", tmp_path)


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
launch: [a --b 'c d', [e, f g], {command: h, wait_for: /i}, {command: [j], wait_for: []}]
events: [{at: 1, command: [0.3, 0]}, {at: 2, reset: true}, {at: 3, fault: "scan:nan", for: 2},
  {at: 4, pause: 1}]
expect:
  truth.tilt_deg: {max: 20}
  truth.speed: [{min: 0.1, over: mean, window: [1, 2]}, {over: end, relative: 0.1, absolute: 0.05}]
pass_rate: {min: 0.5}
"""
    scenario = read(text, tmp_path)
    assert scenario == type(scenario)(  # type: ignore[call-arg]  # a Scenario
        about="all of it",
        robot="rover_zero4wd",
        seeds=(3, 5),
        driver="cmd_vel",
        duration=10.0,
        start=(1.0, 2.0, 0.5),
        goal={"at": (5.0, 0.0), "yaw": 0.0, "radius": 0.5},
        events=(
            {"at": 1.0, "command": (0.3, 0.0)},
            {"at": 2.0, "reset": True},
            {"at": 3.0, "fault": "scan:nan", "for": 2.0},
            {"at": 4.0, "pause": 1.0},
        ),
        launch=LAUNCH,
        expect={
            "truth.tilt_deg": Bound(max=20.0),
            "truth.speed": (
                Bound(min=0.1, over="mean", window=(1.0, 2.0)),
                Bound(over="end", relative=0.1, absolute=0.05),
            ),
        },
        pass_rate={"min": 0.5},
    )
    launches = scenario.launches  # type: ignore[attr-defined]  # of a Scenario
    assert [launch.words("/w") for launch in launches] == [
        ["a", "--b", "c d"],
        ["e", "f g"],
        ["h"],
        ["j"],
    ]
    assert [launch.nodes for launch in launches] == [None, None, ("/i",), ()]
    assert scenario.needs_ros  # type: ignore[attr-defined]
    assert launch_of(("a", "b:={folder}/c")).words("/w") == ["a", "b:=/w/c"]
