"""The parameter file of a tuning: what metrics_node makes of it."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from ruamel.yaml import YAML

from harness.tune.episodes.plan import Part
from harness.tune.output import parameter_file
from harness.tune.scoring.choose import Candidate
from harness.tune.scoring.estimate import Estimate

if TYPE_CHECKING:
    from tests.harness.tune.conftest import Sweep

pytest.importorskip("rclpy", reason="needs ROS 2")

from harness import run
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS


@pytest.mark.usefixtures("ros_domain")
def test_metrics_node_takes_every_value_of_the_file(small_sweep: "Sweep", tmp_path: Path) -> None:
    study = small_sweep[0][0]
    file = tmp_path / "leo.yaml"
    file.write_text(parameter_file(study, "a command"))
    parameters = YAML(typ="safe").load(file)["/**"]["ros__parameters"]
    words = ["--duration", "1", "--log-dir", str(tmp_path), "--extended"]
    exit_code = run.main([*words, "--ros-args", "--params-file", str(file)])
    (manifest,) = tmp_path.glob("*.json")
    thresholds = json.loads(manifest.read_text())["thresholds"]
    assert exit_code == 0
    assert parameters["collision_threshold"] == study.collision.verdict.value
    for name, value in thresholds.items():
        assert value == parameters.get(name, getattr(DEFAULT_THRESHOLDS, name))


def test_a_threshold_that_is_not_supported_is_only_a_comment(small_sweep: "Sweep") -> None:
    study = small_sweep[0][1]  # drove on a smooth floor and touched nothing
    text = parameter_file(study, "a command")
    parameters = YAML(typ="safe").load(text)["/**"]["ros__parameters"]
    unsupported = [verdict for verdict in study.verdicts if verdict.lack is not None]
    assert unsupported
    for verdict in unsupported:
        assert verdict.name not in parameters
        default = f"{verdict.default.value:g} {verdict.unit}"
        default = "false" if verdict.name == "near_returns_as_contact" else default
        assert f"# {verdict.name} stays at {default}: {verdict.lack}" in text
    assert parameters["footprint"] == [-0.272, -0.223, 0.268, -0.223, 0.268, 0.223, -0.272, 0.223]
    assert "footprint_threshold" not in parameters


def test_only_what_beats_its_default_is_written(small_sweep: "Sweep") -> None:
    study = small_sweep[0][0]
    near, threshold = study.collision.footprint
    scores = {Part.TRAIN: {"F1": Estimate(0.9)}, Part.TEST: {"F1": Estimate(0.9961, 0.9932, 0.9975)}}
    tuned, gain = Candidate(value=True, scores=scores), {"F1": Estimate(0.009, 0.006, 0.012)}
    better = replace(near, tuned=tuned, gain=gain)
    same = replace(threshold, tuned=threshold.default, gain={"F1": Estimate(0.0, 0.0, 0.0)}, lack=None)
    collision = replace(study.collision, footprint=(better, same))
    text = parameter_file(replace(study, collision=collision), "a command")
    parameters = YAML(typ="safe").load(text)["/**"]["ros__parameters"]
    assert parameters["near_returns_as_contact"] is True
    assert "# F1 on unseen seeds 0.996 (0.993 to 0.998); with the default, false: " in text
    assert "footprint_threshold" not in parameters
    assert "# footprint_threshold stays at 0.05 m: no value is proven to be better" in text
