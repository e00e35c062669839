"""The command, from its words to what it prints and writes."""

import csv
import json
import re
import resource
import runpy
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from rover_metrics.analyze import main
from tests.support.figures import described
from tests.support.snapshots import check_snapshot

Row = Callable[..., str]
WriteLog = Callable[..., Path]
Run = Callable[..., tuple[int, str, str]]
LIBRARIES = {"matplotlib", "numpy", "pandas", "rich", "scipy"}


@pytest.fixture
def run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command with an output folder of its own; gives exit code, stdout, stderr."""

    def call(*words: object) -> tuple[int, str, str]:
        output = [] if "-o" in words else ["-o", tmp_path / "out"]
        return main([*map(str, (*words, *output))]), *capsys.readouterr()

    return call


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> dict[str, Figure]:
    """The figures of a run, by name, which are not written: that takes seconds."""
    figures: dict[str, Figure] = {}

    def keep(figure: Figure, folder: Path, name: str) -> list[Path]:
        assert mpl.rcParams["pdf.fonttype"] == 42  # a font of its own: text stays text
        figures[name] = figure
        return [folder / f"{name}.png"]

    monkeypatch.setattr("rover_metrics.analysis.output.save", keep)
    return figures


def as_json(outcome: tuple[int, str, str], code: int = 0) -> Any:  # noqa: ANN401  # JSON
    assert outcome[0] == code, outcome[2]
    return json.loads(outcome[1])


def test_every_metric_of_a_log_is_worked_out(run: Run, write_log: WriteLog) -> None:
    words = (write_log(lines=71), "-p", "--json")
    assert as_json(run(*words, "--confidence-level", "0.9"))["confidence"] == 0.9
    result = as_json(run(*words))
    assert (result["confidence"], result["iqr_multiplier"], result["unit"]) == (0.95, 1.5, "log")
    (log,) = result["logs"]
    metrics = log["metrics"]
    speeds = np.array([0.5 + 0.01 * (i % 3) for i in range(71)])
    means = {"TC": 120.0, "CS": 0.0, "SM": 12_000.0, "TSR": 10.0, "DT": 30.0, "RT": 100 * 10 / 71}
    means |= {"CV": speeds.mean(), "VORT": speeds[6::7].mean()}
    assert {code: metrics[code]["mean"] for code in means} == pytest.approx(means, rel=1e-6)
    assert (len(metrics), metrics["VORT"]["n"]) == (11, 10)
    assert log["per_metre"] == {"TC": pytest.approx(4.0), "SM": pytest.approx(400.0)}
    assert (log["rows"], log["duration"], log["episodes"]) == (71, 70.0, 1)


def test_a_column_without_a_name_changes_nothing(run: Run, write_log: WriteLog, tmp_path: Path) -> None:
    """As pandas writes, which numbers the rows."""
    log = write_log(lines=71)
    pd.read_csv(log).to_csv(numbered := tmp_path / "numbered.csv")
    metrics = [
        as_json(run(path, "-m", "all", "-p", "--json"))["logs"][0]["metrics"] for path in (log, numbered)
    ]
    assert metrics[0] == metrics[1]


def test_a_page_has_the_pictures_and_the_tables(run: Run, write_log: WriteLog, tmp_path: Path) -> None:
    page = tmp_path / "a.html"
    code, out, _ = run(write_log(lines=31), "-m", "CV", "-p", "time_series", "--page", page)
    assert (code, f"page: {page}" in out) == (0, True)
    written = page.read_text()
    assert (written.count("<svg"), written.count("<table")) == (1, 1)
    assert not re.search(r"""(?:src|href)=["']https?:""", written)


