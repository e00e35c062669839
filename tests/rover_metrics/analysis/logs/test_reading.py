"""Logs as they come: what is read of each, what is told of it, why a file is refused."""

import csv
import os
from collections.abc import Callable, Iterator
from io import StringIO
from pathlib import Path

import numpy as np
import pytest

from rover_metrics.analysis.logs.header import UnreadableLog
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.analysis.metric import METRIC_COLUMNS, METRICS, Metric, other_metric
from rover_metrics.core.columns import COLUMNS
from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.log.session_record import COMPLETE, write_record
from tests.support.snapshots import check_snapshot

Row = Callable[..., str]
WriteLog = Callable[..., Path]
HEADER = ",".join(COLUMNS)
EVERY = tuple(METRICS.values())


def logs(row: Row) -> Iterator[tuple[str, list[str], tuple[Metric, ...]]]:
    """Yields files of rows: what each is, its lines after the header, the metrics asked for."""
    speed, good = (METRICS["CV"],), list(map(row, range(4)))
    others = [other_metric(name) for name in "abcde"]
    odd = {
        "far": row(1, Distance_Traveled="far"),
        "inf": row(2, Total_Collisions="inf", Obstacle_Clearance="?"),
        "near": row(1, Obstacle_Clearance="near"),
        "nan": row(2, Current_Velocity="nan"),
        "fast": row(8, Current_Velocity="fast"),
    }
    yield "good", list(map(row, range(30))), EVERY
    yield "only what was asked for", [good[0], odd["far"], odd["inf"], good[3]], speed
    yield "a metric that no column has", good, (*speed, others[0])
    yield "five metrics that no column has", good, (*speed, *others)
    texts = [row(0, Obstacle_Clearance="inf"), odd["near"], odd["nan"]]
    yield "text, nan and inf", [*texts, row(3, Vertical_Roughness="inf")], EVERY
    yield "a flag of 3", [good[0], row(1, Is_Rough_Terrain=3), good[2]], EVERY
    yield "a stamp twice", [good[0], good[1], row(1, Distance_Traveled=0.7), good[2]], EVERY
    yield "a blank line", [good[0], "", odd["fast"]], EVERY
    yield "a blank line after each", ["", *(line for one in good for line in (one, ""))], speed
    yield "a header among the rows", [good[0], HEADER, good[1], row(2, Timestamp="inf")], EVERY
    halves = [row(i, Timestamp=1.7e9 + 0.5 * i).replace(",", ", ") for i in range(3)]
    yield "spaces, half seconds, wall clock", halves, EVERY
    yield "torn", [*good[:2], row(2).removesuffix("0.0,Normal operation")], EVERY
    jumps = [row(i, Timestamp=stamp) for i, stamp in enumerate((50, 51, 52, 3, 4, 40, 41))]
    yield "time goes back and leaps", jumps, EVERY
    yield "counters fall", [row(i, Distance_Traveled=0.5 * (i % 4)) for i in range(10)], speed
    older = [row(i).replace(",9.0,", ",").replace(",9.5,", ",") for i in (8, 9)]
    yield "rows of an older node", [*map(row, range(8)), *older], speed
    yield "half of them", [*good[:2], *older], speed
    yield "one row with a field too many", [row(0).replace("100,", "100,7,")], EVERY
    for note in ("", '"a, b, c, d"', '"Low, ro', 'odd "quote'):
        yield f"a note: {note}", [good[0], row(1, Notes=note), good[2]], EVERY
        spaced = [line.replace(",", ", ") for line in (good[0], row(1, Notes=note))]
        yield f"a note, and spaces: {note}", spaced, EVERY


def described(path: Path, metrics: tuple[Metric, ...] = EVERY) -> str:
    """What is read of a file, a line a thing."""
    try:
        log = read_log(path, metrics)
    except UnreadableLog as error:
        return f"refused: {error!s}"
    columns = (f"{name}: {' '.join(f'{v:g}' for v in log.columns[name])}" for name in log.columns)
    assert {column.dtype for column in log.columns.values()} == {np.dtype(np.float64)}
    starts = f"{len(log)} rows, {log.duration:g} s, episodes begin at rows {log.starts.tolist()}"
    stamps = " ".join(f"{stamp:.12g}" for stamp in log.stamps)
    return "\n".join([starts, f"at {stamps}", *columns, *(f"odd: {odd}" for odd in log.findings)])


