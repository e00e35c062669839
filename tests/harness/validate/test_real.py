"""Ours beside recordings: measures against closed forms, files of strangers, and the shared halves."""

import gzip
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.robots import REAL, ROVERS, RoverSpec, equipped
from harness.validate.__main__ import main
from harness.validate.real.commanded import as_driven, response_times, step_ends
from harness.validate.real.table import compare
from harness.validate.real.windows import SPOT, aligned, effective_track, windows
from harness.validate.recordings.recording import Recording, Series, at, moved
from harness.validate.recordings.tables import recordings_of
from tests.support.complaint import complaint

HUSKY = ROVERS["husky"]
REAL_HUSKY = equipped(HUSKY, REAL, "flooring")
SHARED = Path(__file__).parents[4] / "shared" / "data"


def steady(left: float, right: float, hertz: float = 5.0, sd: float = 0.5) -> Recording:
    """Twenty seconds of which all is known; az is a line at a frequency."""
    t, fast = np.arange(0, 20, 0.15), np.arange(0, 20, 0.01)
    wheels = np.column_stack([t, np.full_like(t, left), np.full_like(t, right)])
    turning, az = (
        np.full_like(fast, (right - left) / 1.1),
        9.8 + sd * np.sqrt(2) * np.sin(2 * np.pi * hertz * fast),
    )
    nothing = np.zeros_like(fast)
    imu = np.column_stack([fast, nothing, nothing, turning, nothing, nothing, az])
    return Recording(
        "made", "flooring", wheels=wheels, currents=wheels * [1, 0, 0] + [0, 2.0, 3.0], imu=imu
    )


def test_the_track_is_that_of_the_turns_and_one_that_is_held_tells_none() -> None:
    turning = list(windows(steady(-0.25, 0.25)))
    assert {one.kind for one in turning} == {SPOT}
    assert effective_track(turning, 1.03) == pytest.approx(1.1, rel=1e-6)
    yawing = steady(0.5, 0.5)
    yawing.imu[:, 3] = 0.2
    assert [*windows(yawing)] == [], "what turns is not straight on, whatever its wheels say"
    held = steady(-0.25, 0.25)
    held.imu[:, 3] *= 0.2
    assert np.isnan(effective_track(windows(held), 1.03))


def test_each_side_answers_from_its_own_speed_before() -> None:
    t, lag = np.arange(0.0, 12.0, 0.01), 0.15
    moved = 0.4 * -np.expm1(-np.maximum(t - 6.0, 0.0) / lag)
    made = Recording(
        "made",
        commands=np.array([[0.0, 0.5, 0.5], [6.0, 0.5, -0.2]]),
        wheels=np.column_stack([t, 0.2 + moved, 0.8 - moved]),
    )
    assert response_times(made) == pytest.approx(-lag * np.log1p([-0.1, -0.63, -0.9]), abs=0.011)


def closed_form(rover: RoverSpec, commands: Series, end: float, *, seed: int = 0) -> Recording:
    """A rover by kinematics alone: 0.3 s late, a track of 1.2 m, 0.4 m/s^2 sd, more current in turns."""
    t = np.arange(0.01, end + 1e-9, 0.01)
    v, w = at(commands, t - 0.3).T * (t >= 0.3)
    half = 0.5 * rover.controller_separation * w
    rate = 2.0 * half / 1.2
    yaw = np.cumsum(rate) * 0.01
    middle = yaw - 0.005 * rate
    x, y = (np.cumsum(v * of(middle)) * 0.01 for of in (np.cos, np.sin))
    zero, az = 0.0 * t, 9.8 + 0.4 * np.sqrt(2) * np.sin(2 * np.pi * (5.0 + seed) * t)
    imu = np.column_stack([t, zero, zero, rate, zero, zero, az])
    drawn = np.column_stack([t, 4.0 + 8.0 * np.abs(half), zero + 6.0])
    wheels, poses = np.column_stack([t, v - half, v + half]), np.column_stack([t, x, y, yaw])
    return Recording("ours", commands=commands, wheels=wheels, currents=drawn, imu=imu, poses=poses)


