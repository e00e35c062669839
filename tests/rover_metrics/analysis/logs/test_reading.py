import io
import os
from collections.abc import Callable
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from rover_metrics.analysis.logs.header import UnreadableLog
from rover_metrics.analysis.logs.parsing import _Narrow
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.analysis.metric import METRIC_COLUMNS, METRICS, other_metric
from rover_metrics.core.columns import COLUMNS
from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.log.session_record import COMPLETE, write_record

NAN = np.nan
Row = Callable[..., str]
WriteLog = Callable[..., Path]


def refused(path: Path) -> str:
    with pytest.raises(UnreadableLog) as caught:
        read_log(path)
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_a_good_log_has_all_columns_and_nothing_odd(write_log: WriteLog) -> None:
    log = read_log(write_log(lines=30))
    assert len(log) == 30
    assert log.findings == ()
    assert list(log.starts) == [0]
    assert log.duration == 29.0
    assert log.columns["Distance Traveled"][-1] == 14.5


def test_only_the_columns_asked_for_and_the_counters_are_kept(write_log: WriteLog, row: Row) -> None:
    changed = [row(1, Distance_Traveled="far"), row(2, Total_Collisions="inf", Obstacle_Clearance="?")]
    log = read_log(write_log(lines=[row(0), *changed, row(3)]), [METRICS["CV"]])
    assert log.findings == (
        "1 cell without a number in Distance Traveled (line 3, 'far'): left out",
        "1 infinite value in Total Collisions (line 4): left out",
    )
    counters = {"Total Collisions", "Smoothness Metric", "Distance Traveled"}
    assert set(log.columns) == {*counters, "Current Velocity"}
    assert {column.dtype for column in log.columns.values()} == {np.dtype(np.float64)}


@pytest.mark.parametrize("extra", [",7", ",7,7", ",7" * 500])
@pytest.mark.parametrize("chunk", [2, 200_000])
def test_a_row_with_any_number_of_fields_too_many_is_left_out_alike(
    write_log: WriteLog, row: Row, monkeypatch: pytest.MonkeyPatch, extra: str, chunk: int
) -> None:
    monkeypatch.setattr("rover_metrics.analysis.logs.parsing._CHUNK", chunk)
    lines = [*map(row, range(3)), row(3) + extra, *map(row, range(4, 7)), row(7, Notes='"a,b"')]
    lines.append(row(8, Current_Velocity="fast"))
    for end in ("\n", ""):
        log = read_log(write_log(lines=lines, end=end))
        assert list(log.stamps) == [100, 101, 102, 104, 105, 106, 107, 108]
        assert log.columns["Distance Traveled"].tolist() == [0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 3.5, 4.0]
        left_out, no_number, _ = log.findings  # and a gap
        told = "1 row with more fields than the header, so which is which is unclear (line 5): left out"
        assert left_out == told
        assert no_number == "1 cell without a number in Current Velocity (line 10, 'fast'): left out"


def test_a_column_asked_for_that_is_not_there_is_told(write_log: WriteLog) -> None:
    others = [other_metric(name) for name in ("a", "b", "c", "d", "e")]
    assert read_log(write_log(), [METRICS["CV"], *others[:1]]).findings == ("no column a",)
    assert read_log(write_log(), [METRICS["CV"], *others]).findings == (
        "no column a, b, c, d and 1 more",
    )


def test_another_column_keeps_all_its_digits(write_log: WriteLog, tmp_path: Path) -> None:
    lines = write_log(lines=2).read_text().splitlines()
    path = tmp_path / "more.csv"
    path.write_text(f"{lines[0]},ms\n{lines[1]},1700000000123\n{lines[2]},\n")
    log = read_log(path, [other_metric("ms")])
    assert log.columns["ms"][0] == 1_700_000_000_123
    assert np.isnan(log.columns["ms"][1])
    assert log.findings == ()


