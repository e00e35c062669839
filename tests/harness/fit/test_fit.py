"""A fit against the rover that made its recording, and what a recording lacks or does not tell."""

import json
import re
import shutil
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from ruamel.yaml import YAML
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.workers import workers_of
from harness.episode.episode import Episode
from harness.fit.__main__ import main
from harness.fit.estimate import CERTAIN, Estimate, deviations, fitted, of, with_values
from harness.fit.folder import write_folder
from harness.fit.ground import UNITS, differences, ground
from harness.fit.motors import motors
from harness.fit.mount import mount, placed
from harness.fit.outcome import split
from harness.fit.page import render
from harness.fit.reading import read
from harness.fit.response import response
from harness.fit.steady import Steady, kinds, window
from harness.robots import REAL, ROVERS, RoverSpec, equipped, find_rover
from harness.spec.run import Run
from harness.validate.grounds import flat
from harness.validate.recordings.bags import recording_of_bag
from harness.validate.recordings.recording import Recording, at
from harness.validate.replay import controlled, replay
from tests.support.complaint import complaint

HUSKY = equipped(ROVERS["husky"], REAL, "")
TRUE = {
    "actuators.delay": 0.17, "actuators.lag": 0.2, "controller_separation": 0.9, "tyres.radius": 0.158,
    "tyres.friction": 0.6, "tyres.turning": 0.1,
}  # fmt: skip
HIDDEN = TRUE | {"tyres.rolling": 0.12, "tyres.drag": 0.1}
TWISTS = (0.0, 0.0), (0.6, 0.0), (0.0, 0.9), (-0.5, 0.4), (0.0, -0.7), (0.4, -0.8), (-0.8, 0.0)
CONSTANT = of(HUSKY, "actuators.motor_constant")
STEP = 4.0  # [s]
SIDES = "left_speed", "right_speed"
PLANE = 20.0, 0.5  # [m]: cells that are larger than those of terrains are driven over sooner
Capsys = pytest.CaptureFixture[str]


@cache
def driven(rover: RoverSpec, step: float = STEP) -> Recording:
    twists = TWISTS * round(STEP / step)
    commands = np.array([(step * n, *twist) for n, twist in enumerate(twists)])
    return replay(rover, commands, STEP * len(TWISTS), course=flat(*PLANE, 0.3))


def write(recording: Recording, path: Path, change: Callable[[pd.DataFrame], pd.DataFrame]) -> Path:
    """At 20 Hz, with noise, values that are missing and single ones that are wrong, as a real log."""
    rng, t = np.random.default_rng(4), np.arange(1, int(STEP * len(TWISTS) * 20)) / 20
    table = pd.DataFrame({"t": t})
    for series, names, sd in (
        ("commands", "cmd_v cmd_w", 0.0), ("wheels", "left_speed right_speed", 0.003),
        ("currents", "left_torque right_torque", 0.2 * CONSTANT), ("poses", "x y yaw", 0.005),
    ):  # fmt: skip
        held = at(getattr(recording, series), t + 1e-9)
        held *= CONSTANT if series == "currents" else 1.0
        for name, values in zip(names.split(), held.T, strict=True):
            table[name] = values + sd * rng.normal(size=t.size)
            if sd:
                table.loc[rng.random(t.size) < 0.03, name] = np.nan
    table.loc[rng.random(t.size) < 0.01, "left_speed"] += 2.0
    change(table).to_csv(path, index=False)
    return path