def test_two_groups_are_compared(
    run: Run, write_log: WriteLog, row: Row, drawn: dict[str, Figure], tmp_path: Path
) -> None:
    slow = logs_at(write_log, row, "slow", [0.1, 0.2, 0.3, 0.15])
    fast = logs_at(write_log, row, "fast", [0.5, 0.6, 0.7, 0.9])
    words = [*slow, "--versus", *fast, "-m", "CV", "OC", "TC", "--group-names", "slow", "fast"]
    (comparison, *_) = as_json(run(*words, "-p", "--json"))["comparisons"]
    assert (comparison["n"], comparison["cliffs_delta"]) == ([4, 4], 1.0)
    assert comparison["p"] == pytest.approx(2 / 70)
    assert comparison["difference"] == pytest.approx(0.675 - 0.1875, rel=1e-5)
    plots = ("correlation", "aggregate", "comparison")
    more = ["--confidence-level", "0.9", "--fixed-interval", "5"]
    more += ["--iqr-multiplier", "0.5", "--unit", "log"]
    code, out, err = run(*words, "-p", *plots, "--csv", "--latex", "--save-outliers", *more)
    assert (code, err, tuple(drawn)) == (0, "", plots)
    files = sorted((tmp_path / "out").iterdir())
    parts = [out, *(f"== {path.name}\n{path.read_text()}" for path in files)]
    parts += [f"== {name}\n{described(figure)}" for name, figure in drawn.items()]
    check_snapshot("analyze.txt", "\n".join(parts).replace(str(tmp_path), "FOLDER"))


def test_a_folder_is_read_with_those_below_it_but_for_logs_of_people(
    run: Run, write_log: WriteLog, row: Row, tmp_path: Path
) -> None:
    log = write_log("a.csv", [row(i) for i in range(20)])
    folder = tmp_path / "logs"
    for place in ("a.csv", "rover2/b.csv", "social/social_log_1.csv"):
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (folder / place).write_text(log.read_text() if "social" not in place else "Time,Ann\n")
    found = as_json(run(folder, "-m", "OC", "-p", "--json"))
    assert {Path(one["path"]).name for one in found["logs"]} == {"a.csv", "b.csv"}


def test_outliers_are_counted(run: Run, write_log: WriteLog, row: Row, tmp_path: Path) -> None:
    lines = [row(i) for i in range(60)]
    lines[30] = row(30, Obstacle_Clearance=50.499803)  # float32 would say 50.499802
    log = write_log("=1+1.csv", lines)

    def clearance(*words: str) -> Any:  # noqa: ANN401  # from JSON
        (found,) = as_json(run(log, "-m", "OC", "CV", "-p", "--json", *words))["logs"]
        summary = found["metrics"]["OC"]
        return found["outliers"]["OC"], summary["n"], summary["maximum"]

    assert clearance() == (1, 60, 50.499803)
    assert clearance("--iqr-multiplier", "1000") == (0, 60, 50.499803)
    assert clearance("--remove-outliers") == (1, 59, pytest.approx(1.4))
    assert clearance("--remove-outliers", "--iqr-multiplier", "1000")[:2] == (0, 60)
    words = ("-m", "OC", "CV", "-p", "--json", "--save-outliers")
    made = tmp_path / "a/b/outliers.csv"
    assert as_json(run(log, *words, "-o", made.parent))["files"] == [str(made)]
    with made.open(newline="") as file:
        (saved,) = csv.DictReader(file)
    titles = ("Log", "Path", "Timestamp", "Metric", "Value", "Unit")
    cells = ("'=1+1", str(log), "130.0", "OC", "50.499803", "m")  # and no formula
    assert saved == dict(zip(titles, cells, strict=True))


def logs_at(write_log: WriteLog, row: Row, group: str, velocities: list[float]) -> list[Path]:
    return [
        write_log(f"{group}/{i}.csv", [row(s, Current_Velocity=v + 0.01 * (s % 2)) for s in range(20)])
        for i, v in enumerate(velocities)
    ]


def driven(log: Path, seed: int) -> Path:
    """A log with the record of the harness's run that it is of."""
    arguments = {"robot": "leo", "terrain": "rocky", "difficulty": 0.5, "seed": seed}
    log.with_suffix(".json").write_text(json.dumps({"outcome": {}, "arguments": arguments}))
    log.write_text("".join(log.read_text().splitlines(keepends=True)[:11]))  # too short for a bootstrap
    return log


