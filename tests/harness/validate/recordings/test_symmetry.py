"""What is told of a rover depends neither on when and where it was recorded, nor on left and right."""

from collections.abc import Callable
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from harness.fit.likely import likely
from harness.fit.motors import motors
from harness.fit.mount import mount
from harness.fit.outcome import split
from harness.fit.reading import read
from harness.fit.response import difference
from harness.fit.steady import LENGTH, kinds, steady
from harness.robots import REAL, ROVERS, RoverSpec, equipped
from harness.validate.real.commanded import as_driven, response_times, step_ends
from harness.validate.real.windows import windows
from harness.validate.recordings.recording import Recording, Series, at, lag, moved

HUSKY = equipped(ROVERS["husky"], REAL, "flooring")
TWISTS = np.array([(0.0, 0.0), (0.6, 0.0), (0.0, 0.9), (-0.5, 0.4), (0.0, -0.7), (0.4, -0.8),
                   (-0.8, 0.0), (0.3, 0.5), (0.5, 0.0)])  # fmt: skip
SPAN, LATE, TRACK, CONSTANT, RESISTANCE = 5.0, 0.25, 1.2, 1.9, 0.4
MOUNT, BESIDE = (0.2, -0.1), np.array([0.15, 0.25])  # of the IMU, and of what tells the poses [m]
MIRROR = {  # columns of each series, and their signs
    "commands": ([0, 1, 2], [1, 1, -1]), "imu": ([*range(7)], [1, -1, 1, -1, 1, -1, 1]),
    "poses": ([0, 1, 2, 3], [1, 1, -1, -1]), "power": ([0, 1], [1, 1]), "steps": ([0, 1], [1, 1]),
    **dict.fromkeys(("wheels", "currents", "torques"), ([0, 2, 1], [1, 1, 1])),
}  # fmt: skip
# Of steps in time, of bins of time, of medians of x and of y.
GRAIN = {"lag": 0.051, "mount": 5e-3, "ends": 4e-3}
Told = dict[str, Series]


def changed(recording: Recording, series: dict[str, Series]) -> Recording:
    return replace(recording, **series)  # type: ignore[arg-type]  # of series alone


def kinematics(rover: RoverSpec, commands: Series, end: float, late: float = 0.1) -> Recording:
    """A drive in closed form, of which everything differs from side to side."""
    t = np.arange(0.01, end, 0.01)
    held = at(commands, t - late) * (t[:, None] > late)
    v, w = (np.convolve(one, np.ones(30) / 30.0)[: t.size] for one in held.T)  # as motors follow
    half, rate = 0.5 * rover.controller_separation * w, rover.controller_separation * w / TRACK
    yaw = 0.01 * np.cumsum(rate)
    x, y = (0.01 * np.cumsum(v * of(yaw)) for of in (np.cos, np.sin))
    swung = Rotation.from_euler("z", yaw[:, None]).as_matrix()[:, :2, :2] @ BESIDE
    dv, dw = np.gradient(v, 0.01), np.gradient(rate, 0.01)
    ahead = dv - rate**2 * MOUNT[0] - dw * MOUNT[1]
    left = v * rate + dw * MOUNT[0] - rate**2 * MOUNT[1]
    up = 9.81 + 0.2 * np.sin(2 * np.pi * 7.0 * t) * (np.abs(v) > 0.0)
    tilt = Rotation.from_euler("xyz", (0.03, -0.05, 0.4)).inv()
    felt = (np.column_stack([0 * t + 0.01, 0 * t - 0.02, rate]), np.column_stack([ahead, left, up]))
    sides = np.column_stack([v - half, v + half])
    currents = 3.0 + 8.0 * np.abs(sides) + [0.5, 0.0]
    work = (CONSTANT * currents * np.abs(sides) / rover.controller_radius).sum(axis=1)
    power = work + RESISTANCE * (currents**2).sum(axis=1) + 20.0
    poses = np.column_stack([x + swung[:, 0], y + swung[:, 1], yaw])
    logged = {"wheels": sides, "currents": currents, "torques": CONSTANT * currents, "poses": poses,
              "power": power}  # fmt: skip
    series = {name: np.column_stack([t, values])[::5] for name, values in logged.items()}
    series["imu"] = np.column_stack([t, *(tilt.apply(one) for one in felt)])
    return changed(Recording("made", "flooring", commands=commands), series)


def drive() -> Recording:
    begins = SPAN * np.arange(len(TWISTS))
    made = kinematics(HUSKY, np.column_stack([begins, TWISTS]), SPAN * len(TWISTS), late=LATE)
    return replace(made, steps=np.column_stack([begins[1:] + 0.5, begins[1:] + 4.5]))