def test_a_fit_recovers_the_rover_as_a_folder_that_runs(
    tmp_path: Path, capsys: Capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.validate.replay.WHEELS", 1)  # a file that holds nothing back
    monkeypatch.setattr("harness.fit.ground.PLANE", (*PLANE, 0.5))
    monkeypatch.setattr("harness.fit.ground.MEASURED", 0.5)  # [s]: what is driven 30 times has no noise
    monkeypatch.setattr("harness.fit.estimate.ROUNDS", 1)
    monkeypatch.setenv("COLUMNS", "200")
    true = with_values(HUSKY, HIDDEN.items())
    csv, out = write(driven(true), tmp_path / "drive.csv", lambda t: t), tmp_path / "fitted"
    words = [str(csv), "--robot", "husky", "--surface", "mud", "--out", str(out), "--jobs", "1"]
    monkeypatch.setattr("harness.fit.page.render", drawn := Mock(side_effect=render))
    assert main(words) == 0
    outcome = drawn.call_args.args[0]  # what is held back would be judged by the rover that is written
    assert outcome.fitted == fitted(outcome.rover, outcome.estimates)
    found = equipped(find_rover(str(out)), REAL, "mud")
    assert {key: of(found, key) for key in TRUE} == pytest.approx(TRUE, rel=0.015)
    grown = found.wheel_radius - HUSKY.wheel_radius
    for height in ("rest_height", "lidar_height", "clearance"):
        assert getattr(found, height) == pytest.approx(getattr(HUSKY, height) + grown, abs=2e-5)
    printed = " ".join(capsys.readouterr().out.split())
    assert "an IMU with six axes is missing" in printed
    for key, true_value in TRUE.items():
        row = re.search(rf"{key} ([\d.]+) ([\d.]+) ([\d.]+) to ([\d.]+)", printed)
        assert row, key
        before, after, low, high = map(float, row.groups())
        assert (before, after) == pytest.approx((of(HUSKY, key), of(found, key)), rel=2e-3), key
        assert low < after < high
        assert low - 0.05 * true_value < true_value < high + 0.05 * true_value, key
    figures = json.loads(re.findall(r'id="figures">(.*?)</script>', (out / "fit.html").read_text())[0])
    assert len(figures) == 2 + len(UNITS)
    for named, figure in figures.items():
        real, *ours = ({axis: np.array(one[axis], float) for axis in "xy"} for one in figure["data"])
        if named.startswith("side"):
            errors = [np.interp(real["x"], one["x"], one["y"]) - real["y"] for one in ours]

        else:
            errors = [one["y"] - one["x"] for one in ours]
        was, now = (float(np.sqrt(np.mean(error**2))) for error in errors)
        assert now < 0.5 * was, named
        if (name := named.removeprefix("steady-")) in UNITS and name != "ahead":  # poses may be aside
            row = re.search(rf"{name.replace('_', ' ')} {UNITS[name]} ([\d.]+) ([\d.]+)", printed)
            assert row, name
            assert [*map(float, row.groups())] == pytest.approx([was, now], rel=0.05, abs=2e-3), name
    files = (YAML(typ="safe").load(folder / "rover.yaml") for folder in (HUSKY.folder, out))
    given, left = ({key: str(own[0]) for key, own in pd.json_normalize(file).items()} for file in files)
    changed = {key for key, value in left.items() if given.get(key) != value} - {"model"}
    heights = {"rest_height", "lidar_height", "clearance"} & given.keys()
    of_mud = {f"surfaces.mud.{name}" for name in ("friction", "turning", "rolling", "drag")}
    assert (
        changed - of_mud
        == {key for key in TRUE if key not in ("tyres.friction", "tyres.turning")} | heights
    )
    assert changed & of_mud >= {"surfaces.mud.friction", "surfaces.mud.turning"}
    assert "exists already" in complaint(main, words, capsys)


def test_the_last_third_of_the_steps_is_not_fitted_to() -> None:
    rows = np.arange(0.0, 63.0, 0.1)[:, None] * np.ones(4)
    changes = np.array([[0.0, 0.5, 0.1], [38.0, 0.4, 0.2], [41.8, 0.3, 0.3]])
    fitted, held = split(Recording("made", commands=changes, wheels=rows[:, :3], poses=rows))
    assert held is not None
    assert held.steps[:, 0].tolist() == [42.0, 48.0, 54.0]
    assert max(series[-1, 0] for series in fitted.series.values()) < 42.0
    assert (fitted.steps[:, 1] <= 42.0).all()
    assert held.commands.tolist() == [[41.5, 0.4, 0.2], [41.8, 0.3, 0.3]], "what was in force goes on"


def test_a_rover_whose_wheels_have_grown_stands_as_high_as_its_folder_says(tmp_path: Path) -> None:
    """Of one whose controller believes in smaller wheels than it has; by MuJoCo."""
    before, out = equipped(ROVERS["rover_zero4wd"], REAL, ""), tmp_path / "out"
    radius = before.wheel_radius
    wheels = Estimate("wheel radius", "m", "tyres.radius", radius, radius + 0.02)
    write_folder(before, [wheels], out, "drive.csv", "", "")
    stands = [
        Episode(Run.of(robot=str(folder), terrain="flat")).simulation.position[2]
        - find_rover(str(folder)).rest_height
        for folder in (before.folder, out)
    ]
    assert stands[0] == pytest.approx(stands[1], abs=5e-4)


def test_commands_that_never_hold_tell_of_the_controller_alone(
    tmp_path: Path, capsys: Capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.fit.estimate.ROUNDS", 1)
    csv, out = write(driven(HUSKY, 1.0), tmp_path / "drive.csv", lambda t: t), tmp_path / "fitted"
    assert main([str(csv), "--robot", "husky", "--out", str(out), "--jobs", "1"]) == 0
    assert "one command held for 3.5 s is missing" in " ".join(capsys.readouterr().out.split())


def lacking(*columns: str) -> Callable[[pd.DataFrame], pd.DataFrame]:
    return lambda table: table.drop(columns=list(columns))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t, ""),
        (
            lambda t: t.assign(left_speed=6 * t.left_speed, right_speed=6 * t.right_speed),
            "as left_wheel",
        ),
        (lambda t: t.assign(cmd_v=6 * t.cmd_v, cmd_w=6 * t.cmd_w), "commanded speed is"),
        (lambda t: t.assign(cmd_w=np.degrees(t.cmd_w)), "commanded yaw rate is"),
        (lambda t: t.assign(cmd_v=1000 * t.cmd_v), "commanded speed is"),
        (lambda t: t.assign(right_speed=-t.right_speed), "swapped"),
        (
            lambda t: t.rename(columns={"left_speed": "right_speed", "right_speed": "left_speed"}),
            "swapped",
        ),
    ],
)
def test_a_series_in_other_units_or_with_another_sign_is_one_line(
    change: Callable[[pd.DataFrame], pd.DataFrame], said: str, tmp_path: Path
) -> None:
    csv = write(driven(HUSKY), tmp_path / "drive.csv", change)
    with pytest.raises(UsageError, match=said) if said else nullcontext():
        assert read([csv], HUSKY, {}).problems == ()


