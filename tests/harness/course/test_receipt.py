"""Receipts: every figure again, what was changed is found, wrong entries in one line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.course.__main__ import main
from harness.course.drive import unseen_seed
from harness.course.entry import find_entry
from harness.course.receipt import read_receipt
from harness.drivers.policy import Policy, write_policy

DRIVER = """
from harness.drivers.beeline import Beeline
class Deaf:
    summary, senses, command = "", (), print
class Mine(Beeline):
    pass
"""


def test_unseen_worlds_and_ones_own_are_driven_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cylinders.csv").write_text("world,x,y\n7,-1.5,6.0\n7,-3.0,6.0\n")
    words = ["--track", "barn", "--seeds", "1", "--jobs", "1", "--out", str(tmp_path)]
    for given, again in ((["--nonce", "n"], []), (of_own := ["--worlds", str(tmp_path)], of_own)):
        assert main(["run", "straight", *words, *given, "--overwrite"]) == 0
        receipt = read_receipt(tmp_path / "straight.json")
        assert (receipt.nonce, receipt.own_worlds) == ("" if again else "n", again == of_own)
        assert main(["verify", str(tmp_path / "straight.json"), "--jobs", "1", *again]) == 0
        assert "every figure is the same" in " ".join(capsys.readouterr().out.split())
    assert receipt.tracks["barn"].episodes[0].goals == 1


def changed(kept: Path, folder: Path, change: dict[str, Any]) -> Path:
    content = json.loads(kept.read_text())
    for track in content["tracks"].values():
        for episode in track["episodes"]:
            episode.update(change)
    (folder / "changed.json").write_text(json.dumps(content))
    return folder / "changed.json"


def test_a_figure_that_was_changed_is_found(
    kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = changed(kept, tmp_path, {"energy": 1.0})
    assert main(["verify", str(path), "--jobs", "1", "--seed", "1"]) == 1
    told = capsys.readouterr().out
    assert told.count("energy was 1.0") == told.count(" was ") == 2  # of either track, and no other


def test_a_score_that_is_not_of_its_episodes_is_refused(kept: Path, tmp_path: Path) -> None:
    for figure in ("score", "spl", "time", "risk_s", "tilt_p95"):
        value = 0.1 if figure == "time" else 1.0
        with pytest.raises(UsageError, match="figures of track barn"):
            read_receipt(changed(kept, tmp_path, {figure: value, "goals": 1, "ending": "reached"}))
    (path := tmp_path / "other.json").write_text(
        json.dumps(json.loads(kept.read_text()) | {"score": 1.0})
    )
    with pytest.raises(UsageError, match="not the mean of its tracks"):
        read_receipt(path)


def test_a_receipt_is_of_one_version_and_one_entry(
    kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = json.loads(kept.read_text())
    for key, value in (("version", "0.0.1"), ("entry_hash", "0")):
        (path := tmp_path / "other.json").write_text(json.dumps(content | {key: value}))
        assert main(["verify", str(path)]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1


def own_entry(folder: Path, said: str = "driver: mine.py:Mine\nlock: requirements.txt\n") -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "entry.yaml").write_text(said)
    (folder / "mine.py").write_text(DRIVER)
    (folder / "requirements.txt").write_text("")
    return folder


def test_an_entry_of_ones_own_drives_as_the_baseline_it_is_made_of(
    tmp_path: Path, kept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    entry = own_entry(tmp_path / "own")
    words = ["--track", "blind", "--seeds", "2", "--jobs", "1", "--out", str(tmp_path)]
    files = ["--json", str(tmp_path / "t.json"), "--page", str(tmp_path / "t.html")]
    assert main(["run", str(entry), *words, *files]) == 0
    (row,) = json.loads((tmp_path / "t.json").read_text())["own"]
    assert (row["track"], row["runs"]) == ("blind", "2")
    assert "blind" in (tmp_path / "t.html").read_text()
    assert main(["run", str(entry), *words]) == 2  # hours may have gone into what is there
    receipt, baseline = read_receipt(tmp_path / "own.json"), read_receipt(kept)
    assert receipt.tracks["blind"] == baseline.tracks["blind"]
    assert receipt.entry_hash != baseline.entry_hash
    (entry / "mine.py").write_text(DRIVER + "# changed")
    assert main(["verify", str(tmp_path / "own.json"), "--entry", str(entry)]) == 2
    assert "broke off" not in capsys.readouterr().out
    (entry / "mine.py").write_text(
        f"{DRIVER}    def command(self, observation):\n        return 0.3, 0.0\n"
    )
    assert main(["run", str(entry), *words, "--overwrite"]) == 1
    told = capsys.readouterr().out
    assert "2 episodes broke off; the first, seed 0 of blind: a plug-in failed" in told
    assert "Mine gives (0.3, 0.0), not a Twist of two numbers" in told


def test_a_policy_drives_every_track_with_the_lidar_that_it_was_made_for(tmp_path: Path) -> None:
    entry = own_entry(tmp_path / "own", "policy: p.npz\nlock: requirements.txt\n")
    layer = np.zeros((13 + 24, 2), np.float32), np.array([0.6, 0.0], np.float32)  # 24 beams; straight on
    write_policy(entry / "p.npz", Policy((layer,)))
    words = ["--track", "barn", "--track", "blind", "--seeds", "1", "--jobs", "1"]
    assert main(["run", str(entry), *words, "--out", str(tmp_path)]) == 0
    tracks = read_receipt(tmp_path / "own.json").tracks
    assert [track.episodes[0].path > 1.0 for track in tracks.values()] == [True, True]


@pytest.mark.parametrize(
    ("said", "named"),
    [
        ("driver: mine.py:Mine\n", "lock"),
        ("driver: mine.py:Mine\nlock: none.txt\n", "none.txt"),
        ("driver: mine.py:Yours\nlock: requirements.txt\n", "Yours"),
        ("driver: mine.py:Deaf\nlock: requirements.txt\n", "head_for"),
        ("driver: other.py:Mine\nlock: requirements.txt\n", "other.py"),
        ("policy: none.npz\nlock: requirements.txt\n", "none.npz"),
        ("launch: [python3, node.py]\nlock: requirements.txt\n", "node"),
        ("lock: requirements.txt\n", "driver, policy and launch"),
        ("drivers: mine.py\nlock: requirements.txt\n", "driver"),
    ],
)
def test_wrong_entries_are_one_line_before_anything_runs(
    said: str, named: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(own_entry(tmp_path / "own", said)), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert named in line
    assert not (tmp_path / "out").exists()


def test_unseen_seeds_depend_on_the_entry_and_the_nonce(tmp_path: Path) -> None:
    entry, other = find_entry("straight"), find_entry(str(own_entry(tmp_path / "own")))
    seeds = {
        unseen_seed(one, nonce, track, number)
        for one in (entry, other)
        for nonce in ("a", "b")
        for track in ("barn", "blind")
        for number in (0, 1)
    }
    assert len(seeds) == 16
    assert min(seeds) > 50
