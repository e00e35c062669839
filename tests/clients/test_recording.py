"""Recordings in the hands of viewers: messages are decoded, transforms and the rover are found."""

import json
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.clients.conftest import CLIENTS, Run, recorded


@pytest.fixture
def recording(run: Run, tmp_path: Path, ros_domain: int) -> Path:  # noqa: ARG001 - sets the domain
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    path = tmp_path / "run.mcap"
    run("--duration", "3", "--sensors", "lidar3d,gnss,magnetometer", "--record", str(path))
    return path


def test_readers_of_foxglove_decode_every_message(recording: Path) -> None:
    if not (CLIENTS / "node_modules" / "@mcap").is_dir():
        pytest.skip("needs @mcap/core from npm: make test-clients")
    script = shutil.copy(Path(__file__).with_name("read_mcap.mjs"), CLIENTS)
    said = subprocess.run(
        [shutil.which("node") or "node", script, recording], capture_output=True, check=True, text=True
    )
    found = json.loads(said.stdout)
    ours = recorded(recording)
    assert found["counts"] == Counter(topic for topic, _, _ in ours)
    assert found["nearest"] == min(float(m.ranges.min()) for topic, _, m in ours if topic == "/scan")
    assert {"base_link", "lidar_link"} <= set(found["transforms"])
    assert found["description"].startswith("<?xml") or "<robot" in found["description"]


def test_rerun_finds_nothing_wrong_with_it_and_draws_the_rover(recording: Path, tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="needs rerun-sdk: make test-clients")

    def rerun(*words: str | Path) -> list[str]:
        command = [sys.executable, "-m", "rerun", *words]
        return subprocess.run(command, capture_output=True, check=True, text=True).stdout.splitlines()

    topics = {topic for topic, _, _ in recorded(recording)}
    checked = [line.split() for line in rerun("mcap", "check", recording)]
    assert {words[3] for words in checked if words[:1] == ["ok"] and len(words) > 3} >= topics
    kept = tmp_path / "run.rrd"
    rerun("mcap", "convert", recording, "-o", kept)
    rerun("rrd", "verify", kept)
    entities = "\n".join(rerun("rrd", "print", kept))
    assert "/leo/visual_geometries/base_link/" in entities
    assert "/lidar3d/points" in entities