def test_a_table_is_that_of_two_rovers_in_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """Theirs: 0.5 m/s^2 sd, a track of 1.1 m, 5 A; ours of `closed_form`."""
    monkeypatch.setattr("harness.validate.real.table.replay", closed_form)
    there = ((0.3, 0.3), (0.6, 0.6, 20.0), (-0.25, 0.25), (0.2, 0.6))
    checks, notes = compare(HUSKY, [steady(*driving) for driving in there])
    constant = 5.0 / np.sqrt(10.0 * 11.6)  # of 10, 10, 12 and 11.6 A the median of logarithms
    assert notes == [f"currents of ours are times {constant:.2f}, which is fitted to theirs"]
    vibration = {"sd of az": (0.5, 0.4, "m/s2"), "share of 1 to 10 Hz": (1.0, 1.0, "")}
    limits = {
        "sd of az": lambda v: (v * np.exp(-0.3), v * np.exp(0.3)),
        "share of 1 to 10 Hz": lambda v: (v - 0.15, v + 0.15),
        "effective track": lambda v: (0.9 * v, 1.1 * v), "current": lambda v: (0.8 * v, 1.2 * v),
    }  # fmt: skip
    high = vibration | {"share of 1 to 10 Hz": (0.0, 1.0, "")}
    spot, arc, on = ({"current": (5.0, constant * ours, "A")} for ours in (12.0, 11.6, 10.0))
    turns = {"effective track": (1.1, 1.2, "m")}
    groups = {
        "straight at 0.30 m/s": vibration | on, "straight at 0.60 m/s": high | on,
        "on the spot": turns | spot, "in an arc": turns | arc,
    }  # fmt: skip
    told = {one.quantity: one for one in checks}
    expected = {f"flooring, {g}: {q}": (q, *v) for g, some in groups.items() for q, v in some.items()}
    assert told.keys() == expected.keys()
    for quantity, (kind, theirs, ours, unit) in expected.items():
        check = told[quantity]
        assert check.measured == pytest.approx(ours, rel=0.01), quantity
        assert (check.expected.low, check.expected.high) == pytest.approx(
            limits[kind](theirs), rel=0.01, abs=2e-3
        )
        assert (check.unit, "9 windows" in check.expected.source) == (unit, True)


def test_commanded_steps_of_two_rovers_in_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """Theirs is `closed_form` with poses beside the middle, which may be of twice the size."""
    monkeypatch.setattr("harness.validate.real.commanded.replay", closed_form)
    twists = np.array([(0.5, 0.0), (0.0, 0.6), (0.4, 0.4), (-0.5, 0.0), (0.3, -0.5), (0.6, 0.2)])
    begins, span, mount = 4.0 + 5.0 * np.arange(len(twists)), 3.5, np.array([0.2, 0.1])
    commands, steps = np.column_stack([begins - 1.0, twists]), np.column_stack([begins, begins + span])
    driver = REAL_HUSKY.but(controller_separation=1.3)
    own = closed_form(driver, moved(commands, -3.0), 30.0)
    turned = Rotation.from_euler("z", own.poses[:, [3]]).as_matrix()[:, :2, :2]
    beside = moved(own.poses, 3.0)
    beside[:, 1:3] += turned @ mount
    made = Recording("made", "flooring", commands=commands, wheels=moved(own.wheels, 3.0),
                     poses=beside, steps=steps)  # fmt: skip
    assert as_driven(REAL_HUSKY, made).controller_separation == pytest.approx(1.3, rel=1e-6)
    *late, median, within = (check.measured for check in compare(REAL_HUSKY, [made])[0])
    assert late == pytest.approx([0.3] * 3, abs=0.011)
    assert median < 3e-3
    assert within == 1.0

    v, w = twists.T
    swung = Rotation.from_euler("z", (w * span)[:, None]).as_matrix()[:, :2, :2] - np.eye(2)
    radius = v / np.where(w, w, 1.0)
    arcs = np.column_stack([radius * np.sin(w * span), radius * (1.0 - np.cos(w * span))])
    arcs[w == 0.0, 0] = v[w == 0.0] * span
    off = arcs + 2.0 * swung @ mount  # theirs, twice as large, less ours
    place = np.linalg.lstsq(swung.reshape(-1, 2), off.ravel(), rcond=None)[0]
    lengths = 2.0 * span * np.hypot(v - w * mount[1], w * mount[0])
    expected = np.linalg.norm(off - swung @ place, axis=1) / np.maximum(lengths, 1.0)
    larger = replace(made, poses=beside * [1.0, 2.0, 2.0, 1.0])
    assert step_ends(driver, larger) == pytest.approx(expected, rel=0.03, abs=0.01)


