"""rover-policy: evaluates in unseen worlds, trains where torch is there, tells mistakes in a line."""

import math
from pathlib import Path
from typing import Any

import pytest

from harness.drivers.policy import Policy, read_policy
from harness.gym.evaluation import UNSEEN, Outcome, drive, row
from harness.gym.policy import main

POLICY = Path(__file__).parents[3] / "examples/point_nav.npz"


def test_endings_are_counted_with_wilsons_interval() -> None:
    ends = [("reached", 9.0)] * 5 + [("reached", 11.0)] * 3 + [("time", 60.0), ("flipped", 30.0)]
    told = row("learned", "rocky", ends)
    good, count, z = 8, 10, 1.959964
    middle = (good + z * z / 2) / (count + z * z)
    half = z * math.sqrt(good * (count - good) / count + z * z / 4) / (count + z * z)
    interval = f"{middle - half:.0%} to {middle + half:.0%}"
    assert told == ("learned", "rocky", "8 of 10", interval, "flipped 1, time 1", "9.0 s")


def test_an_evaluation_of_unseen_worlds_is_a_table_and_a_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, page = list[tuple[object, ...]](), tmp_path / "policy.html"

    def told(policy: Policy, options: dict[str, Any], seed: int) -> Outcome:
        asked.append((seed, options["robot"], options["terrain"], options["lidar_beams"]))
        return drive(policy, options, seed) if seed == UNSEEN else ("reached", 1.0)

    monkeypatch.setattr("harness.gym.evaluation.drive", told)
    words = [str(POLICY), "--worlds", "2", "--terrain", "gravel", "--robot", "rover_zero4wd"]
    assert main(["evaluate", *words, "--page", str(page)]) == 0
    of_both = (("rover_zero4wd", "gravel", read_policy(POLICY).beams),) * 2
    assert sorted(asked) == [(UNSEEN + n, *about) for n in range(2) for about in of_both]
    assert "straight" in capsys.readouterr().out
    assert "learned" in page.read_text()


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["evaluate", "none.npz"], "none.npz"),
        (["evaluate", str(POLICY), "--worlds", "0"], "--worlds 0"),
        (["evaluate", str(POLICY), "--terrain", "moon"], "moon"),
        (["evaluate", str(POLICY), "--terrain", "moon.sdf"], "No such file"),
        (["evaluate", str(POLICY), "--robot", "moon"], "moon"),
    ],
)
def test_a_mistake_is_one_line(words: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert named in line


def test_training_writes_a_policy_that_drives(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed (extra [train])")
    policy, config = tmp_path / "learnt.npz", tmp_path / "train.yaml"
    config.write_text(f"policy: {policy}\nterrains: flat\nsteps: 2048\nenvironments: 2\ntime_limit: 2\n")
    assert main(["train", str(config)]) == 0
    assert read_policy(policy).beams > 0
    config.write_text(f"policy: {policy}\nterrain: flat\n")
    assert main(["train", str(config)]) == 2