def test_groups_of_the_same_seeds_are_compared_in_pairs(run: Run, write_log: WriteLog, row: Row) -> None:
    slow = logs_at(write_log, row, "slow", [0.1, 0.4, 0.3])
    fast = logs_at(write_log, row, "fast", [0.4, 0.2, 0.5])
    for seed, (first, second) in enumerate(zip(slow, (fast[1], fast[2], fast[0]), strict=True)):
        driven(first, seed), driven(second, seed)
    words = [*slow, "--versus", *fast, "-m", "CV", "-p", "--json"]
    (paired,) = as_json(run(*words))["comparisons"]
    assert (paired["paired"], paired["p"]) == (True, 0.25)  # 0.1 each, two signs of eight
    assert paired["interval"] == pytest.approx([0.1, 0.1], abs=1e-6) or paired["interval"] is None
    (unpaired,) = as_json(run(*words, "--pair-by", "none"))["comparisons"]
    assert (unpaired["paired"], unpaired["difference"]) == (False, pytest.approx(0.1))
    (ordered,) = as_json(run(*words, "--pair-by", "order"))["comparisons"]
    assert (ordered["paired"], ordered["p"]) == (True, 0.75)
    assert as_json(run(*words, "--unit", "episode"))["comparisons"][0]["paired"] is False
    code, _, err = run(*words, "--pair-by", "order", "--versus", fast[0], "missing.csv", fast[1])
    assert code == 2
    assert "--pair-by order: missing.csv was skipped; leave out its partner too" in err


def test_any_column_is_a_metric(
    run: Run, write_log: WriteLog, row: Row, drawn: dict[str, Figure]
) -> None:
    logs = logs_at(write_log, row, "a", [0.1, 0.2, 0.3]) + logs_at(write_log, row, "b", [0.5, 0.6, 0.7])
    for i, log in enumerate(logs):
        head, *rows = log.read_text().splitlines()[:11]
        jerk = [f"{line},{40 * i + s},Bob,,{s}" for s, line in enumerate(rows)]
        log.write_text("\n".join([f"{head},Peak Jerk [m/s^3],Driver,Slip,Scan Lost", *jerk]) + "\n")
    words = [*logs[:3], "--versus", *logs[3:]]
    result = as_json(run(*words, "-m", "all", "--json"))
    (figure,) = drawn.values()
    assert list(drawn) == ["comparison"]
    ranked = [item["code"] for item in result["comparisons"]]
    effects = [abs(item["hedges_g"] or 0.0) for item in result["comparisons"]]
    assert effects == sorted(effects, reverse=True)
    assert set(ranked[:3]) == {"CV", "VORT", "Peak Jerk [m/s^3]"}
    assert {"Driver", "Slip"}.isdisjoint(ranked)  # no numbers
    title = figure.axes[0].get_title(loc="left").split("\n")[0]
    assert title == result["titles"][ranked[0]].partition(" [")[0]
    odd = "10 cells without a number in Driver (first on line 2, 'Bob'): left out"
    assert odd in result["logs"][0]["findings"]
    one = as_json(run(*logs[:2], "-m", "peak jerk", "scan lost", "slip", "--json", "--csv", "--latex"))
    metrics = one["logs"][0]["metrics"]
    assert metrics["Peak Jerk [m/s^3]"]["mean"] == 4.5
    assert metrics["Scan Lost"]["mean"] == 60.0  # a count, so by the minute
    assert list(metrics) == ["Peak Jerk [m/s^3]", "Scan Lost"]
    assert "time_series_Peak_Jerk_m_s_3" in drawn
    names = ["a/b", "A b", "../..", "X\x1b"]  # each gets a file of its own
    logs[0].write_text("\n".join([",".join([head, *names]), *(f"{line},1,2,3,4" for line in rows)]))
    drawn.clear()
    twice = (logs[0], logs[0].parent / ".." / logs[0].parent.name / logs[0].name)
    last = as_json(run(*twice, "-m", *names, "--gap", "0.5", "--json"))
    assert [name.removeprefix("time_series_") for name in drawn] == ["a_b", "A_b_2", "column", "X"]
    assert [log["episodes"] for log in last["logs"]] == [len(rows)]  # named twice, counted once


