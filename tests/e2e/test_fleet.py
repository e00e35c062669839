"""Several rovers in one world through real DDS: the bytes of --direct, a namespace each, one clock."""

import json
from pathlib import Path

import pytest

from harness.run import main

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
pytestmark = pytest.mark.usefixtures("ros_domain")

ROVERS = ("--rover", "rover_zero4wd:one,driver=spin", "--rover", "leo:two,driver=straight,noise=white")
WORDS = (
    *ROVERS,
    *("--terrain", "flat", "--duration", "2", "--lidar-beams", "16", "--actor", "g=3,0/3,4"),
    *("--fault", "scan:dropout=0.5", "--extended"),
)


def test_each_rover_logs_what_it_logs_without_ros_and_nothing_is_lost(tmp_path: Path) -> None:
    """With faults, people and extended columns, which are of each rover's own footprint."""
    told = ["--summary", str(tmp_path / "run.json"), "--record", str(tmp_path / "run.mcap")]
    assert main([*WORDS, "--log-dir", str(tmp_path / "ros"), *told]) == 0
    assert main([*WORDS, "--log-dir", str(tmp_path / "direct"), "--direct"]) == 0
    for kind in ("*.csv", "social/*.csv"):
        logs = {}
        for name in ("one", "two"):
            (through_ros,), (direct,) = ((tmp_path / way / name).glob(kind) for way in ("ros", "direct"))
            logs[name] = through_ros.read_bytes()
            assert logs[name] == direct.read_bytes()
            assert logs[name].count(b"\n") > 1
        assert logs["one"] != logs["two"]
    manifests = [json.loads((tmp_path / f"run_{name}.json").read_text()) for name in ("one", "two")]
    for name, manifest in zip(("one", "two"), manifests, strict=True):
        topics = manifest["topics"]
        assert topics.keys() > {f"/{name}/scan", f"/{name}/tf", f"/{name}/g_actor/pose", "/clock"}
        assert all(topic.startswith((f"/{name}/", "/clock")) for topic in topics)
        assert manifest["lost"] == 0
        assert topics[f"/{name}/imu/data"]["received"] == 40
        assert manifest["arguments"]["name"] == name
    assert manifests[0]["topics"]["/clock"] == manifests[1]["topics"]["/clock"]
    recorded = (tmp_path / "run.mcap").read_bytes()
    assert b"/one/odometry/wheels" in recorded
    assert b"/two/odometry/wheels" in recorded
