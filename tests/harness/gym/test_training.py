"""`rover-policy train`: a short training writes a policy that drives, and a curve of few episodes."""

from pathlib import Path

import pytest

from harness.drivers.policy import read_policy
from harness.gym.policy import main

pytest.importorskip("stable_baselines3", reason="needs the extra [train]")


def test_a_short_training_writes_a_policy_and_a_curve(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    policy, curve, config = tmp_path / "p.npz", tmp_path / "curve.png", tmp_path / "train.yaml"
    config.write_text(
        f"{{policy: {policy}, curve: {curve}, terrains: [flat], steps: 2048, environments: 2, "
        "hold: 8, time_limit: 2}"
    )
    assert main(["train", str(config)]) == 0
    assert str(policy) in capsys.readouterr().out
    assert curve.read_bytes().startswith(b"\x89PNG")
    assert read_policy(policy).beams == 640


@pytest.mark.parametrize(
    ("said", "named"),
    [("terrains: [nowhere]", "nowhere"), ("stepps: 3", "stepps"), ("robot: nobody", "nobody")],
)
def test_a_mistake_is_one_line_before_anything_is_learnt(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], said: str, named: str
) -> None:
    config = tmp_path / "train.yaml"
    config.write_text(f"{{policy: {tmp_path / 'p.npz'}, {said}}}")
    assert main(["train", str(config)]) == 2
    error = capsys.readouterr().err
    assert named in error
    assert error.count("\n") == 1
    assert not (tmp_path / "p.npz").exists()
