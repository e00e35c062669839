"""The parameter files that are shipped: what the command in their header gives.

`tests/data/sweep` keeps the episodes of that command, for driving them takes minutes; some of them are
driven again for a few seconds, so that neither the simulator nor the scoring can change unnoticed.
Make all anew with the command, `--out tests/data/sweep`, keep scores.json there and copy the YAML files.
"""

import json
import shlex
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.spec.run import Run
from harness.tune import __main__ as tune
from harness.tune.episodes import sweep
from harness.tune.episodes.plan import Planned, plan
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.episodes.store import decode
from harness.tune.episodes.sweep import drive
from harness.tune.output import SCORES

ROOT = Path(__file__).parents[3]
SWEEP, CONFIG = ROOT / "tests" / "data" / "sweep", ROOT / "rover_metrics" / "config"
ROBOTS = ("leo", "rover_zero4wd")
DRIVEN_AGAIN, SECONDS = (2, 9), 8  # a Leo that rams, a rover_zero4wd that grazes


def command_in(path: Path) -> list[str]:
    """The arguments in a file's header."""
    line = next(line for line in path.read_text().splitlines() if line.startswith("# Made by: "))
    return shlex.split(line.removeprefix("# Made by: python -m harness.tune").partition("(")[0])


def test_the_shipped_files_are_as_commanded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(SWEEP, tmp_path, dirs_exist_ok=True)
    (tmp_path / SCORES).unlink()
    monkeypatch.setattr(sweep, "drive", _not_to_be_driven)
    monkeypatch.setattr("harness.tune.output.render", lambda *_: "")  # the page takes half of the time
    exit_code = tune.main([*command_in(CONFIG / "leo.yaml"), "--jobs", "1", "--out", str(tmp_path)])
    assert exit_code == 0
    for robot in ROBOTS:
        assert (tmp_path / f"{robot}.yaml").read_text() == (CONFIG / f"{robot}.yaml").read_text()
    ours, kept = (_leaves(json.loads((at / SCORES).read_text())) for at in (tmp_path, SWEEP))
    numbers = {path for path, value in kept.items() if isinstance(value, float | int)}
    assert ours.keys() == kept.keys()
    for path in kept.keys() - numbers:
        assert ours[path] == kept[path], path
    for path in numbers:
        assert ours[path] == pytest.approx(kept[path], rel=1e-4, abs=1e-5), path


def _leaves(value: object, path: str = "") -> dict[str, Any]:
    """Every number, word and null of a JSON value, by the keys that lead to it."""
    if not isinstance(value, dict | list):
        return {path: value}
    items = value.items() if isinstance(value, dict) else enumerate(value)
    return {k: v for key, item in items for k, v in _leaves(item, f"{path}/{key}").items()}


@pytest.mark.parametrize("index", DRIVEN_AGAIN)
def test_the_episodes_are_what_the_simulator_gives(index: int) -> None:
    planned = _shipped_plan()[index]
    kept = decode((SWEEP / "episodes" / f"{planned.name}.npz").read_bytes())
    again = drive(planned.run.alone(duration=float(SECONDS)))
    _assert_same_start(again, kept)


def _not_to_be_driven(run: Run) -> EpisodeRecord:
    pytest.fail(f"not kept: {run}")


def _shipped_plan() -> tuple[Planned, ...]:
    options = tune._parser().parse_args(command_in(CONFIG / "leo.yaml"))
    return plan(options.robot, options.episodes, options.seed, options.duration)


def _assert_same_start(again: EpisodeRecord, kept: EpisodeRecord) -> None:
    """Equal up to what processors differ in."""
    assert len(again.scans) == SECONDS * 20
    for column in ("stamp_ms", "contact", "near_returns"):
        np.testing.assert_array_equal(again.scans[column], kept.scans[column][: len(again.scans)])
    for column in ("nearest", "footprint", "speed"):
        known = kept.scans[column][: len(again.scans)]
        np.testing.assert_allclose(again.scans[column], known, atol=2e-3, err_msg=column)
    for column in again.windows.dtype.names or ():
        known = kept.windows[column][:SECONDS]
        np.testing.assert_allclose(again.windows[column], known, 1e-2, 1e-4, err_msg=column)
    over = kept.events[kept.events["end_s"] < SECONDS - 0.5]
    for column in ("zone", "sight", "part"):
        np.testing.assert_array_equal(again.events[column][: len(over)], over[column], err_msg=column)