@pytest.mark.parametrize(("late", "begin"), [(-0.6, 0.0), (0.35, 0.0), (0.0, 1.7e9)])
def test_an_imu_on_another_clock_is_put_on_that_of_the_wheels(late: float, begin: float) -> None:
    t, felt = np.arange(0.02, 40.0, 0.02), np.arange(0.05, 40.0, 0.05)
    half, turn = (0.3 * np.sin(one) * np.sin(0.37 * one) for one in (t, felt))
    imu = np.zeros((felt.size, 7))
    imu[:, 0], imu[:, 3] = begin + felt + late, 2.0 * turn / 1.1
    drove = Recording("made", wheels=np.column_stack([begin + t, -half, half]), imu=imu)
    most = 0.051 if late else 1e-6
    assert aligned(drove, 1.1).imu[:, 0] - begin == pytest.approx(felt, abs=most)


def test_other_names_units_and_missing_columns_are_read_alike(tmp_path: Path) -> None:
    recorded = steady(0.3, 0.5)
    (tmp_path / "plain").mkdir()
    (tmp_path / "odd").mkdir()
    wheels, imu = recorded.wheels, recorded.imu
    names = ["t", "left_speed", "right_speed"]
    pd.DataFrame(wheels, columns=names).to_csv(
        tmp_path / "plain" / "flooring_00_wheels.csv", index=False
    )
    columns = ["t", "wx", "wy", "wz", "ax", "ay", "az"]
    pd.DataFrame(imu, columns=columns).to_csv(tmp_path / "plain" / "flooring_00_imu.csv", index=False)
    odd = {"Time [ms]": 1e3 * wheels[:, 0], "v_left [km/h]": 3.6 * wheels[:, 1]}
    odd |= {"v_right (km/h)": 3.6 * wheels[:, 2], "remark": np.ones(len(wheels))}
    pd.DataFrame(odd).to_csv(tmp_path / "odd" / "run7-wheels.csv.gz", index=False)
    felt = {
        "timestamp": 1e9 * imu[:, 0],
        "gyro_z [deg/s]": np.degrees(imu[:, 3]),
        "acc_z [g]": imu[:, 6] / 9.80665,
    }
    pd.DataFrame(felt).to_csv(tmp_path / "odd" / "run7-imu.csv", index=False)
    pd.DataFrame({"run": ["run7"], "ground": ["flooring"]}).to_csv(
        tmp_path / "odd" / "runs.csv", index=False
    )
    (plain,), (strange,) = (recordings_of(tmp_path / name, 0.1651) for name in ("plain", "odd"))
    assert (plain.ground, strange.ground) == ("flooring", "flooring")
    assert strange.wheels == pytest.approx(plain.wheels, rel=1e-5)
    assert strange.imu[:, [0, 3, 6]] == pytest.approx(plain.imu[:, [0, 3, 6]], rel=1e-4, abs=1e-6)


@pytest.mark.parametrize(
    ("head", "rows", "said"),
    [
        ("t,left_speed [knots],right_speed", "0,1,1\n1,1,1", "unit 'knots'"),
        ("t,left_speed,right_speed", "0,1,0,5,0,5\n0,2,0,5,0,5", "more values than its header"),
        ("t,wz", "0,28\n0.1,30", r"wz \[deg/s\]"),
        ("t,x,y,yaw", "0,0,0,28\n0.1,1,0,30", r"yaw \[deg\]"),
        ("t [s],left_speed,right_speed", "5,1,1\n6,1,1\n0,1,1", "time goes back by 6.0 s"),
        ("remark", "none", "holds no recording: ice_01.csv has 1 row of remark"),
        ("", "", "ice_01.csv holds nothing; give"),
        ("t", "\0", "ice_01.csv has bytes that are no text"),
        ("t,left_speed", "99999-99-99 99999999999,1\nx,2", "holds no recording"),
    ],
)
def test_a_file_that_would_mislead_is_one_line(head: str, rows: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "ice_01.csv").write_text(f"{head}\n{rows}\n")
    with pytest.raises(UsageError, match=said):
        recordings_of(tmp_path, 0.1)
    (tmp_path / "ice_01.csv.gz").write_bytes(gzip.compress(b"t,x,y,yaw\n" * 99)[:40])
    with pytest.raises(UsageError):
        recordings_of(tmp_path, 0.1)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("ending", ["\n", "\r\n", ",\n"])
@pytest.mark.parametrize("name", ["snow_1.csv", "snow_1.csv.gz"])
def test_a_file_is_read_whatever_separates_its_numbers(
    separator: str, decimal: str, ending: str, name: str, tmp_path: Path
) -> None:
    if decimal == separator:
        return  # is one of those that would mislead
    ending = ending.replace(",", separator)
    rows = [f"{0.1 * n:.1f},{0.5 + 0.01 * n:.2f},{0.6:.1f}".split(",") for n in range(30)]
    lines = [separator.join(row).replace(".", decimal) for row in rows]
    text = ending.join(["\ufefft,left_speed,right_speed".replace(",", separator), *lines, ""])
    data = text.encode()
    (tmp_path / name).write_bytes(gzip.compress(data) if name.endswith("gz") else data)
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.wheels == pytest.approx(np.array(rows, float))