def test_a_bad_file_is_one_line_beside_the_rest(run: Run, write_log: WriteLog, tmp_path: Path) -> None:
    empty, missing = tmp_path / "empty.csv", tmp_path / "missing.csv"
    empty.touch()
    outcome = run(empty, write_log(), missing, "-m", "CV", "-p", "--json")
    result = as_json(outcome, code=2)
    assert outcome[2].splitlines() == [
        f"analyze: skipped {empty}: the file is empty",
        f"analyze: skipped {missing}: there is no such file",
    ]
    assert [log["label"] for log in result["logs"]] == ["log"]
    assert [skipped["path"] for skipped in result["skipped"]] == [str(empty), str(missing)]
    assert run(missing) == (2, "", f"analyze: skipped {missing}: there is no such file\n")
    assert not (tmp_path / "out").exists()


def test_no_name_of_a_log_breaks_anything(run: Run, write_log: WriteLog, tmp_path: Path) -> None:
    names = ["$x_{.csv", "_hidden.csv", "[red]bold.csv", "a\nb\x1b[31m.csv", "..csv"]
    logs = [write_log(name) for name in names]
    before = {path for path in tmp_path.rglob("*") if "out" not in path.parts}
    code, out, err = run(*logs, tmp_path / "..\n..", "-m", "CV")
    assert code == 2
    assert len(err.splitlines()) == 1
    assert "\x1b" not in out + err
    assert "[red]bold: 60 rows" in out
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == ["time_series_CV.pdf", "time_series_CV.png"]
    assert {path for path in tmp_path.rglob("*") if "out" not in path.parts} == before


@pytest.mark.parametrize("words", ["--csv", "--latex", "-p correlation", "--save-outliers"])
def test_a_disk_that_takes_nothing_is_told_and_left_without_a_torn_file(
    words: str, run: Run, write_log: WriteLog, tmp_path: Path
) -> None:
    log = write_log()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, limits[1]))
    try:
        code, _, err = run(log, *words.split())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (code, "File too large; choose another folder with -o" in err) == (2, True)
    assert list((tmp_path / "out").iterdir()) == []


def test_an_output_folder_that_cannot_be_is_told(run: Run, write_log: WriteLog) -> None:
    log = write_log()
    assert run(log, "-m", "XX")[0] == 2
    for folder, reason in ((log, "File exists"), ("a\0b", "embedded null byte")):
        named = str(folder).replace("\0", "?")
        told = f"analyze: cannot write to {named}: {reason}; choose another folder with -o\n"
        assert run(log, "-o", folder) == (2, "", told)


def test_without_ros_it_ends_quietly_with_its_reader(write_log: WriteLog, tmp_path: Path) -> None:
    (tmp_path / "rclpy.py").write_text("raise AssertionError('imported')\n")
    paths = [str(tmp_path), *(path for path in sys.path if path)]
    words = [str(write_log()), "-m", "CV", "-p", "--json"]
    command = [sys.executable, "-m", "rover_metrics.analyze", *words]
    program = subprocess.run(
        ["/bin/sh", "-c", 'exec "$@" | head -c 1', "sh", *command],
        cwd=tmp_path,
        env={"PYTHONPATH": ":".join(paths)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert program.stdout == "{"
    assert program.stderr == ""


@pytest.mark.parametrize("missing", sorted(LIBRARIES))
def test_it_says_which_library_to_install(
    missing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in list(sys.modules):
        if name.partition(".")[0] in {missing, "rover_metrics"}:
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    monkeypatch.setattr(sys, "argv", ["analyze", "log.csv"])
    with pytest.raises(SystemExit, match=r"^2$"):
        runpy.run_module("rover_metrics.analyze", run_name="__main__")
    out, told = capsys.readouterr()
    told, _, reason = told.partition(" (")
    assert out == ""
    assert told.startswith("analyze needs five libraries: pip install ")
    assert set(told.partition("pip install ")[2].split()) == LIBRARIES
    assert missing in reason
