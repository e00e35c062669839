from pathlib import Path

import pytest

from harness.run import main

QUICK = ["--direct", "--terrain", "flat", "--duration", "2"]


def test_report_option_writes_the_page_and_changes_no_byte_of_the_log(tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    assert main([*QUICK, "--log-dir", str(tmp_path / "with"), "--report", str(page)]) == 0
    assert main([*QUICK, "--log-dir", str(tmp_path / "without")]) == 0
    (with_report,), (without,) = ((tmp_path / d).glob("*.csv") for d in ("with", "without"))
    assert with_report.read_bytes() == without.read_bytes()
    assert "<h1>leo on flat</h1>" in page.read_text(encoding="utf-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "with", "without"]


def test_a_failed_run_gets_its_report_and_exit_code_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.physics.simulation.EDGE_MARGIN", 19.5)
    page = tmp_path / "report.html"
    words = ["--direct", "--terrain", "flat", "--driver", "straight", "--duration", "120"]
    assert main([*words, "--log-dir", str(tmp_path), "--report", str(page)]) == 1
    top = page.read_text(encoding="utf-8").partition("<main>")[0]
    assert "<strong>Failed</strong>" in top
    assert "the rover reached the edge of the map" in top


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ("absent/report.html", "create it first"),
        (".", "is a folder; name a file"),
        ("/proc/report.html", "/proc/report.html cannot be written: "),
    ],
)
def test_unwritable_report_is_refused_in_one_line_before_the_run(
    place: str, expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [*QUICK, "--log-dir", str(tmp_path / "logs"), "--report", str(tmp_path / place)]
    assert main(words) == 2
    told = capsys.readouterr().err
    assert expected in told
    assert told.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