def test_a_header_too_short_for_most_rows_is_refused_and_not_shifted(
    write_log: WriteLog, tmp_path: Path
) -> None:
    text = write_log(lines=10).read_text().replace("Vertical Roughness,", "")
    path = tmp_path / "mixed.csv"
    path.write_text(text)
    told = "mixed schemas: the header names {} columns, but {} rows have {} fields (first on line 2)"
    assert refused(path) == told.format(11, "10 of 10", "more")
    path.write_text(write_log(lines=10).read_text().replace("Total", "New,Total"))
    assert refused(path) == told.format(13, "10 of 10", "fewer")


def test_a_single_row_is_no_schema(write_log: WriteLog, row: Row) -> None:
    assert refused(write_log(lines=[row(0).replace("100,", "100,7,")])).startswith("none of its 1 rows")


def test_rows_of_an_older_schema_are_left_out(write_log: WriteLog, row: Row) -> None:
    old = [row(i).replace(",9.0,", ",").replace(",9.5,", ",") for i in (8, 9)]
    log = read_log(write_log(lines=[*(row(i) for i in range(8)), *old]), [METRICS["CV"]])
    assert len(log) == 8
    assert "2 rows with fewer fields than the header (first on line 10): left out" in log.findings
    half = read_log(write_log(lines=[row(0), row(1), *old]), [METRICS["CV"]])
    assert list(half.stamps) == [100, 101]


@pytest.mark.parametrize(
    "note", ["", '"Low clearance, rough"', '"a, b, c, d"', '"Low clearance, ro', 'odd "quote']
)
def test_a_note_may_be_empty_or_hold_commas_and_quotes(write_log: WriteLog, row: Row, note: str) -> None:
    lines = [row(0), row(1, Notes=note), row(2, Notes="Latin-1: \xe4")]
    for comma, told in ((",", ()), (", ", ("spaces before numbers",))):
        path = write_log(lines=[line.replace(",", comma) for line in lines])
        path.write_bytes(path.read_text().encode("latin-1"))
        assert (len(read_log(path)), read_log(path).findings) == (3, told)


FEWER = "with fewer fields than the header"


@pytest.mark.parametrize(
    ("lines", "stamps", "column", "values", "findings"),
    [
        (  # text, nan and inf silence the cell, not the row
            lambda row: [
                row(0, Obstacle_Clearance="inf"),
                row(1, Obstacle_Clearance="near"),
                row(2, Current_Velocity="nan"),
                row(3, Vertical_Roughness="inf"),
            ],
            [100, 101, 102, 103],
            *("Obstacle Clearance", [NAN, NAN, 1.2, 1.3]),
            [
                "1 cell without a number in Obstacle Clearance (line 3, 'near'): left out",
                "1 cell without a number in Current Velocity (line 4): left out",
                "1 infinite value in Obstacle Clearance, as before the first scan (line 2): left out",
                "1 infinite value in Vertical Roughness (line 5): left out",
            ],
        ),
        (
            lambda row: [row(0), row(1, Is_Rough_Terrain=3), row(2)],
            [100, 101, 102],
            *("Is Rough Terrain", [0, NAN, 0]),
            ["1 values of Is Rough Terrain are neither 0 nor 1 (first on line 3): left out"],
        ),
        (
            lambda row: [row(0), row(1), row(1, Distance_Traveled=0.7), row(2)],
            [100, 101, 102],
            *("Distance Traveled", [0, 0.7, 1.0]),
            ["1 duplicate timestamp (line 4): the later row counts"],
        ),
        (  # a blank line is no row, and moves no number of a line
            lambda row: [row(0), "", row(1, Current_Velocity="fast")],
            [100, 101],
            *("Current Velocity", [0.5, NAN]),
            [
                f"1 row {FEWER} (line 3): left out",
                "1 cell without a number in Current Velocity (line 4, 'fast'): left out",
            ],
        ),
        (
            lambda row: [row(0), ",".join(COLUMNS), row(1), row(2, Timestamp="inf")],
            [100, 101],
            *("Total Collisions", [0, 2]),
            ["2 rows without a number for a Timestamp (first on line 3): left out"],
        ),
        (
            lambda row: [row(i, Timestamp=1.7e9 + 0.5 * i).replace(",", ", ") for i in range(3)],
            [1.7e9, 1.7e9 + 0.5, 1.7e9 + 1],
            *("Total Collisions", [0, 2, 4]),
            [
                "spaces before numbers",
                "a row every 0.5 s, not every second",
                "wall-clock timestamps: the node ran without use_sim_time",
            ],
        ),
        (  # the last line is cut in a number
            lambda row: [row(0), row(1), row(2).removesuffix("0.0,Normal operation")],
            [100, 101],
            *("Total Collisions", [0, 2]),
            [f"1 row {FEWER} (line 4): left out"],
        ),
    ],
)
def test_what_is_odd_is_left_out_and_told_with_its_line(
    write_log: WriteLog,
    row: Row,
    lines: Callable[[Row], list[str]],
    stamps: list[float],
    column: str,
    values: list[float],
    findings: list[str],
) -> None:
    log = read_log(write_log(lines=lines(row), end=""))
    assert list(log.stamps) == stamps
    assert log.columns[column].tolist() == pytest.approx(values, nan_ok=True)
    assert list(log.findings) == findings


