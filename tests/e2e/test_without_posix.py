"""What needs no ROS runs where there is nothing of POSIX (Windows); no claim beyond these commands."""

import importlib
import os
import sys
from pathlib import Path

from tests.rover_metrics.test_replay import drive, write_folder
from tests.support.forking import ForkServer
from tests.support.without_posix import hide_posix

COMMANDS = {
    "harness.run --direct --terrain flat --duration 1.2 --log-dir . --report r.html --summary s.json": 0,
    "rover_metrics.analyze metrics_log.csv -m CV -p time_series -o .": 0,
    "rover_metrics.replay bag -o metrics_log.csv": 0,
    # Too short to support a threshold, which is what 1 says.
    "harness.tune --robot leo --episodes 2 --duration 2 --jobs 1 --out .": 1,
}


def run_all(folder: Path) -> None:
    """In a process of its own: runs the commands; leaves with 0 if each ends as it should."""
    hide_posix()
    os.chdir(folder)
    sys.stdout = sys.stderr = (folder / "told.txt").open("w", encoding="cp1252")
    codes = {}
    for command in reversed(COMMANDS):
        module, *words = command.split()
        loaded = importlib.import_module(module)
        program = loaded if hasattr(loaded, "main") else importlib.import_module(f"{module}.__main__")
        codes[command] = program.main(words)
    sys.exit(codes != COMMANDS)


def test_without_posix_everything_but_ros_runs(tmp_path: Path) -> None:
    write_folder(tmp_path / "bag", drive(2.5))
    process = ForkServer().get_context("spawn").Process(target=run_all, args=(tmp_path,))
    process.start()
    process.join()
    told = (tmp_path / "told.txt").read_text(encoding="cp1252")
    assert process.exitcode == 0, told
    written = {path.name for path in tmp_path.iterdir()}
    assert {"r.html", "s.json", "metrics_log.csv", "leo.yaml", "report.html"} < written
    assert "Traceback" not in told
