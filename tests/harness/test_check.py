"""harness.check: what it compares, what it concludes, and that it leaves nothing behind."""

import re
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from harness.base.interrupt import StopRequest
from harness.check import _judged, main
from harness.episode import fingerprint as prints
from harness.episode.direct import run_direct
from harness.episode.episode import Episode
from harness.episode.fingerprint import (
    Fingerprint,
    StreamHash,
    fingerprint,
)
from harness.sensors.noise import WHITE
from harness.spec.run import Run
from tests.support.complaint import complaint, without_progress
from tests.support.forking import ForkServer

QUICK = ["--terrain", "flat", "--duration", "5"]
NO_ROS = [*QUICK, "--no-ros"]
REFERENCE = Fingerprint(samples=10, rows=2, lost=0, stream="a1", csv="b2")


def stream_hash(config: Run) -> str:
    stream = StreamHash()
    for batch in Episode(config).batches():
        stream.take(batch)
    return stream.hexdigest()


@cache
def in_this_process(config: Run) -> Fingerprint:
    return fingerprint(run_direct, config, StopRequest())


@pytest.fixture
def _each_config_runs_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prints, "fingerprint", lambda _, config, __: in_this_process(config))
    monkeypatch.setattr(prints, "direct_in_fresh_process", in_this_process)


@pytest.mark.usefixtures("ros_domain")
def test_check_passes_here_through_ros_and_leaves_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("harness.episode.fingerprint.multiprocessing", ForkServer())
    assert main(QUICK) == 0
    told = capfd.readouterr()
    assert (told.out.count("equal"), told.out.count("different")) == (3, 1)
    assert told.out.splitlines()[-1].startswith(
        "proven for leo on flat: seed 0 gives the same samples and the same CSV bytes in 4 runs (this "
        "process, again, fresh process, through ROS 2), seed 1 gives others, and none of "
    )
    assert without_progress(told.err) == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("_each_config_runs_once")
def test_check_without_ros_on_request_says_so_and_passes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(NO_ROS) == 0
    told = capsys.readouterr().out
    assert "skipped" in told
    assert told.count("equal") == 2
    counts = [int(n.replace(",", "")) for n in re.findall(r" +([\d,]+) +5 +0 ", told)]
    assert told.splitlines()[-1] == (
        "proven for leo on flat, not through ROS 2: seed 0 gives the same samples and the same CSV "
        "bytes in 3 runs (this process, again, fresh process), seed 1 gives others, and none of "
        f"{sum(counts):,} samples was lost"
    )
    assert len(counts) == 4
    run = Run.of(terrain="flat", duration=5.0, noise="white")  # so that every generator takes part
    assert told.count(in_this_process(run).stream[:8]) == 3


@pytest.mark.usefixtures("_each_config_runs_once")
def test_missing_ros_that_nobody_left_out_is_neither_proof_nor_disproof(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for module in [name for name in sys.modules if name.startswith("harness.ros.")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "rclpy", None)
    assert main(QUICK) == 2
    told = capsys.readouterr()
    assert "skipped" in told.out
    assert "--no-ros" in told.err


@pytest.mark.usefixtures("_each_config_runs_once")
def test_drifting_run_fails_the_check(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(prints, "direct_in_fresh_process", lambda _: REFERENCE)
    assert main(NO_ROS) == 1
    told = capsys.readouterr()
    assert "fresh process: DIFFERENT" in told.err
    assert "proven" not in told.out


@pytest.mark.parametrize(
    ("change", "must_be_equal", "passed"),
    [
        ({}, True, True),
        ({"stream": "c3"}, True, False),
        ({"csv": "c3"}, True, False),
        ({"lost": 1}, True, False),
        ({}, False, False),
        ({"stream": "c3"}, False, False),
        ({"csv": "c3"}, False, False),
        ({"stream": "c3", "csv": "d4"}, False, True),
    ],
)
def test_equal_runs_must_agree_in_everything_and_different_ones_in_nothing(
    change: dict[str, object], must_be_equal: bool, passed: bool
) -> None:
    found = replace(REFERENCE, **change)  # type: ignore[arg-type]  # values of several types
    assert _judged("run", found, REFERENCE, equal=must_be_equal).passed == passed


def test_every_sensor_reading_counts_in_the_hash_of_a_stream() -> None:
    config = Run.of(terrain="flat", duration=1.0)
    plain = stream_hash(config)
    assert plain == stream_hash(config)
    assert plain != stream_hash(config.alone(noise=WHITE.name))
    assert plain != stream_hash(config.alone(lidar_beams=641))
    assert plain != stream_hash(config.alone(duration=1.01))


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--terrain", "moon"], "available: flat, slope"),
        (["--duration", "1"], "give 5 s or more"),
        (["--seed", "x"], "argument --seed: 'x' is not valid; give a whole number"),
    ],
)
def test_bad_argument_is_one_line_that_names_what_is_valid(
    arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    told = complaint(main, arguments, capsys)
    assert told.startswith("harness.check: ")
    assert expected in told