def test_time_that_goes_back_and_gaps_begin_episodes(write_log: WriteLog, row: Row) -> None:
    stamps = [50, 51, 52, 3, 4, 40, 41]
    lines = [row(i, Timestamp=stamp) for i, stamp in enumerate(stamps)]
    log = read_log(write_log(lines=lines))
    assert list(log.starts) == [0, 3, 5]
    assert log.findings == (
        "1 backward timestamp (line 5): an episode begins there",
        "1 long gap (line 7): over 10 s, an episode begins there",
    )
    assert list(read_log(write_log(lines=lines), gap=100.0).starts) == [0, 3]


def test_a_node_that_starts_again_begins_an_episode(write_log: WriteLog, row: Row) -> None:
    """Its counters fall, its time goes on."""
    lines = [row(i, Distance_Traveled=0.5 * (i % 4)) for i in range(10)]
    log = read_log(write_log(lines=lines), [METRICS["CV"]])
    assert (list(log.starts), log.findings) == ([0, 4, 8], ())


def test_a_session_that_was_killed_is_read_with_a_finding_and_one_that_ended_without(
    write_log: WriteLog,
) -> None:
    log = write_log()
    write_record(log, None, {})
    assert read_log(log).findings == ("the session has no end mark: it was killed, or is still running",)
    write_record(log, COMPLETE, {})
    assert read_log(log).findings == ()