def quoted(text: str) -> str:
    head, *rows = text.splitlines()
    cells = (row.replace(".", "*").replace(",", '","').replace("*", ",") for row in rows)
    return "\n".join([head, *(f'"{row}"' for row in cells)])


def with_apart_stamps(text: str) -> str:
    """As tools write messages of ROS into tables."""
    head, *rows = text.splitlines()
    cells = (row.partition(",") for row in rows)
    apart = (f"{int(float(t))},{round(float(t) % 1 * 1e9)},{rest}" for t, _, rest in cells)
    return "\n".join([head.replace("t,", "header.stamp.sec,header.stamp.nanosec,", 1), *apart])


@pytest.mark.parametrize(
    ("change", "encoding"),
    [
        (lambda text: text, "utf-16"),
        (lambda text: text, "utf-8-sig"),
        (lambda text: text.replace("\n", ",²\n").replace(",²", ",acc [m/s²]", 1), "cp1252"),
        (lambda text: text.replace("-", "\u2212"), "utf-8"),
        (lambda text: text.replace(",", "|"), "utf-8"),
        (lambda text: f"# of a rover, 2026\n# {text}", "utf-8"),
        (lambda text: f"# of a rover, 2026\n{text}", "utf-8"),
        (lambda text: f"sep=,\n{text}", "utf-8"),
        (lambda text: text.replace(",", " "), "utf-8"),
        (lambda text: f"# of a rover\n# {text.replace(',', '  ')}", "utf-8"),  # as of numpy
        (lambda text: text.replace("\n", ",7\n").replace(",7", ",t ", 1), "utf-8"),
        (quoted, "utf-8"),
        (with_apart_stamps, "utf-8"),
    ],
)
def test_a_file_is_read_however_programs_write_it(
    change: Callable[[str], str], encoding: str, tmp_path: Path
) -> None:
    rows = [(0.1 * n, 0.5 - 0.1 * n, 0.6) for n in range(30)]
    text = "\n".join(
        ["t,left_speed,right_speed", *("{:.2f},{:.2f},{:.2f}".format(*row) for row in rows)]
    )
    (tmp_path / "ice_1.csv").write_bytes(change(text).encode(encoding))
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.wheels == pytest.approx(np.array(rows))


@pytest.mark.parametrize("separator", [";", "\t"])
def test_commas_beside_decimal_points_are_of_thousands(separator: str, tmp_path: Path) -> None:
    rows = [(999.0 + 0.5 * n, 1234.0 * n, 1234.5 * n) for n in range(9)]
    lines = [separator.join((f"{t:,.1f}", f"{left:,.0f}", f"{right:,.1f}")) for t, left, right in rows]
    head = separator.join(("t [s]", "left_speed [mm/s]", "right_speed [mm/s]"))
    (tmp_path / "ice_1.csv").write_text("\n".join([head, *lines]))
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.wheels == pytest.approx(np.array(rows) * [1.0, 1e-3, 1e-3])


@pytest.mark.parametrize("hertz", [0.5, 1.0, 1.5])
def test_slow_rows_without_a_unit_are_seconds_or_dates(hertz: float, tmp_path: Path) -> None:
    t = 1.7e9 + np.arange(0.0, 300.0, 1 / hertz)
    dates = pd.to_datetime(t, unit="s").astype(str)
    of_python = [datetime.fromtimestamp(one, UTC).isoformat() for one in t]
    for times in (t, t - 1.7e9, dates, of_python):
        pd.DataFrame({"t": times, "wz": 0.1}).to_csv(tmp_path / "ice_1.csv", index=False)
        (one,) = recordings_of(tmp_path, 0.1)
        assert one.imu[:, 0] - one.imu[0, 0] == pytest.approx(t - t[0], abs=1e-5)


@pytest.mark.parametrize("hertz", [20.0, 200.0, 1000.0])
@pytest.mark.parametrize("unit", [1.0, 1e3, 1e6, 1e9])
def test_times_without_a_unit_are_told_by_how_far_they_are_apart(
    hertz: float, unit: float, tmp_path: Path
) -> None:
    t = np.arange(0.0, 2.0, 1 / hertz)
    pd.DataFrame({"t": unit * t, "wz": np.ones_like(t)}).to_csv(tmp_path / "office_1.csv", index=False)
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.imu[:, 0] == pytest.approx(t)
    assert np.isnan(one.imu[:, [1, 2, 4, 5, 6]]).all()  # what is missing is no zero
    with pytest.raises(UsageError, match="nothing in these"):  # an office is no ice
        compare(HUSKY, [Recording("a", one.ground, wheels=steady(0.5, 0.5).wheels)])