@pytest.mark.parametrize(
    ("robot", "delay", "lag"), [("husky", 0.006, 0.06), ("leo", 0.055, 0.13), ("husky", 0.118, 0.071)]
)
def test_a_response_under_a_load_that_is_known_is_that_of_the_controller_alone(
    robot: str, delay: float, lag: float
) -> None:
    """Also of parts of a tick, with noise, and from where a search without the load may have ended."""
    late = {"actuators.delay": delay, "actuators.lag": lag}
    loaded = {"tyres.rolling": 0.12, "tyres.drag": 0.1} if robot == "husky" else {}
    true = with_values(equipped(ROVERS[robot], REAL, ""), (late | loaded).items())
    twists = [(0.0, 0.3, 0.0), (2.0, 0.0, 0.6), (4.0, -0.3, -0.4), (6.0, 0.3, 0.2), (8.0, -0.2, 0.5)]
    drive = replay(true, np.array(twists), 10.0, course=flat(*PLANE, 0.3), every=2)
    drive.wheels[:, 1:] += np.random.default_rng(8).normal(0.0, 0.005, drive.wheels[:, 1:].shape)
    off = with_values(true, [("actuators.delay", delay + 0.02), ("actuators.lag", lag - 0.02)])
    told = {one.key: one for one in response(true, drive, loaded=off) if one.is_known}
    assert len(told) == 3
    for key, one in told.items():
        assert abs(one.after - of(true, key)) < one.half < 0.006, key


def test_wheels_whose_motors_give_all_they_have_do_not_tell_of_the_controller() -> None:
    leo = equipped(ROVERS["leo"], REAL, "")
    off = with_values(leo, [("controller_separation", 0.9 * leo.controller_separation)])
    twists = np.array([(0.0, 0.6, 1.0), (4.0, 0.2, 0.8), (7.0, 0.6, -1.0), (11.0, 0.4, -0.5)])
    found = response(leo, replay(leo, twists, 14.0, course=flat(*PLANE, 0.3)), loaded=off)
    told = {one.key: one.after for one in found if one.is_known}
    assert told == pytest.approx({key: of(leo, key) for key in told}, abs=0.01)


def test_a_limit_of_the_sides_difference_is_told_where_commands_met_it() -> None:
    assert HUSKY.actuators is not None
    true = HUSKY.but(actuators=HUSKY.actuators.but(turn_limit=0.5))
    twists = np.array([(0.0, 0.5, 0.2), (5.0, 0.4, -0.3), (9.0, 0.0, 0.9), (11.0, 0.5, -0.4)])
    drive = replay(true, twists, 20.0, course=flat(*PLANE, 0.3))
    for loaded in (None, HUSKY):  # one that has a limit that is never met
        *_, told = response(HUSKY, drive, loaded=loaded)
        assert told.after == pytest.approx(0.5, abs=0.02)