def told(recording: Recording) -> Told:
    """All that fits and comparisons compute of a recording, but for what drives ours."""
    some, (fitted, held) = steady(recording), split(recording)
    own = as_driven(HUSKY, recording)
    assert (np.diff(some.begin) >= LENGTH - 1e-9).all()  # none is counted twice
    assert held is not None
    assert own.actuators is not None
    return {
        "steady": some.table,
        "kinds": kinds(some).table,
        "windows": np.array([astuple(one)[1:] for one in windows(recording)]),
        "response times": response_times(recording),
        "driver": np.array([own.controller_separation, own.actuators.turn_limit or 0.0]),
        "motors": np.array([one.after for one in motors(HUSKY, recording)]),
        "mount": np.array([one.after for one in mount(HUSKY, recording)]),
        "lag": np.array([lag(replace(recording, imu=moved(recording.imu, LATE)), TRACK) or 0.0]),
        "problems": np.array([len(likely(recording, HUSKY).problems)]),
        "ends": step_ends(HUSKY, recording),
        "split": np.concatenate([fitted.steps, held.steps]),
    }


def mirrored(recording: Recording) -> Recording:
    sides = MIRROR.items()
    return changed(
        recording, {name: getattr(recording, name)[:, of] * signs for name, (of, signs) in sides}
    )


def later(recording: Recording) -> Recording:
    series = {name: moved(values, 64.0) for name, values in recording.series.items()}
    return changed(recording, series | {"steps": recording.steps + 64.0})


def elsewhere(recording: Recording) -> Recording:
    poses, turn = recording.poses.copy(), Rotation.from_euler("z", 2.5).as_matrix()[:2, :2]
    poses[:, 1:3] = poses[:, 1:3] @ turn.T + [40.0, -7.0]
    poses[:, 3] += 2.5
    return replace(recording, poses=poses)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (elsewhere, lambda told: told),
        (
            later,
            lambda told: (
                told
                | {name: told[name] + 64.0 * np.eye(1, 8) for name in ("steady", "kinds")}
                | {"split": told["split"] + 64.0}
            ),
        ),
        (
            mirrored,
            lambda told: (
                told
                | {
                    name: told[name][:, [0, 2, 1, 3, 4, 6, 5, 7]] * [1, 1, 1, -1, 1, 1, 1, 1]
                    for name in ("steady", "kinds")
                }
                | {"windows": told["windows"] * [1, -1, -1, 1, 1, 1]}
                | {"mount": told["mount"] * [-1, 1, -1, 1, -1]}
            ),
        ),
    ],
    ids=["elsewhere", "later", "mirrored"],
)
def test_what_is_told_is_the_same(
    change: Callable[[Recording], Recording],
    expected: Callable[[Told], Told],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("harness.validate.real.commanded.replay", kinematics)
    one, other = told(drive()), told(change(drive()))
    for name, values in expected(one).items():
        assert np.isfinite(values).all(), name
        # Kinds that are as frequent come in the order of their speeds.
        rows, own = (np.unique(v, axis=0) if name == "kinds" else v for v in (other[name], values))
        assert rows == pytest.approx(own, rel=1e-3, abs=GRAIN.get(name, 1e-6)), name


def test_wheels_poses_and_an_imu_tell_the_same_of_a_turn() -> None:
    made = drive()
    some, felt = steady(made), steady(replace(made, poses=made.poses[:0]))
    assert np.ptp(some.yaw_rate) > 1.0
    assert some.yaw_rate == pytest.approx(some.difference / TRACK, abs=1e-3)
    assert felt.yaw_rate == pytest.approx(some.yaw_rate, rel=0.01, abs=0.01)
    assert some.ahead == pytest.approx(some.mean - some.yaw_rate * BESIDE[1], abs=1e-3)
    # What is asked of a rover's controller has no side either.
    off, other = (difference(HUSKY, each).reshape(-1, 2) for each in (made, mirrored(made)))
    assert other[:, ::-1] == pytest.approx(off, abs=1e-9)


@pytest.mark.parametrize("late", [-0.2, 0.2])
def test_an_imu_on_another_clock_is_put_on_that_of_the_wheels(late: float, tmp_path: Path) -> None:
    made, names = drive(), ("t", "wx", "wy", "wz", "ax", "ay", "az")
    commands = at(made.commands, made.wheels[:, 0])
    wheels = dict(zip(("t", "left_speed", "right_speed"), made.wheels.T, strict=True))
    pd.DataFrame(wheels | {"cmd_v": commands[:, 0], "cmd_w": commands[:, 1]}).to_csv(tmp_path / "a.csv")
    pd.DataFrame(moved(made.imu, late), columns=names).to_csv(tmp_path / "b.csv")
    apart = [lag(made, TRACK), lag(read([tmp_path / "a.csv", tmp_path / "b.csv"], HUSKY, {}), TRACK)]
    assert apart == pytest.approx([0.0, 0.0], abs=GRAIN["lag"])


def test_what_was_not_recorded_changes_nothing_of_the_rest() -> None:
    whole = drive()
    bare = Recording("made", "flooring", commands=whole.commands, wheels=whole.wheels)
    same = replace(whole, imu=bare.imu, poses=bare.poses, currents=bare.currents)
    for one in (bare, same):
        found, expected = (np.array([astuple(w)[1:] for w in windows(each)]) for each in (one, whole))
        assert found.shape == expected.shape
        known = np.isfinite(found)
        assert known[:, :2].all()
        assert found[known] == pytest.approx(expected[known])
