"""Rows as RoboTerrain's collector writes them, read back by the reader of its logs."""

import math
from pathlib import Path

import pytest

from rover_metrics.analysis.social.log import read_social_log
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.social_log import SocialRows, social_columns

REAL = Path(__file__).parents[4] / "shared/data/roboterrain/social/Nav2_lidar_reverse"


def test_rows_have_two_decimals_and_come_back_from_the_file(tmp_path: Path) -> None:
    names = ("b_actor", "a_actor")
    rows = SocialRows()
    with CsvLog(tmp_path, None, stem="people", columns=social_columns(names)) as log:
        for time_s, rover in ((1.0, (0.0, -1.0)), (2.0, (3.0, -5.0)), (3.0, (3.0, -5.006))):
            log.write(rows.next(time_s, rover, {"b_actor": (0.0, 0.0), "a_actor": (3.0, -4.0)}, 7))
    assert log.path == tmp_path / "people.csv"
    assert log.path.read_bytes().split(b"\r\n") == [
        b"step,time_s,robot_x,robot_y,speed_mps,a_actor_dist,b_actor_dist,dmin,goals_count",
        b"1,1.00,0.00,-1.00,nan,4.24,1.00,1.00,7",
        b"2,2.00,3.00,-5.00,5.00,1.00,5.83,1.00,7",
        b"3,3.00,3.00,-5.01,0.01,1.01,5.84,1.01,7",
        b"",
    ]
    back = read_social_log(log.path)
    assert (back.actors, back.findings, back.goals.tolist()) == (("a", "b"), (), [7, 7, 7])
    assert back.position[1].tolist() == [3.0, -5.0]


def test_without_a_second_since_the_row_before_there_is_no_speed_and_without_people_no_nearest() -> None:
    rows = SocialRows()
    speeds = [rows.next(time_s, (9.0 * time_s, 0.0), {}, 0).speed for time_s in (1.0, 1.0, 0.5, 1.5)]
    assert speeds == pytest.approx([math.nan, math.nan, math.nan, 9.0], nan_ok=True)
    last = rows.next(2.0, (0.0, 0.0), {}, 3).as_fields()
    assert last == [5, "2.00", "0.00", "0.00", "27.00", "nan", 3]


@pytest.mark.skipif(not REAL.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
def test_the_header_and_the_cells_are_those_of_a_real_log() -> None:
    first, *_, last = next(iter(sorted(REAL.iterdir()))).read_text().splitlines()
    assert first == ",".join(social_columns(("triangle_actor", "linear_actor", "diag_actor")))
    step, time_s, x, y, speed, *distances, nearest, goals = last.split(",")
    place, names = (float(x), float(y)), ("diag_actor", "linear_actor", "triangle_actor")
    people = {n: (place[0] + float(d), place[1]) for n, d in zip(names, distances, strict=True)}
    row = SocialRows().next(float(time_s), place, people, int(goals))
    cells = [*map(str, row.as_fields())]
    cells[0], cells[4] = step, speed  # of the rows before
    assert ",".join(cells) == last
    assert min(map(float, distances)) == float(nearest)