def test_logs_are_read_as_somebody_has_checked(write_log: WriteLog, row: Row, tmp_path: Path) -> None:
    parts = []
    for number, (name, lines, metrics) in enumerate(logs(row)):
        path = write_log(f"{number}.csv", lines, end="")
        parts.append(f"== {name}\n{described(path, metrics)}")
    files = {
        "empty": "",
        "blank": "\n\n",
        "header alone": f"{HEADER}\n",
        "another file": "a,b\n1,2\n",
        "a comment": f"# made by\n{HEADER}\n1\n",
        "no Timestamp": "Time,Current Velocity\n1,2\n",
        "no metric": "Timestamp,Notes\n1,2\n",
        "torn header": "Timestamp,Total Coll",
        "a name twice": "Timestamp,Current Velocity,Current Velocity\n1,2,3\n",
        "every name twice": ",".join(METRIC_COLUMNS * 2) + "\n1\n",
        "no numbers": "Timestamp,Current Velocity\na,b\nc,d\n",
        "without notes": "Timestamp,Current Velocity,a,Vertical Roughness\n1,2,0,3\n2,2,0\n2,2,0,3\n",
        "Windows": "\ufeff" + write_log(lines=4).read_text().replace("\n", "\r\n"),
        "an old Mac": write_log(lines=4).read_text().replace("\n", "\r"),
        "header too short": write_log(lines=10).read_text().replace("Vertical Roughness,", ""),
        "header too long": write_log(lines=10).read_text().replace("Total", "New,Total"),
    }
    for name, content in files.items():
        path = tmp_path / "file.csv"
        path.write_bytes(content.encode())
        parts.append(f"== {name}\n{described(path)}")
    check_snapshot("logs.txt", "\n\n".join(parts) + "\n")


@pytest.mark.parametrize(
    ("quoting", "separator", "decimal"),
    [
        (csv.QUOTE_ALL, ",", "."),  # pandas, on request
        (csv.QUOTE_NONNUMERIC, ",", "."),  # R
        (csv.QUOTE_MINIMAL, ",", ","),
        (csv.QUOTE_ALL, ",", ","),
        (csv.QUOTE_MINIMAL, ";", ","),  # Excel, where commas are decimal
        (csv.QUOTE_MINIMAL, ";", "."),
        (csv.QUOTE_ALL, ";", ","),
        (csv.QUOTE_MINIMAL, "\t", "."),
    ],
)
@pytest.mark.parametrize("bom", ["", "\ufeff"])
def test_a_log_that_a_spreadsheet_or_pandas_wrote_anew_is_read_as_before(
    write_log: WriteLog, row: Row, tmp_path: Path, quoting: int, separator: str, decimal: str, bom: str
) -> None:
    lines = [
        *map(row, range(9)),
        row(9, Notes='"Low clearance, collision"'),
        row(10, Current_Velocity="x"),
    ]
    before = write_log(lines=[*lines, row(11).replace(",9.0,", ",")])
    after, copy = tmp_path / "anew.csv", StringIO()
    writer = csv.writer(copy, quoting=quoting, delimiter=separator)  # type: ignore[arg-type]  # any of csv
    for cells in csv.reader(before.read_text().splitlines()):
        numbers = (cell.replace(".", decimal) if cell[:1].isdigit() else cell for cell in cells)
        writer.writerow(numbers)
    after.write_text(bom + copy.getvalue(), newline="")
    assert described(after) == described(before)


def test_a_comma_is_no_decimal_point_where_other_numbers_have_points(
    write_log: WriteLog, row: Row
) -> None:
    cell = '"1,234"'
    path = write_log(lines=[*map(row, range(5)), row(5, Distance_Traveled=cell)])
    for separator in ";", "\t":
        anew = path.read_text().replace(cell, "1^234").replace(",", separator).replace("^", ",")
        path.with_name("anew.csv").write_text(anew)
        log = read_log(path.with_name("anew.csv"))
        assert np.isnan(log.columns["Distance Traveled"][5])
        assert any("Distance Traveled" in finding for finding in log.findings)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_line_that_is_too_long_is_left_out_alone(
    write_log: WriteLog, row: Row, separator: str
) -> None:
    path = write_log(lines=[*map(row, range(5)), "@", row(6)])
    text = path.read_text().replace(",", separator).replace("@", '"' + "7" * 140_000)
    path.write_text(text)
    log = read_log(path)
    assert list(log.stamps) == [100, 101, 102, 103, 104, 106]
    assert "(line 7)" in log.findings[0]


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
        assert [finding.partition(" (")[2][:7] for finding in log.findings[:2]] == ["line 5)", "line 10"]


