"""What GitHub is told of scenarios, and what a terminal says of those that pass."""

import re
from pathlib import Path

import pytest

from harness.scenario.__main__ import main

EXPECT = """about: on the level
terrain: flat
driver: straight
duration: 1
expect:
  truth.tilt_deg: {max: 25}
  truth.speed: {max: LIMIT}
  truth.path_length: {max: LIMIT}
"""
NO_BASELINE = """about: as it was
duration: 1
matrix: {robot: [leo, rover_zero4wd]}
expect:
  truth.path_length: {relative: 0.1, over: end}
"""


def test_github_gets_the_line_of_what_failed_and_a_summary(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    summary = tmp_path / "summary.md"
    summary.write_text("# before\n")
    for name, value in (("ACTIONS", "true"), ("STEP_SUMMARY", str(summary)), ("REPOSITORY", "me/mine")):
        monkeypatch.setenv(f"GITHUB_{name}", value)
    monkeypatch.chdir(tmp_path)
    for name, limit in (("a,b", "0.001"), ("good", "5")):
        Path(f"{name}.scenario.yaml").write_text(EXPECT.replace("LIMIT", limit))
    Path("base.scenario.yaml").write_text(NO_BASELINE)
    words = ["a,b.scenario.yaml", "good.scenario.yaml", "base.scenario.yaml", "--jobs", "1"]
    assert main([*words, "--out", "runs"]) == 2
    told = capsys.readouterr().out
    failed, too, lacks = (line for line in told.splitlines() if line.startswith("::error "))
    assert failed.startswith("::error file=a%2Cb.scenario.yaml,line=7,title=a%2Cb::truth.speed: ")
    assert too.startswith("::error file=a%2Cb.scenario.yaml,line=8,title=a%2Cb::truth.path_length: ")
    assert failed.endswith(" (a,b[0])")
    assert lacks.endswith(" and 1 more run)")
    assert lacks.startswith("::error file=base.scenario.yaml,line=1,title=base::there is no baseline")
    assert told.count("there is no baseline of it") == 1 + 1, "by the terminal and by the annotation"
    assert "and 1 more run for the same reason" in told
    written = summary.read_text()
    assert written.startswith("# before\n### 1 of 3 scenarios passed\n")
    assert "| good | passed | 1 | truth.tilt_deg: " in written
    assert "First failure, `a,b[0]`" in written
    assert "https://github.com/me/mine/actions/runs/" in written


def test_a_scenario_that_passes_tells_each_value_beside_its_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "good.scenario.yaml"
    file.write_text(EXPECT.replace("LIMIT", "5"))
    assert main([str(file), "--jobs", "1", "--out", str(tmp_path / "runs")]) == 0
    told = capsys.readouterr().out.splitlines()
    assert [line.split(": ")[0].strip() for line in told[1:3]] == ["truth.tilt_deg", "truth.speed"]
    assert told[1].endswith(" deg (<= 25)")
    assert told[2].endswith(" m/s (<= 5)")
    file.write_text(EXPECT.replace("LIMIT", "5").replace("flat", "rocky"))
    assert main([str(file), "--seeds", "2", "--jobs", "1", "--out", str(tmp_path / "runs")]) == 0
    assert re.search(r"truth\.tilt_deg: [\d.]+ to [\d.]+ deg \(<= 25\)", capsys.readouterr().out)
