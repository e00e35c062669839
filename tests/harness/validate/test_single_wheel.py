"""A wheel drawn through soil beside trials: what a file may lack, and what the soil is worth."""

from pathlib import Path

import pandas as pd
import pytest

from harness.base.errors import UsageError
from harness.robots import find_rover
from harness.soil.soils import SOILS
from harness.validate.__main__ import main
from harness.validate.single_wheel import judge, predict, read_trials, stall_slope_deg

COLUMNS = "lateral,wheel,wheel_speed,travel_speed,slip_angle_deg,tractive,load,sinkage,note"
# Means of three trials each of C. Pavlov, 2022 (3d-terramechanics, MIT).
MEASURED = (
    "0,smooth,0.00928,0.01,0,-1.3,24.6,0.014,\n0,smooth,0.0928,0.01,0,1.5,25.7,0.026,\n"
    "0, Grousered ,0.00928,0.01,0,-1.3,23.8,0.016,\n17.9,smooth,0.00928,0.01,60,-5.5,21.0,0.033,\n"
)


@pytest.fixture
def trials(tmp_path: Path) -> Path:
    file = tmp_path / "trials.csv"
    file.write_text(f"{COLUMNS}\n{MEASURED}")
    return file


def test_what_was_predicted_has_no_error(trials: Path) -> None:
    table = read_trials(trials)
    found = predict(SOILS["dry_sand"], table)
    table[["sinkage", "tractive", "lateral"]] = found
    for errors in judge(table, found):
        assert (errors.sinkage, errors.tractive, errors.lateral) == (0.0, 0.0, 0.0)
    found[:, 0] += 0.002
    assert {round(errors.sinkage, 9) for errors in judge(table, found)} == {0.002}


def test_the_sand_is_that_of_the_trials(trials: Path, tmp_path: Path) -> None:
    table = read_trials(trials)
    for errors in judge(table, predict(SOILS["dry_sand"], table)):
        assert errors.sinkage < 0.005
        assert errors.tractive < 3.0
        assert errors.lateral < 4.0
    picture = tmp_path / "soil.png"
    assert main(["--rig", "--trials", str(trials), "--plot", str(picture)]) == 0
    assert picture.stat().st_size > 10_000


def test_a_file_that_is_not_of_trials_is_refused_in_a_line(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    table = pd.DataFrame({name: [0.0] for name in COLUMNS.split(",")}).assign(wheel="smooth")
    wrong = {
        "lacks load": table.drop(columns="load"),
        "square": table.assign(wheel="square"),
        "line 2": table.assign(load="heavy"),
        "no trials": table.head(0),
    }
    for told, bad in wrong.items():
        bad.to_csv(file, index=False)
        with pytest.raises(UsageError, match=told):
            read_trials(file)
    assert main(["--rig", "--trials", str(tmp_path / "none.csv")]) == 2
    assert main(["--trials", str(file)]) == 2


def test_a_rover_climbs_steeper_on_firm_ground_than_on_sand() -> None:
    leo = find_rover("leo")
    assert 3.0 < stall_slope_deg(SOILS["dry_sand"], leo) < 15.0
    assert 35.0 < stall_slope_deg(SOILS["firm"], leo) <= 45.0
