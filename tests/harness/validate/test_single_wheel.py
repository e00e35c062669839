"""A wheel drawn through soil beside trials: what a file may lack, and what the soil is worth."""

import math
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

from harness.base.errors import UsageError
from harness.robots import find_rover
from harness.soil.soils import SOILS
from harness.validate import pressing
from harness.validate.__main__ import main
from harness.validate.single_wheel import judge, predict, read_trials, stall_slope_deg

SAND = SOILS["dry_sand"]
OWN = "k_phi: 1.0e+6\nn: 1.0\nfriction_angle_deg: 30\nshear_length: 0.01\n"
COLUMNS = "lateral,wheel,wheel_speed,travel_speed,slip_angle_deg,tractive,load,sinkage,note"
# Means of three trials each of C. Pavlov, 2022 (3d-terramechanics, MIT): slip angle [deg], slip; of the
# smooth and the grousered wheel: tractive and lateral force, load [N], sinkage [mm].
MEANS = (
    (0, -0.70, (-24.1, 2, 21.8, 32), (-23.9, 1, 21.8, 32)),
    (0, -0.20, (-7.3, 1, 23.7, 15), (-7.6, 1, 23.8, 15)),
    (0, 0.0, (-1.3, 1, 24.6, 14), (-1.3, 0, 23.8, 16)),
    (0, 0.75, (0.8, 0, 24.0, 25), (3.4, 0, 26.5, 33)),
    (0, 0.90, (1.5, 1, 25.7, 26), (4.8, 1, 23.0, 42)),
    (15, 0.0, (-3.6, 7.2, 23.6, 17), (-2.9, 6.9, 22.3, 17)),
    (30, -0.50, (-17.5, 13.9, 21.6, 29), (-17.5, 14.0, 21.3, 30)),
    (30, 0.90, (1.7, 2.4, 22.6, 28), (6.5, 5.7, 22.4, 45)),
    (60, 0.0, (-5.5, 17.9, 21.0, 33), (-5.2, 20.2, 21.2, 35)),
    (75, -1.0, (-22.3, 46.1, 19.2, 53), (-23.5, 50.9, 19.8, 55)),
)


def _rows() -> Iterator[str]:
    for angle, slip, *both in MEANS:
        rim = 0.01 * ((1.0 + slip) if slip <= 0.0 else 1.0 / (1.0 - slip))
        for wheel, (pull, side, load, sinkage) in zip(("smooth", " Grousered "), both, strict=True):
            yield f"{side},{wheel},{rim},0.01,{angle},{pull},{load},{1e-3 * sinkage},"


@pytest.fixture
def trials(tmp_path: Path) -> Path:
    file = tmp_path / "trials.csv"
    file.write_text("\n".join((COLUMNS, *_rows())))
    return file


def test_what_was_predicted_has_no_error(trials: Path) -> None:
    table, _ = read_trials(trials)
    found = predict(SAND, table)
    table[["sinkage", "tractive", "lateral"]] = found
    for errors in judge(table, found):
        assert (errors.sinkage, errors.tractive, errors.lateral) == (0.0, 0.0, 0.0)
    found[:, 0] += 0.002
    assert {round(errors.sinkage, 9) for errors in judge(table, found)} == {0.002}