def test_wheels_that_turn_roll_and_the_ground_is_what_a_file_says(tmp_path: Path) -> None:
    head = "t [s],left_speed [rpm],right_speed [rpm],az [m/s^2],terrain"
    rows = "".join(f"{t},60,30,{1 + t % 2},asphalt\n" for t in range(9))
    (tmp_path / "07.csv").write_text(f"{head}\n{rows}")
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.ground == "asphalt"
    assert one.wheels[0, 1:] == pytest.approx([0.1 * np.pi * 2, 0.1 * np.pi])
    of_rims = head.replace("_speed [rpm]", "_wheel [m/s]")  # whatever they are called
    (tmp_path / "07.csv").write_text(f"{of_rims}\n{rows}")
    assert recordings_of(tmp_path, 0.1)[0].wheels[0, 1:].tolist() == [60.0, 30.0]
    (tmp_path / "07.csv").write_text(f"{head}\n{rows}")
    assert set(one.imu[:, 6]) == {1.0, 2.0}  # a unit that is told is not guessed
    (tmp_path / "runs.csv").write_text("run,ground\n07,ice\n")
    assert recordings_of(tmp_path, 0.1)[0].ground == "ice"


@pytest.mark.parametrize("gravity", [9.80665, 1.0, 1e3])
def test_gravity_tells_the_unit_and_a_pose_that_repeats_is_one(gravity: float, tmp_path: Path) -> None:
    t = np.arange(200) / 20
    table = {"t": t, "az": gravity, "x": np.floor(4 * t) / 10, "yaw": 0.0}
    table["field.pose.position.y"] = 0.0  # as rostopic names it
    pd.DataFrame(table).to_csv(tmp_path / "ice_1.csv", index=False)
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.imu[:, 6] == pytest.approx(9.80665)
    assert one.poses[:, 0] == pytest.approx(np.arange(40) / 4)


def test_of_a_step_that_was_paused_the_longest_part_counts(tmp_path: Path) -> None:
    table = pd.DataFrame({"t": np.arange(0.0, 12.0, 0.1), "left": 0.1, "right": 0.1, "step": 7})
    running = (table.t < 5.0) | table.t.between(6.95, 9.0)
    table.assign(state=np.where(running, "drive", "wait")).to_csv(tmp_path / "ice_1.csv", index=False)
    (one,) = recordings_of(tmp_path, 0.1)
    assert one.steps == pytest.approx(np.array([[0.0, 4.9]]))


def test_a_ground_is_of_the_surface_that_says_most_of_it() -> None:
    rover = HUSKY.but(surfaces={"grass": HUSKY.surfaces["ice"]} | dict(HUSKY.surfaces))
    checks, _ = compare(rover, [replace(steady(0.5, 0.5), ground="Wet-Grass 3")])
    assert {one.quantity.partition(",")[0] for one in checks} == {"wet_grass"}
    (current,) = (one for one in checks if one.quantity.endswith("current"))
    assert current.measured == pytest.approx(5.0)  # a constant that is fitted to one is met by it


def test_arguments_and_folders_that_will_not_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "--real needs --robot" in complaint(main, ["--real", str(tmp_path)], capsys)
    assert "holds no recording" in complaint(main, ["--robot", "husky", "--real", str(tmp_path)], capsys)
    assert main(["--robot", "husky", "--real", str(tmp_path / "none")]) == 0
    assert "nothing is compared" in capsys.readouterr().err
    with pytest.raises(UsageError, match="ground 'moon' is no surface"):
        compare(HUSKY, [Recording("a", "moon", wheels=steady(0.5, 0.5).wheels)])


@pytest.mark.skipif(not (SHARED / "borealtc").is_dir(), reason="the shared recordings are not here")
def test_the_shared_recordings_of_a_floor_are_met() -> None:
    """docs/real_rovers.md; other grounds take minutes: `harness.validate --robot husky --real`."""
    recordings = recordings_of(SHARED / "borealtc", HUSKY.controller_radius)
    checks, _ = compare(HUSKY, [one for one in recordings if one.ground == "flooring"])
    assert [one.quantity for one in checks if not one.passed] == []
    assert len(checks) == 5
