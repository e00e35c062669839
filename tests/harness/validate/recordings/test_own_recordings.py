"""A bag of ours tells the rover that drove, and a CSV file the same in whatever words and units."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import constants
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.episode.direct import run_direct
from harness.episode.result import Outputs
from harness.fit.estimate import of
from harness.fit.motors import motors
from harness.fit.mount import mount
from harness.robots import REAL, ROVERS, equipped
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.validate.recordings.bags import recording_of_bag
from harness.validate.recordings.recording import Recording, at
from harness.validate.recordings.tables import recording_of

DRIVE = [(1.0, 0.5, 0.5), (4.0, -0.3, 0.0), (6.0, 0.0, -0.9), (8.0, 0.4, -0.3)]
TURN, MINUTE = 2.0 * np.pi, constants.minute
# Of each column: another word for it, what it is in, and that in SI units, by scipy.
COLUMNS = {
    "commands": (("linear_x", "ft/s", constants.foot), ("angular_z", "deg/s", constants.degree)),
    "wheels": (("v_left", "mph", constants.mph), ("v_right", "km/h", constants.kmh)),
    "currents": (("i_left", "mA", constants.milli), ("i_right", "A", 1.0)),
    "torques": (("left_effort", "Nm", 1.0), ("right_effort", "N m", 1.0)),
    "imu": (
        ("gyro_x", "dps", constants.degree), ("gyro_y", "rpm", TURN / MINUTE), ("gyro_z", "rad/s", 1.0),
        ("acc_x", "g", constants.g), ("acc_y", "mg", constants.milli * constants.g),
        ("acc_z", "m/s^2", 1.0),
    ),
    "poses": (("px", "mm", constants.milli), ("py", "cm", constants.centi),
              ("heading", "deg", constants.degree)),
    "power": (("battery_power", "W", 1.0),),
}  # fmt: skip
TIMES = ("s", 1.0), ("ms", constants.milli), ("us", constants.micro), ("ns", constants.nano)


@pytest.mark.parametrize(
    "robot", ["leo", "rover_zero4wd", "jackal"]
)  # with two motors a side and with one
def test_a_recorded_run_tells_its_rover(robot: str, tmp_path: Path) -> None:
    bag, rover = tmp_path / "run.mcap", equipped(ROVERS[robot], REAL, "")
    run = Run.of(robot=robot, terrain="maze", duration=10.0, lidar_beams=8, driver="cmd_vel",
                 actuators="real", sensors=["battery"], commands=DRIVE)  # fmt: skip
    outputs = [Outputs(log_dir=tmp_path)]
    run_direct(run, outputs, RosOptions(log_dir=tmp_path, record=bag), StopRequest())
    told = recording_of_bag(bag, rover)
    turned = recording_of_bag(bag, rover, {"wheels": "/odometry/wheels"})
    assert turned.sources["wheels"] != told.sources["wheels"]
    times = np.arange(1.5, 10.0, 0.1)
    joints, odometry = (at(one.wheels, times) for one in (told, turned))
    assert np.abs(joints - odometry).mean(axis=0) == pytest.approx(0.0, abs=0.02)
    assert np.abs(joints).sum() == pytest.approx(np.abs(odometry).sum(), rel=0.005)
    assert np.ptp(joints[:, 1] - joints[:, 0]) > 0.2
    (t, x, y, yaw), felt = told.poses.T, told.imu
    assert np.ptp(yaw) > 0.3
    assert np.interp(felt[:, 0], t, yaw - yaw[0]) == pytest.approx(
        np.concatenate([[0.0], np.cumsum(np.diff(felt[:, 0]) * felt[1:, 3])]), abs=0.05
    )
    gone = np.cumsum(np.diff(x) * np.cos(yaw[:-1]) + np.diff(y) * np.sin(yaw[:-1]))
    rolled = np.cumsum(np.diff(told.wheels[:, 0]) * told.wheels[1:, 1:].mean(axis=1))
    assert np.ptp(gone) > 1.0
    assert np.interp(t[1:], told.wheels[1:, 0], rolled) == pytest.approx(gone, abs=0.1)
    for torques in (told.torques, told.torques[:0]):
        for one in motors(rover, replace(told, torques=torques)):
            # Two motors share the current of a side unequally in turns: driving straight on must tell.
            assert one.is_known or robot == "leo"
            assert not one.is_known or one.after == pytest.approx(
                of(rover, one.key), rel=0.01, abs=one.half
            )
    known = [one for one in mount(rover, told) if one.is_known]
    assert [one.after for one in known] == pytest.approx([one.before for one in known], abs=0.05)
    assert len(known) >= 2


def made() -> Recording:
    rng, t = np.random.default_rng(3), np.arange(200) / 20
    series = {
        name: np.column_stack([t, rng.uniform(-1.0, 1.0, (t.size, len(columns)))])
        for name, columns in COLUMNS.items()
    }
    series["poses"][:, 3] += t  # turns on past pi
    return Recording("drive", **series)  # type: ignore[arg-type]  # of series alone


@pytest.mark.parametrize("written", ["{} ({})", "{}_{}"], ids=["apart", "as one word"])
@pytest.mark.parametrize(("unit", "seconds"), TIMES)
def test_a_column_is_the_same_in_other_words_and_units(
    unit: str, seconds: float, written: str, tmp_path: Path
) -> None:
    drive, file = made(), tmp_path / "drive.csv"

    def called(name: str, unit: str) -> str:
        is_word = "(" not in written
        return written.format(name, re.sub(r"[/^ ]", "_", unit) if is_word else unit)

    table = {called("Time", unit): drive.wheels[:, 0] / seconds}
    for name, columns in COLUMNS.items():
        values = getattr(drive, name)[:, 1:].T
        table |= {called(c, u): one / si for (c, u, si), one in zip(columns, values, strict=True)}
    pd.DataFrame(table).to_csv(file, index=False)
    read = recording_of([file], "drive", 0.1)
    assert read.series.keys() == COLUMNS.keys()
    for name, values in read.series.items():
        assert values == pytest.approx(getattr(drive, name), abs=1e-6), name


def test_sides_that_turn_roll_by_the_radius_and_an_attitude_is_a_heading(tmp_path: Path) -> None:
    drive, file = made(), tmp_path / "drive.csv"
    (t, left, right), yaw, at_all = drive.wheels.T, drive.poses[:, 3], np.full((200, 2), 0.1)
    x, y, z, w = Rotation.from_euler("ZYX", np.column_stack([yaw, at_all])).as_quat().T
    table = {"secs": t, "left [rpm]": left / 0.25 * MINUTE / TURN, "omega_right": right / 0.25}
    turned = {"x": drive.poses[:, 1], "y": drive.poses[:, 2], "qx": x, "qy": y, "qz": z, "qw": w}
    rows = pd.DataFrame(table | turned)  # of a time that comes twice the first counts
    rows = pd.concat([rows, rows[50:90].assign(omega_right=9.0)]).sort_values("secs", kind="stable")
    rows.to_csv(file, index=False)
    read = recording_of([file], "drive", 0.25)
    assert read.wheels == pytest.approx(drive.wheels, abs=1e-6)
    assert read.poses == pytest.approx(drive.poses, abs=1e-6)


@pytest.mark.parametrize("column", ["left [A]", "t [m]", "wz [m/s]"])
def test_a_unit_of_another_quantity_is_refused(column: str, tmp_path: Path) -> None:
    file = tmp_path / "drive.csv"
    file.write_text(f"{column},right,time\n1,2,3\n4,5,6\n")
    with pytest.raises(UsageError, match="unit"):
        recording_of([file], "drive", 0.1)


def test_the_end_of_a_name_is_a_unit_only_of_its_quantity(tmp_path: Path) -> None:
    file = tmp_path / "drive.csv"
    file.write_text("time_ms,left_speed_ms,right_speed_mps,left_a,x_s\n0,1,2,3,4\n500,1,2,3,4\n")
    assert recording_of([file], "drive", 0.1).wheels.tolist() == [[0.0, 1.0, 2.0], [0.5, 1.0, 2.0]]
