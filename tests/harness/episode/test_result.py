import pytest

from harness.config import EpisodeConfig
from harness.episode.result import Progress, RunResult, TopicCount
from harness.truth.traversal import Truth


def test_speeds_and_counts_of_a_run_follow_from_what_it_holds() -> None:
    result = RunResult(
        config=EpisodeConfig(),
        mode="direct",
        truth=Truth(time_ns=4_000_000_000, path_length=1.0),
        wall_s=0.5,
        paused_s=10.0,
        topics={"/a": TopicCount(10, 8, 2), "/b": TopicCount(30, None, 1)},
    )
    assert result.simulated_s == 4.0
    assert result.real_time_factor == pytest.approx(8.0)
    assert result.mean_speed == pytest.approx(0.25)
    assert (result.messages, result.lost) == (40, 3)


def test_a_run_that_never_began_has_no_speeds() -> None:
    result = RunResult(config=EpisodeConfig(), mode="direct")
    assert (result.real_time_factor, result.mean_speed, result.messages, result.lost) == (0, 0, 0, 0)
    assert Progress(1.0, 2.0, 0.0, 0.0, 0).real_time_factor == 0.0
    assert Progress(3.0, 4.0, 2.0, 0.0, 0).real_time_factor == pytest.approx(1.5)