def test_steps_are_on_the_clock_of_the_commands_and_of_a_paused_one_the_longest_part_counts(
    tmp_path: Path,
) -> None:
    def stepped(table: pd.DataFrame) -> pd.DataFrame:
        since = table.t % 10.0
        state = np.where((since > 2.0) & (since < 3.0), "paused", "run")
        return table.assign(t=table.t + 7.0, step=table.t // 10.0, state=state)

    found = read([write(driven(HUSKY), tmp_path / "drive.csv", stepped)], HUSKY, {})
    assert found.commands[0, 0] == 0.0
    assert found.steps[:2] == pytest.approx(np.array([[3.0, 10.0], [13.0, 20.0]]), abs=0.11)


def test_a_limit_that_no_command_met_is_not_told() -> None:
    """The fastest turn of a minute is over before the wheels have got there, as at a limit."""
    leo = equipped(ROVERS["leo"], REAL, "")
    slow = {"actuators.delay": 0.12, "actuators.lag": 0.15, "controller_separation": 0.5}
    rng, rows, t = np.random.default_rng(7), list[tuple[float, float, float]](), 0.0
    while t < 60.0:
        kind = rng.integers(4)
        ahead = 0.0 if kind == 0 else float(rng.uniform(0.12, 0.4))
        rows.append((t, ahead, 0.0 if kind == 1 else 1.5 * float(rng.uniform(-1.0, 1.0))))
        t += float(rng.choice([2.0, 4.0, 6.0]))
    drive = replay(with_values(leo, slow.items()), np.array(rows), 60.0, course=flat(*PLANE, 0.3))
    *_, told = response(leo, drive)
    assert not told.is_known


def noisy_and_late(table: pd.DataFrame) -> pd.DataFrame:
    """Poses as of a GNSS without a heading."""
    away = np.random.default_rng(1).normal(0.0, 0.05, (2, len(table)))
    return table.assign(x=table.x.shift(20) + away[0], y=table.y.shift(20) + away[1], yaw=0.0)


@pytest.mark.parametrize(
    ("change", "series", "said"),
    [
        (noisy_and_late, "poses", "the poses' yaw rate is"),
        (lambda t: t.assign(yaw=-t.yaw), "poses", "the poses' yaw rate and the wheels'"),
        (lambda t: t.assign(x=1000 * t.x, y=1000 * t.y), "poses", "the poses' speed is"),
        (lambda t: t.assign(power=-50.0), "power", "-50 W on average"),
    ],
)
def test_poses_and_power_that_cannot_be_of_the_drive_are_left_out(
    change: Callable[[pd.DataFrame], pd.DataFrame], series: str, said: str, tmp_path: Path
) -> None:
    found = read([write(driven(HUSKY), tmp_path / "drive.csv", change)], HUSKY, {})
    assert series not in found.series
    (problem,) = found.problems
    assert said in problem


def test_poses_of_a_place_far_from_the_middle_go_with_the_wheels(tmp_path: Path) -> None:
    def aside(table: pd.DataFrame) -> pd.DataFrame:
        left, ahead = 4.0 * np.cos(table.yaw), 4.0 * np.sin(table.yaw)
        return table.assign(x=table.x - ahead, y=table.y + left)

    assert read([write(driven(HUSKY), tmp_path / "drive.csv", aside)], HUSKY, {}).problems == ()


def test_times_that_were_rounded_until_they_repeat_are_told(tmp_path: Path) -> None:
    csv = write(driven(HUSKY), tmp_path / "drive.csv", lambda table: table.assign(t=table.t.round(1)))
    (problem,) = read([csv], HUSKY, {}).problems
    assert re.search(r"4\d% of the wheels' times repeat.* steps of 0\.1 s", problem)


def test_what_is_replayed_begins_at_0_and_goes_ahead_across_any_course() -> None:
    poses = replay(HUSKY, np.array([[0.0, 0.5, 0.0]]), 1.5, course=flat(*PLANE, 0.3)).poses
    assert poses[0, 1:] == pytest.approx(np.zeros(3), abs=0.02)
    assert poses[-1, 1:] == pytest.approx([0.6, 0.0, 0.0], abs=0.15)


def test_commands_above_a_limit_of_the_rover_are_not_of_other_units(tmp_path: Path) -> None:
    def slow(table: pd.DataFrame) -> pd.DataFrame:
        v, wheels = np.sign(table.cmd_v), table.cmd_v.shift(4).clip(-0.15, 0.15)
        table = table.assign(cmd_v=v, cmd_w=0.0, left_speed=wheels, right_speed=wheels)
        return table.drop(columns=["x", "y", "yaw"])

    csv = write(driven(HUSKY), tmp_path / "drive.csv", slow)
    (problem,) = read([csv], HUSKY, {}).problems
    assert "limit" in problem


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lacking("cmd_v"), "has no commands; it has"),
        (lacking("left_speed"), "has no wheels"),
        (lacking("t"), "has no commands and no wheels; no series is made of its columns cmd_v, "),
        (lambda table: table.head(1), "has no commands and no wheels"),
        (lambda table: table.head(90).assign(t=table.t + 1e4), "too short"),  # whenever it began
        (lambda table: table[(table.t < 4) | (table.t > 20)], "gaps of 16 s"),
        (lambda table: table.assign(left_speed=table.left_speed * 1000), "units"),
        (lambda table: table.assign(cmd_v=0.0, cmd_w=0.0), "commands are all 0"),
        (lambda table: table.assign(x=np.nan, left_speed="far"), "has no wheels"),
    ],
)
def test_a_recording_that_lacks_something_is_one_line(
    change: Callable[[pd.DataFrame], pd.DataFrame], said: str, tmp_path: Path, capsys: Capsys
) -> None:
    t = np.arange(0.0, STEP * len(TWISTS), 0.05)
    wave = np.sin(t)[:, None]
    sides = np.column_stack([t, wave, wave])
    poses = np.column_stack([sides, wave])
    made = Recording("made", commands=sides, wheels=sides, currents=sides, poses=poses)
    csv, out = write(made, tmp_path / "a.txt", change), tmp_path / "out"
    assert said in complaint(main, [str(csv), "--robot", "husky", "--out", str(out)], capsys)
    assert not out.exists()


def test_arguments_that_are_wrong_are_one_line(tmp_path: Path, capsys: Capsys) -> None:
    out = ["--out", str(tmp_path / "out")]
    assert "does not exist" in complaint(
        main, [str(tmp_path / "none"), "--robot", "husky", *out], capsys
    )
    assert "robot 'x'" in complaint(main, ["a.csv", "--robot", "x", *out], capsys)
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.MCAP):
        pass
    words = [str(tmp_path / "bag"), "--robot", "husky", *out]
    assert "nothing is read of its topics: none" in complaint(main, words, capsys)
    words = ["a.csv", "--robot", "husky", "--topic", "speed=/x", *out]
    assert "SERIES=TOPIC" in complaint(main, words, capsys)