def test_a_byte_order_mark_and_carriage_returns_do_not_matter(
    write_log: WriteLog, tmp_path: Path
) -> None:
    path = tmp_path / "windows.csv"
    path.write_bytes(b"\xef\xbb\xbf" + write_log(lines=4).read_bytes().replace(b"\n", b"\r\n"))
    assert len(read_log(path)) == 4
    assert read_log(path).findings == ()


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("", "the file is empty"),
        ("\n\n", "the first line is not a header but blank"),
        (",".join(COLUMNS) + "\n", "there is a header but no row"),
        ("a,b\n1,2\n", "the first line is not the header of a metrics log but 'a,b'"),
        ("# made by\n" + ",".join(COLUMNS) + "\n1\n", "not the header of a metrics log but '# made by'"),
        ("Time,Current Velocity\n1,2\n", "the header lacks Timestamp"),
        ("Timestamp,Notes\n1,2\n", "the header lacks any of Total Collisions, Current"),
        ("Timestamp,Total Coll", "the header lacks any of Total Collisions, Current"),  # torn
        (
            "Timestamp,Current Velocity,Current Velocity\n1,2,3\n",
            "names Current Velocity more than once",
        ),
        ("Timestamp,Current Velocity\na,b\nc,d\n", "none of its 2 rows is usable"),
    ],
)
def test_what_is_no_log_is_refused_in_one_line(tmp_path: Path, content: str, told: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(content)
    assert told in refused(path)


def test_all_columns_that_a_header_names_twice_are_told_in_order(tmp_path: Path) -> None:
    path = tmp_path / "twice.csv"
    path.write_text(",".join(METRIC_COLUMNS * 2) + "\n1\n")
    assert refused(path) == f"the header names {', '.join(sorted(METRIC_COLUMNS))} more than once"


@pytest.mark.parametrize(
    ("error", "told"), [(MemoryError(), "out of memory"), (ValueError("no\n such"), "no such")]
)
def test_what_pandas_cannot_do_is_told_in_one_line(
    write_log: WriteLog, monkeypatch: pytest.MonkeyPatch, error: Exception, told: str
) -> None:
    monkeypatch.setattr("pandas.read_csv", Mock(side_effect=error))
    assert refused(write_log()) == f"cannot be read: {told}"


def test_pandas_does_not_warn_of_what_is_told_as_a_finding(write_log: WriteLog, row: Row) -> None:
    """Warnings are errors here: of fields that it drops, of a column that holds numbers and text."""
    lines = [row(0) + ",7,7,7", *map(row, range(1, 70_000)), row(70_000, Current_Velocity="fast")]
    assert read_log(write_log(lines=lines)).findings == (
        "1 row with more fields than the header, so which is which is unclear (line 2): left out",
        "1 cell without a number in Current Velocity (line 70002, 'fast'): left out",
    )


def test_pandas_is_given_whole_lines_of_about_as_much_as_it_asks_for() -> None:
    for rest in ((), (None,)):
        text = _Narrow(io.StringIO("a,b\nc,d,e\nf\n"), 2)
        assert [text.read(1), text.read(*rest), text.read(1)] == ["a,b\n", "c,d\nf\n", ""]


def test_without_notes_a_row_is_short_if_its_last_column_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "few.csv"
    path.write_text(
        "Timestamp,Current Velocity,a,Vertical Roughness\n1,2,0,3\n2,2,0\n2,2,0,3\n3,2,0,3\n"
    )
    log = read_log(path, [METRICS["CV"], METRICS["VR"]])
    assert list(log.stamps) == [1, 2, 3]
    assert log.findings == ("1 row with fewer fields than the header (line 3): left out",)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "noise.csv"
    path.write_bytes(np.random.default_rng(0).bytes(10_000))
    assert "not the header of a metrics log" in refused(path)


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert refused(tmp_path) == "this is a folder; name the CSV files in it"
    assert refused(tmp_path / "missing.csv") == "there is no such file"
    assert refused(tmp_path / "pipe") == "this is not a regular file"
    assert refused(tmp_path / ("x" * 300)) == "cannot be read: File name too long"


def test_a_log_without_any_chosen_metric_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "little.csv"
    path.write_text("Timestamp,Current Velocity\n1,2\n")
    with pytest.raises(UnreadableLog, match="no column for OC, VR"):
        read_log(path, [METRICS["OC"], METRICS["VR"]])


def test_an_extended_log_reads_as_the_twelve_and_its_empty_cells_are_nothing_odd(
    write_log: WriteLog, row: Row, tmp_path: Path
) -> None:
    header = ",".join(EXTENDED_HEADER)
    empty = "," * (len(EXTENDED_HEADER) - len(COLUMNS))
    lines = [row(i) + (empty if i % 2 else f",0.25{empty[1:]}") for i in range(10)]
    path = tmp_path / "extended.csv"
    path.write_text("\n".join([header, *lines, row(10) + ",0."]))
    log = read_log(path)
    twelve = read_log(write_log(lines=10))
    for name, column in twelve.columns.items():
        np.testing.assert_array_equal(log.columns[name], column)
    assert np.isfinite(log.columns["VORT [m/s]"]).tolist() == [True, False] * 5
    assert log.findings == ("1 row with fewer fields than the header (line 12): left out",)
    path.write_text("\n".join([header, *lines, row(10, Obstacle_Clearance="") + empty, ""]))
    assert read_log(path).findings == (
        "1 cell without a number in Obstacle Clearance (line 12): left out",
    )
    path.write_text("\n".join([header, *lines, row(10) + f",rough{empty[1:]}", ""]))
    assert read_log(path).findings == (
        "1 cell without a number in VORT [m/s] (line 12, 'rough'): left out",
    )
