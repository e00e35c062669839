"""Whole episodes of every environment, compared with those that somebody has kept."""

import hashlib
from typing import Any

import gymnasium
import numpy as np
import pytest

from harness.gym import ENVIRONMENTS
from harness.gym.custom import StepTruth
from tests.golden import kept
from tests.support.snapshots import check_snapshot

EPISODES, STEPS = 3, 30
CASE: dict[str, Any] = {
    "terrain": ("posts", "flat"),
    "targets": ["post:x=0.5,y=0.1"],
    "soil": ("", "dry_sand"),
    "noise": "white",
    "difficulty": (0.2, 0.9),
    "random_start": False,
    "goal_distance": (0.3, 0.7),
    "time_limit": 1.4,
    "episodes_per_world": 2,
    "curriculum": {"step": 0.2, "window": 1, "success": 0.5},
    "randomisation": {"friction": (0.5, 1.5), "payload": (0, 5), "latency": (0, 0.2)},
}


def driven(identifier: str) -> str:
    """A line on episodes of actions that are drawn, most of them ahead."""
    digest, told, rng = hashlib.sha256(), list[str](), np.random.default_rng(4)

    def watched(truth: StepTruth) -> bool:
        digest.update(repr(truth).encode())
        return False

    env = gymnasium.make(identifier, **CASE, terminate_fn=watched)
    for episode in range(EPISODES):
        seen, about = env.reset(seed=None if episode else 3)
        rewards = list[float]()
        for _ in range(STEPS):
            digest.update(b"".join(seen[name].tobytes() for name in sorted(seen)))
            seen, reward, *ends, info = env.step(np.array([rng.uniform(0.2, 1.0), rng.normal(0.0, 0.3)]))
            digest.update(repr((reward, ends, info)).encode())
            rewards.append(float(reward))
            if any(ends):
                break
        told.append(f"{len(rewards)} steps, {sum(rewards):.6f}, {info['ending'] or 'goes on'}, {about}")
    env.close()
    return "\n".join([identifier, *told, digest.hexdigest()[:16]])


def test_episodes_are_those_that_were_kept() -> None:
    if kept.references()[kept.ARITHMETIC] != kept.arithmetic():
        pytest.skip("another arithmetic than that of who kept them")
    lines = map(driven, ENVIRONMENTS)
    check_snapshot("episodes.txt", "\n".join(lines) + "\n")