def test_clocks_that_are_apart_are_told(tmp_path: Path, capsys: Capsys) -> None:
    made = driven(HUSKY)
    for shift, said in ((500.0, "do not overlap"), (5.0, "s after the wheels")):
        one, two = tmp_path / f"wheels_{shift:g}.csv", tmp_path / f"imu_{shift:g}.csv"
        table = {
            "t": made.wheels[:, 0],
            "left_speed": made.wheels[:, 1],
            "right_speed": made.wheels[:, 2],
        }
        v, w = at(made.commands, made.wheels[:, 0]).T
        pd.DataFrame(table | {"cmd_v": v, "cmd_w": w}).to_csv(one)
        names = ("wx", "wy", "wz", "ax", "ay", "az")
        felt = {name: made.imu[:, n + 1] for n, name in enumerate(names)}
        pd.DataFrame({"t": made.imu[:, 0] + shift} | felt).to_csv(two)
        words = [str(one), str(two), "--robot", "husky", "--out", str(tmp_path / "out")]
        assert said in complaint(main, words, capsys)


def test_a_driver_who_lets_go_of_a_joystick_has_stopped(tmp_path: Path) -> None:
    sent = [(4 * n + k / 20, *twist) for n, twist in enumerate(TWISTS[1:]) for k in range(40)]
    stops = [(4 * n + 2.5, 0.0, 0.0) for n in range(len(TWISTS[1:]))]  # by the rover's own timeout
    true, span = with_values(HUSKY, TRUE.items()), 4.0 * len(stops)
    made = replay(true, np.array(sorted(sent + stops)), span, course=flat(*PLANE, 0.3))
    wheels = pd.DataFrame(made.wheels, columns=["t", "v_left", "v_right"])
    twists = pd.DataFrame(sent, columns=["t", "cmd_v", "cmd_w"])
    csv = tmp_path / "joystick.csv"
    wheels.merge(twists, how="outer", on="t").to_csv(csv, index=False)
    found = {one.key: one.after for one in response(HUSKY, read([csv], HUSKY, {}))}
    assert found["actuators.delay"] == pytest.approx(TRUE["actuators.delay"], abs=0.03)
    assert found["actuators.lag"] == pytest.approx(TRUE["actuators.lag"], abs=0.03)
    assert found["controller_separation"] == pytest.approx(TRUE["controller_separation"], rel=0.03)
    assert HUSKY.actuators is not None
    for timeout, waits in ((None, 0.5), (0.25, 0.25), (3.0, 1.0)):
        rover = HUSKY.but(actuators=HUSKY.actuators.but(command_timeout=timeout))
        commands = read([csv], rover, {}).commands
        stopped = commands[~commands[:, 1:].any(axis=1), 0]
        assert stopped == pytest.approx([4 * n + 1.95 + waits for n in range(len(stops))])


@pytest.mark.parametrize("speed", [0.015, 0.4])
def test_a_command_that_is_latched_is_not_followed_by_a_stop(speed: float, tmp_path: Path) -> None:
    noise = np.random.default_rng(2).uniform(-0.003, 0.003, 1600)
    t, signs = np.arange(1600) / 20, np.arange(1600) // 80 % 2 * 2 - 1
    table = pd.DataFrame({"t": t, "v_left": signs * speed + noise, "v_right": signs * speed + noise})
    news = np.where(np.arange(1600) % 80, np.nan, 1.0)
    table["cmd_v"], table["cmd_w"] = news * signs * speed, news * 0.0
    table.to_csv(tmp_path / "latched.csv", index=False)
    assert len(read([tmp_path / "latched.csv"], HUSKY, {}).commands) == 20


def test_a_steady_window_goes_ahead_by_its_arc_and_not_by_its_chord() -> None:
    t, rate, speed = np.arange(0.0, 4.0, 0.05), 1.2, 0.5
    x, y = speed / rate * np.sin(rate * t), -speed / rate * np.cos(rate * t)
    wheels = np.column_stack([t, np.full_like(t, 0.3), np.full_like(t, 0.7)])
    circle = Recording("circle", wheels=wheels, poses=np.column_stack([t, x, y, rate * t]))
    row = window(circle, 1.0, 3.0)
    assert row is not None
    assert row[3:5] == pytest.approx((rate, speed), rel=1e-3)


def test_of_kinds_of_driving_the_most_frequent_ones_come_first_by_their_medians() -> None:
    left, ones = np.array([0.3, 0.5, 0.51, 0.49, 0.3]), np.ones(5)
    some = kinds(Steady(ones, left, left, np.nan * ones, left, ones, ones, ones))
    assert (some.left.tolist(), some.weight.tolist()) == ([0.5, 0.3], [3.0, 2.0])


def test_poses_beside_the_rovers_middle_say_nothing_of_its_tyres() -> None:
    rates, ones = np.array([-0.5, 0.0, 0.8]), np.ones(3)
    ours = Steady(ones, ones, ones, rates, ones, ones, ones, ones)
    beside = replace(ours, ahead=ours.ahead - 0.3 * rates)
    assert differences(ours, beside)["ahead"] == pytest.approx(np.zeros(3))


def test_what_a_recording_does_not_tell_of_a_mount_stays_as_it_was(tmp_path: Path) -> None:
    yaw, x = (
        Estimate(name, "", f"imu.{name}", 0.0, value) for name, value in (("yaw", 0.4), ("x", 0.1))
    )
    own, *_ = folders = [tmp_path / name for name in ("own", "turned", "moved")]
    (own / "models").mkdir(parents=True)
    shutil.copy(HUSKY.model_path, own / "models")
    said = (HUSKY.folder / "rover.yaml").read_text()
    (own / "rover.yaml").write_text(f"model: models/{HUSKY.model_path.name}\n{said}")
    for before, out, known in zip(folders, folders[1:], ([yaw], [x]), strict=False):
        write_folder(find_rover(str(before)), known, out, "drive.csv", "", "")
    place, angles = placed(find_rover(str(folders[-1])))
    assert place == pytest.approx([0.1, *placed(HUSKY)[0][1:]])
    assert angles == pytest.approx([0.0, 0.0, 0.4])