def test_another_column_keeps_all_its_digits(write_log: WriteLog, row: Row, tmp_path: Path) -> None:
    lines = write_log(lines=2).read_text().splitlines()
    path = tmp_path / "more.csv"
    path.write_text(f"{lines[0]},ms\n{lines[1]},1700000000123\n{lines[2]},\n")
    log = read_log(path, [other_metric("ms")])
    np.testing.assert_array_equal(log.columns["ms"], [1_700_000_000_123, np.nan])
    assert log.findings == ()
    jumps = [row(i, Timestamp=stamp) for i, stamp in enumerate((50, 51, 52, 3, 4, 40, 41))]
    for gap, starts in ((100.0, [0, 3]), (10.0, [0, 3, 5])):  # what is told of a gap is what was done
        log = read_log(write_log(lines=jumps), gap=gap)
        assert log.starts.tolist() == starts
        assert any("long gap" in finding for finding in log.findings) == (gap < 36.0)


def test_a_session_that_was_killed_is_read_with_a_finding(
    write_log: WriteLog,
) -> None:
    log = write_log()
    write_record(log, None, {})
    assert read_log(log).findings == ("the session has no end mark: it was killed, or is still running",)
    write_record(log, COMPLETE, {})
    assert read_log(log).findings == ()


def test_pandas_does_not_warn_of_what_is_told_as_a_finding(write_log: WriteLog, row: Row) -> None:
    """Warnings are errors here: of fields that it drops, of a column that holds numbers and text."""
    lines = [row(0) + ",7,7,7", *map(row, range(1, 70_000)), row(70_000, Current_Velocity="fast")]
    assert len(read_log(write_log(lines=lines)).findings) == 2


def test_what_is_no_text_or_no_file_is_refused(tmp_path: Path, write_log: WriteLog, row: Row) -> None:
    (tmp_path / "noise.csv").write_bytes(np.random.default_rng(0).bytes(10_000))
    (tmp_path / "people.csv").write_text("step,time_s,robot_x,robot_y,speed_mps,dmin\n1,1.0,0,0,0,9\n")
    os.mkfifo(tmp_path / "pipe")
    for name, reason in {
        "noise.csv": "the first line is not the header of a metrics log",
        "people.csv": "it is a log of people around a rover; rover-social reads it",
        ".": "this is a folder; name the CSV files in it",
        "missing.csv": "there is no such file",
        "pipe": "this is not a regular file",
        "x" * 300: "cannot be read: File name too long",
    }.items():
        assert described(tmp_path / name).startswith(f"refused: {reason}")
    latin = write_log(lines=[row(0, Notes="\xe4"), row(1)])
    latin.write_bytes(latin.read_text().encode("latin-1"))
    assert len(read_log(latin)) == 2
    (tmp_path / "little.csv").write_text("Timestamp,Current Velocity\n1,2\n")
    assert "no column for OC, VR" in described(tmp_path / "little.csv", (METRICS["OC"], METRICS["VR"]))


def test_an_extended_log_reads_as_the_twelve(write_log: WriteLog, row: Row, tmp_path: Path) -> None:
    header = ",".join(EXTENDED_HEADER)
    empty = "," * (len(EXTENDED_HEADER) - len(COLUMNS))
    lines = [row(i) + (empty if i % 2 else f",0.25{empty[1:]}") for i in range(10)]
    path = tmp_path / "extended.csv"
    path.write_text("\n".join([header, *lines, row(10) + ",0."]))
    log, twelve = read_log(path), read_log(write_log(lines=10))
    for name, column in twelve.columns.items():
        np.testing.assert_array_equal(log.columns[name], column)
    assert np.isfinite(log.columns["VORT [m/s]"]).tolist() == [True, False] * 5
    findings = list(log.findings)
    for last in (row(10, Obstacle_Clearance="") + empty, row(10) + f",rough{empty[1:]}"):
        path.write_text("\n".join([header, *lines, last, ""]))
        findings += read_log(path).findings
    assert [finding.partition(" (")[0] for finding in findings] == [
        "1 row with fewer fields than the header",
        "1 cell without a number in Obstacle Clearance",
        "1 cell without a number in VORT [m/s]",
    ]
