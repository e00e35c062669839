"""Recordings in the hands of viewers: messages are decoded, transforms and the rover are found."""

import json
import shutil
import subprocess
import sys
from collections import Counter
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.clients.conftest import CLIENTS, Run, recorded

NEEDS_READER = pytest.mark.skipif(
    not (CLIENTS / "node_modules" / "@mcap").is_dir(),
    reason="needs @mcap/core from npm: make test-clients",
)
NEEDS_RERUN = pytest.mark.skipif(find_spec("rerun") is None, reason="needs rerun-sdk: make test-clients")


@pytest.fixture
def recording(run: Run, tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    run("--direct", "--duration", "3", "--sensors", "lidar3d,gnss,magnetometer", "--record", str(path))
    return path


@NEEDS_READER
def test_readers_of_foxglove_decode_every_message(recording: Path) -> None:
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


@NEEDS_RERUN
def test_rerun_finds_nothing_wrong_with_it_and_draws_the_rover(recording: Path, tmp_path: Path) -> None:
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