def test_what_straight_driving_does_not_tell_is_said() -> None:
    t = np.arange(0.0, 30.0, 0.05)
    v = 0.5 * np.sign(np.sin(t))
    made = Recording("made", commands=np.column_stack([t, v, 0 * t]), wheels=np.column_stack([t, v, v]))
    late = {"actuators.delay": 0.25, "actuators.lag": 0.15}
    made = replace(made, wheels=controlled(with_values(HUSKY, late.items()), made))
    told = {one.key: one for one in response(HUSKY, made)}
    assert {key: told[key].after for key in late} == pytest.approx(late, rel=0.02)
    assert told["controller_separation"].why == "turns are missing"
    assert not told["actuators.turn_limit"].is_known


@pytest.mark.parametrize(
    ("spots", "errors", "why"),
    [
        (3, (0.0, 0.0, 0.0, 0.3, -0.3, 0.0), "too vague"),  # straight on, where rolling is told alone
        (5, (0.0,) * 6, "driving straight on is missing"),  # but for once, which is not written
    ],
)
def test_what_is_not_told_widens_the_intervals_of_what_takes_on_its_effect(
    spots: int, errors: tuple[float, ...], why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    nothing, side, is_spot = np.full(6, np.nan), np.array([0.5] * 6), np.arange(6) < spots

    def driven(rover: RoverSpec, like: Steady) -> Steady:
        on, spot = 2.0 * of(rover, "tyres.rolling"), 10.0 * of(rover, "tyres.friction")
        current = np.where(is_spot, spot + 5.0 * on, on)
        return replace(like, left_current=current, right_current=current)

    monkeypatch.setattr("harness.fit.ground.driven", driven)
    left = np.where(is_spot, -side, side)
    blank = Steady(side, left, side, nothing, nothing, nothing, nothing, np.ones(6))
    true = driven(with_values(HUSKY, [("tyres.friction", 0.8), ("tyres.rolling", 0.1)]), blank)
    some = replace(
        true, left_current=true.left_current + errors, right_current=true.right_current + errors
    )
    found = {one.key: one for one in ground(HUSKY, some, some, workers_of("local", jobs=1), Mock())[0]}
    rolling, friction = found["tyres.rolling"], found["tyres.friction"]
    assert why in rolling.why
    assert 0.05 < friction.after - 0.8 < friction.half  # it has taken on what rolling would be


def test_the_mount_of_an_imu_is_that_of_its_forces() -> None:
    t, (roll, pitch, yaw), (x, y) = np.arange(0.0, 60.0, 0.01), (0.03, -0.05, 0.4), (0.2, -0.1)
    moves = (t > 10.0).astype(float)
    v, dv = moves * np.sin(t - 10.0), moves * np.cos(t - 10.0)
    w, dw = moves * np.sin(0.7 * (t - 10.0)), 0.7 * moves * np.cos(0.7 * (t - 10.0))
    force = np.column_stack([dv - w**2 * x - dw * y, v * w + dw * x - w**2 * y, np.full(t.size, 9.81)])
    turned = Rotation.from_euler("xyz", (roll, pitch, yaw)).inv()
    biased = np.column_stack([0 * t + 0.01, 0 * t - 0.02, w + 0.1])  # as gyros are
    rates = turned.apply(biased)
    imu = np.column_stack([t, rates, turned.apply(force)])
    found = mount(HUSKY, Recording("made", wheels=np.column_stack([t, v - w / 2, v + w / 2]), imu=imu))
    told = {one.key: one.after for one in found}
    assert list(told.values()) == pytest.approx([roll, pitch, yaw, x, y], abs=0.01)


@pytest.mark.parametrize(("robot", "motors_a_side"), [("husky", 1), ("leo", 2)])
def test_torques_currents_and_power_tell_the_constants(robot: str, motors_a_side: int) -> None:
    rover = equipped(ROVERS[robot], REAL, "")
    t = np.arange(0.0, 40.0, 0.1)
    left, right, speed = 5.0 + (t // 5), 9.0 - (t // 8), 0.2 + 0.4 * (t // 4 % 3)
    right = right + np.where(t > 32.0, 3.0 * np.cos(10.0 * np.pi * t), 0.0)  # which means hide
    constant, resistance, standby = 2.5, 1.5, 20.0
    turning, lost = speed / rover.controller_radius, resistance * (left**2 + right**2) / motors_a_side
    power = constant * turning * (left + right) + lost + standby
    made = Recording(
        "made", wheels=np.column_stack([t, speed, speed]), currents=np.column_stack([t, left, right]),
        power=np.column_stack([t, power]),
    )  # fmt: skip
    forces = constant * made.currents[:, 1:]
    for one in (made, replace(made, torques=np.column_stack([t, forces]))):
        assert [e.after for e in motors(rover, one)] == pytest.approx([constant, resistance], rel=0.01)


@pytest.mark.parametrize(("robot", "sway"), [("leo", 0.0), ("husky", 3.0)])
def test_motors_that_never_drive_straight_or_steadily_tell_nothing(robot: str, sway: float) -> None:
    t = np.arange(0.0, 20.0, 0.1)
    currents = np.column_stack([t, 5.0 + sway * np.sin(9 * t), 9.0 - sway * np.sin(9 * t)])
    made = Recording(
        "made", wheels=np.column_stack([t, 0.2 + 0 * t, 0.5 + 0 * t]), currents=currents,
        power=np.column_stack([t, 100.0 + 0 * t]),
    )  # fmt: skip
    assert not any(one.is_known for one in motors(equipped(ROVERS[robot], REAL, ""), made))


def test_a_bag_holds_the_series_of_its_topics(tmp_path: Path) -> None:
    store = get_typestore(Stores.LATEST)
    types = store.types
    header, time = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    vector, twist = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Twist"]
    names = [*HUSKY.wheel_joints]
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        kinds = {"/cmd_vel": "geometry_msgs/msg/Twist", "/other/cmd_vel": "geometry_msgs/msg/Twist",
                 "/joint_states": "sensor_msgs/msg/JointState",
                 "/goal_pose": "geometry_msgs/msg/PoseStamped",
                 "/localisation": "geometry_msgs/msg/PoseStamped",
                 "/camera/imu": "sensor_msgs/msg/Imu"}  # fmt: skip
        to = {
            topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in kinds.items()
        }
        for n in range(1, 400):
            stamp, turn = n * 5 * 10**7, vector(0.0, 0.0, 0.2)
            joints = types["sensor_msgs/msg/JointState"](
                header(time(*divmod(stamp, 10**9)), ""), names, np.zeros(4),
                np.full(4, 2.0 - 4 * (n > 200)), np.array([7.0, -1.0, 3.0, 3.0]),
            )  # fmt: skip
            level, point = types["geometry_msgs/msg/Quaternion"], types["geometry_msgs/msg/Point"]
            goal, pose = (
                types["geometry_msgs/msg/PoseStamped"](
                    header(time(*divmod(stamp, 10**9)), ""),
                    types["geometry_msgs/msg/Pose"](point(x, 0.0, 0.0), level(0.0, 0.0, 0.0, 1.0)),
                )
                for x in (9.0, 0.01 * n)
            )
            nothing, unknown = vector(0.0, 0.0, 0.0), np.array([-1.0, *np.zeros(8)])
            gyroscope = types["sensor_msgs/msg/Imu"](
                header(time(*divmod(stamp, 10**9)), ""), level(0.0, 0.0, 0.0, 1.0), unknown,
                turn, np.zeros(9), nothing, unknown,
            )  # fmt: skip
            said = {"/cmd_vel": twist(vector(0.5, 0.0, 0.0), turn), "/joint_states": joints,
                    "/camera/imu": gyroscope,
                    "/goal_pose": goal, "/localisation": pose,
                    "/other/cmd_vel": twist(vector(0.7, 0.0, 0.0), turn)}  # fmt: skip
            for topic, message in said.items():
                writer.write(to[topic], stamp, store.serialize_cdr(message, kinds[topic]))
    found = recording_of_bag(tmp_path / "bag", HUSKY)
    assert found.poses[:, 1] == pytest.approx(0.01 * np.arange(1, 400)), (
        "where it is to be is not where it is"
    )
    assert (found.sources["poses"], found.sources["commands"]) == ("/localisation", "/cmd_vel")
    assert found.commands[0] == pytest.approx([0.05, 0.5, 0.2])
    assert found.wheels[0] == pytest.approx([0.05, *[2.0 * HUSKY.controller_radius] * 2])
    assert found.torques[0, 1:] == pytest.approx([6.0, 6.0])
    assert "imu" not in found.series, "what it does not measure is no acceleration of 0"
    assert found.torques[-1, 1:] == pytest.approx([0.0, 0.0]), "wheels are dragged against their motors"
    other = recording_of_bag(tmp_path / "bag", HUSKY, {"commands": "/other/cmd_vel"})
    assert other.commands[0, 1] == pytest.approx(0.7)


@pytest.mark.parametrize("said", [np.nan, 0.0])
def test_a_dead_encoder_gives_way_to_odometry_or_is_told(tmp_path: Path, said: float) -> None:
    store = get_typestore(Stores.LATEST)
    types, joints, odometry = store.types, "sensor_msgs/msg/JointState", "nav_msgs/msg/Odometry"
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](1, 0), "")
    vector, zero = types["geometry_msgs/msg/Vector3"], np.zeros(36)
    twist = types["geometry_msgs/msg/Twist"](vector(0.4, 0.0, 0.0), vector(0.0, 0.0, 0.0))
    level = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    pose = types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](0.0, 0.0, 0.0), level)
    speeds = np.array([said, 2.0, 2.0, 2.0])
    messages = {
        joints: types[joints](header, [*HUSKY.wheel_joints], np.zeros(4), speeds, np.zeros(4)),
        odometry: types[odometry](
            header,
            "base",
            types["geometry_msgs/msg/PoseWithCovariance"](pose, zero),
            types["geometry_msgs/msg/TwistWithCovariance"](twist, zero),
        ),
    }
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        for kind, message in messages.items():
            topic = writer.add_connection(f"/{kind[-8:]}_odom", kind, typestore=store)
            writer.write(topic, 10**9, store.serialize_cdr(message, kind))
    if said == 0.0:
        with pytest.raises(UsageError, match="its encoder is dead"):
            recording_of_bag(tmp_path / "bag", HUSKY)
        return
    assert recording_of_bag(tmp_path / "bag", HUSKY).wheels[0, 1:] == pytest.approx([0.4, 0.4])