def test_the_sand_is_that_of_the_trials(
    trials: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, _ = read_trials(trials)
    for errors in judge(table, predict(SAND, table)):
        assert errors.sinkage < 0.0035
        assert errors.tractive < 2.5
        assert errors.lateral < 2.5
    picture = tmp_path / "soil.png"
    assert main(["--rig", "--trials", str(trials), "--plot", str(picture)]) == 0
    assert picture.stat().st_size > 10_000
    table.head(3).assign(lateral=math.nan).to_csv(tmp_path / "no.csv", index=False)
    assert main(["--rig", "--trials", str(tmp_path / "no.csv")]) == 0
    assert "nan" not in capsys.readouterr().out


def test_a_file_that_is_not_of_trials_is_refused_in_a_line(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    table = pd.DataFrame({name: [0.0] for name in COLUMNS.split(",")}).assign(wheel="smooth")
    wrong = {
        "lacks load": table.drop(columns="load"),
        "no trial": table.head(0),
        "no trial of smooth": table.assign(wheel="square"),
        "above 0": table.assign(load="heavy"),
        "trial of smooth .* with": table.assign(load="9" * 400),
        "at most 1000 N": table.assign(load=5e5),
        "with .* and sinkage or": table.assign(load=20.0, sinkage="", tractive="", lateral=""),
        "grousered with": table.assign(load=True),
        "speeds are 0 or more": table.assign(load="5_0"),
        "give m, m/s, N": table.assign(load=20.0, sinkage=12.0),
        "give degrees": table.assign(load=20.0, slip_angle_deg=0.52),
    }
    for told, bad in wrong.items():
        bad.to_csv(file, index=False)
        with pytest.raises(UsageError, match=told):
            read_trials(file)
    assert main(["--rig", "--trials", str(tmp_path / "none.csv")]) == 2
    assert main(["--trials", str(file)]) == 2
    table.assign(load=20.0, slip_angle_deg=90.0).to_csv(file, index=False)
    assert main(["--rig", "--trials", str(file)]) == 2


def test_what_is_not_measured_is_left_out_and_told(trials: Path) -> None:
    lines = trials.read_text().splitlines()
    whole, _ = read_trials(trials)
    lines += [
        ",smooth,0.01,0.01,0,,20,,",
        "1,smooth,0.01,0.01,0,1,5e7,0.01,",
        "1,smooth,-0.01,0.01,0,1,20,0.01,",
        "1,square,0.01,0.01,0,1,20,0.01,",
        "1,smooth,0.01,0.01,0,1,,0.01,",
        "1,smooth,0.01,0.01,0,1,20,,",
    ]
    trials.write_text("\n".join(lines))
    table, notes = read_trials(trials)
    assert len(table) == len(whole) + 1
    told = [
        "1 trials of 'square'",
        "3 trials whose",
        "1 trials without",
        "sinkage was not measured in 1",
    ]
    assert [text in note for text, note in zip(told, notes, strict=True)] == [True] * 4
    found = judge(table, predict(SAND, table))
    assert sum(errors.n for errors in found if "75" in errors.trials) == len(table)
    for separator, comma in ((";", ","), ("\t", "."), (";", ".")):
        text = "\n".join(lines).replace(",", separator).replace(".", comma)
        trials.write_text(text)
        pd.testing.assert_frame_equal(read_trials(trials)[0], table, rtol=1e-12)
    assert all(errors.n and errors.sinkage < 0.0035 for errors in found)


def test_a_pressed_wheel_stands_where_measured_ones_did(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Of the smooth wheel's tests: mean forces [N] at 10, 20, 30 and 40 mm.
    assert pressing.pressed(SAND) == pytest.approx([18.5, 65.7, 143.3, 250.8], rel=0.25)
    file = tmp_path / "pressing.csv"
    file.write_text("run,body,sinkage,force\n1,plate,0.0,0.0\n2,smooth,0.0,0.0\n2,smooth,0.025,100\n")
    (own := tmp_path / "own.yaml").write_text(OWN)
    assert main(["--rig", "--robot", "leo", "--soil", str(own), "--pressing", str(file)]) == 0
    slopes, pressed = capsys.readouterr().out.split("Pressing")
    assert "measured, smooth" in pressed
    assert "own.yaml" in slopes
    assert "own.yaml" in pressed
    assert "jackal" not in slopes
    file.write_text("run,body,sinkage,force\n1,plate,0.0,0.0\n")
    assert main(["--rig", "--pressing", str(file)]) == 2
    file.write_text("run;body;sinkage;force\n2;smooth;deep;much\n")
    assert main(["--rig", "--pressing", str(file)]) == 2


def test_a_rover_climbs_steeper_on_firm_ground_than_on_sand() -> None:
    leo = find_rover("leo")
    assert 3.0 < stall_slope_deg(SAND, leo) < 15.0
    assert stall_slope_deg(SOILS["firm"], leo) == pytest.approx(45.0, abs=0.1)
