"""Both forms of RoboTerrain's social log, and what is wrong with a file that is none."""

from pathlib import Path

import numpy as np
import pytest

from rover_metrics.analysis.logs.header import UnreadableLog
from rover_metrics.analysis.social.log import read_social_log

NEW = "step,time_s,robot_x,robot_y,speed_mps,diag_actor_dist,guide_dist,dmin,goals_count"
OLD = "step,time_s,rx,ry,speed_mps,d1_linear,d2_diag,dmin,goals"


@pytest.mark.parametrize("separators", ["", ",;.,", ",\t"])  # as it is, or as programs write it anew
@pytest.mark.parametrize(("header", "actors"), [(NEW, ("diag", "guide")), (OLD, ("linear", "diag"))])
def test_both_forms_give_the_same(
    header: str, actors: tuple[str, ...], separators: str, tmp_path: Path
) -> None:
    path = tmp_path / "log.csv"
    text = f"{header}\n1,1.00,-2,3.5,nan,4,0.3,0.25,0\n2,2.00,-1,3,0.1,nan,5,5,2\n"
    path.write_text(text.translate(str.maketrans(separators[::2], separators[1::2])))
    log = read_social_log(path)
    assert (log.actors, log.path, log.findings, len(log)) == (actors, path, (), 2)
    np.testing.assert_array_equal(log.time_s, [1.0, 2.0])
    np.testing.assert_array_equal(log.position, [[-2.0, 3.5], [-1.0, 3.0]])
    np.testing.assert_array_equal(log.distance, [[4.0, 0.3], [np.nan, 5.0]])
    np.testing.assert_array_equal(log.nearest, [0.25, 5.0])  # as dmin has it
    assert log.goals.tolist() == [0, 2]


def test_what_a_log_may_lack_and_what_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    bad = ["1,2", "1,x,1,1,0", "", "7", "8"]
    path.write_text(
        "\n".join(["time_s,d1_a,d2_b,goals,x", "1,2,,3,0", *bad, "2,nan,4,,0", "3,6,5,7,0", "3,1,1"])
    )
    log = read_social_log(path)
    np.testing.assert_array_equal(log.nearest, [2.0, 4.0, 5.0])  # dmin is made of what is known
    assert np.isnan(log.position).all()
    assert log.position.shape == (3, 2)
    assert log.goals.tolist() == [3, 0, 7]
    told = [f"line {number} is not 5 numbers and is left out" for number in (3, 4, 6)]
    assert list(log.findings) == [*told, "2 more lines left out"]
    path.write_text("time_s,d1_a,goals\n,2,0\n,3,0\n")
    assert read_social_log(path).findings == (
        "its rows are nan s apart, not 1 s; each counts as a second",
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Timestamp,Total Collisions\n1,2\n", "lacks time_s, goals_count or goals, the distances"),
        ("time_s,d1_a\n1,2\n", "lacks goals_count or goals"),
        ("time_s,goals,d1_a,d1_a\n1,2,3,4\n", "names d1_a more than once"),
        ("time_s,goals,a_dist\n1,2\n", "no whole row"),
        ("", "not the header of a social log"),
    ],
)
def test_a_file_that_is_no_social_log_is_told(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(text)
    with pytest.raises(UnreadableLog, match=told):
        read_social_log(path)
    with pytest.raises(UnreadableLog, match="no such file"):
        read_social_log(tmp_path / "other.csv")


@pytest.mark.parametrize(("period", "is_told"), [(1.0, False), (0.1, True), (10.0, True), (0.0, True)])
def test_rows_that_are_no_seconds_are_told(period: float, is_told: bool, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    rows = "".join(f"{1.7e9 + row * period},2,{row}\n" for row in range(9))
    path.write_text(f"time_s,a_dist,goals\n{rows}")
    assert any("counts as a second" in finding for finding in read_social_log(path).findings) is is_told