@pytest.mark.parametrize(
    "stamps", ["none", "of another clock", "all but the first", "the first before it was set"]
)
def test_what_has_no_stamp_is_put_on_the_clock_of_what_has_one(
    stamps: str, tmp_path: Path, capsys: Capsys
) -> None:
    """Commands named otherwise, on the clock of a recorder that is 0.4 s ahead of the rover's."""
    store = get_typestore(Stores.LATEST)
    types, bag, begin, late = store.types, tmp_path / "bag", 1_700_000_000, 0.4
    twist, joints = "geometry_msgs/msg/Twist", "sensor_msgs/msg/JointState"
    twist = twist if stamps == "none" else "geometry_msgs/msg/TwistStamped"
    vector = types["geometry_msgs/msg/Vector3"]
    with Writer(bag, version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        commands = writer.add_connection("/drive", twist, typestore=store)
        states = writer.add_connection("/joint_states", joints, typestore=store)
        for n in range(300):
            recorded, speed = round((begin + 0.05 * n + late) * 1e9), float(n >= 150)
            said = types["geometry_msgs/msg/Twist"](vector(speed, 0.0, 0.0), vector(0.0, 0.0, 0.0))
            time = types["builtin_interfaces/msg/Time"]
            own = recorded - round(late * 1e9)
            header = types["std_msgs/msg/Header"](time(*divmod(own, 10**9)), "")
            if stamps != "none":
                first = 0 if stamps == "all but the first" else 5 * 10**9
                own = own - 1_000 * 10**9 if stamps == "of another clock" else own if n else first
                own_header = types["std_msgs/msg/Header"](time(*divmod(own, 10**9)), "")
                said = types[twist](own_header, said)
            writer.write(commands, recorded, store.serialize_cdr(said, twist))
            four = np.full(4, speed / HUSKY.controller_radius)
            state = types[joints](header, [*HUSKY.wheel_joints], np.zeros(4), four, np.zeros(4))
            writer.write(states, recorded, store.serialize_cdr(state, joints))
    chosen = read([bag], HUSKY, {"commands": "/drive"})
    turned, commanded = (series[series[:, 1] > 0.5, 0][0] for series in (chosen.wheels, chosen.commands))
    assert turned - commanded == pytest.approx(0.0, abs=0.01)
    assert chosen.wheels[-1, 0] == pytest.approx(300 * 0.05, abs=0.11)
    words = [str(bag), "--robot", "husky", "--out", str(tmp_path / "out"), "--topic"]
    assert "no commands can be read of /joint_states" in complaint(
        main, [*words, "commands=/joint_states"], capsys
    )
    words[2] = "leo"
    assert ROVERS["leo"].wheel_joints[0] in complaint(main, [*words, "commands=/drive"], capsys)


def test_a_bag_that_is_cut_off_is_said_to_be(tmp_path: Path) -> None:
    store = get_typestore(Stores.LATEST)
    twist, vector = "geometry_msgs/msg/Twist", store.types["geometry_msgs/msg/Vector3"]
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/cmd_vel", twist, typestore=store)
        said = store.types[twist](vector(0.5, 0.0, 0.0), vector(0.0, 0.0, 0.0))
        for n in range(1, 3000):
            writer.write(connection, n * 10**7, store.serialize_cdr(said, twist))
    assert recording_of_bag(tmp_path / "bag", HUSKY).problems == ()
    (file,) = (tmp_path / "bag").glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 4])
    cut = recording_of_bag(tmp_path / "bag", HUSKY)
    assert "has no end" in cut.problems[0]
    assert len(cut.commands) > 100


@pytest.mark.parametrize("key", TRUE)
def test_a_value_that_is_fitted_is_the_rovers_and_wheels_that_grow_lift_it(key: str) -> None:
    value = 1.1 * of(HUSKY, key) or 0.1
    grown = with_values(HUSKY, [(key, value)])
    assert of(grown, key) == value
    assert grown.rest_height - grown.wheel_radius == pytest.approx(
        HUSKY.rest_height - HUSKY.wheel_radius
    )


@pytest.mark.parametrize("parameters", [1, 3, 6])
def test_intervals_are_as_wide_as_what_is_estimated_scatters(parameters: int) -> None:
    rng, errors, said = np.random.default_rng(parameters), [], []
    for _ in range(500):
        columns, noise = rng.normal(size=(120, parameters)), rng.normal(size=120)
        errors.append(np.linalg.pinv(columns) @ noise)
        said.append(CERTAIN * deviations(columns, noise - columns @ errors[-1]))
    assert np.mean(np.abs(errors) < said) == pytest.approx(0.95, abs=0.025)
