"""What a run among people comes to, worked out by hand; windows against a count goal by goal."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rover_metrics.analysis.social.log import SocialLog
from rover_metrics.analysis.social.metrics import run_figures, times_to_collision, windows


def made(
    distance: Sequence[Sequence[float]], goals: Sequence[int], time_s: Sequence[float] | None = None
) -> SocialLog:
    apart = np.array(distance, dtype=float)
    times = np.arange(float(len(apart))) if time_s is None else np.array(time_s)
    names = tuple("abc"[: apart.shape[1]])
    nearest, counted = np.fmin.reduce(apart, axis=1), np.array(goals, dtype=np.int64)
    return SocialLog(Path("made"), names, times, np.zeros((len(apart), 2)), apart, nearest, counted)


def test_a_run_by_hand() -> None:
    nan = np.nan
    log = made(
        [[2.0, 9.0], [0.5, 1.0], [0.4, 1.3], [1.2, nan], [0.449, 1.1], [nan, nan], [3.6, 1.19]],
        [3, 3, 4, 4, 4, 6, 6],
    )
    figures = run_figures(log)
    assert (figures.seconds, figures.goals, figures.risk_s) == (7, 3, 2)
    assert figures.zone_s == {"intimate": 2, "personal": 2, "social": 2, "public": 0}
    assert run_figures(made([[3.6], [3.599], [0.45], [1.2]], [0] * 4)).zone_s == {
        "intimate": 0,
        "personal": 1,
        "social": 2,
        "public": 1,
    }
    assert figures.min_distance == 0.4
    # Each person twice: 1.2 m is outside, and who was inside before and after being lost has not left.
    assert figures.intrusions == 4
    assert run_figures(made([[0.5], [2.0], [1.0]], [0] * 3)).intrusions == 2  # one from the first on
    assert figures.risk_s_per_goal == pytest.approx(2 / 3)
    assert figures.s_per_goal == pytest.approx(7 / 3)
    assert figures.min_time_to_collision == pytest.approx(0.5 / 1.5)
    assert figures.closing_s == 2
    assert run_figures(log, 1.0).risk_s == 3
    none = run_figures(made([[nan], [nan]], [0, 0]))
    assert (none.risk_s_per_goal, none.s_per_goal, none.min_distance) == (None, None, None)
    assert (none.min_time_to_collision, sum(none.zone_s.values())) == (None, 0)


def test_time_to_collision_is_distance_over_closing_speed() -> None:
    log = made(
        [[6.0], [4.0], [4.0], [5.0], [4.5], [4.0], [9.5], [4.0]], [0] * 8, [0, 2, 3, 4, 4, 5, 6, 7]
    )
    inf = np.inf  # apart or as far as before, no time between, and nearer by more than 5 m in a second
    np.testing.assert_allclose(times_to_collision(log)[:, 0], [4.0, inf, inf, inf, 8.0, inf, inf])


ROWS = st.lists(st.tuples(st.integers(0, 2), st.sampled_from([0.2, 0.5, 2.0, np.nan])), min_size=1)


@settings(max_examples=30)
@given(st.lists(ROWS, max_size=3), st.integers(1, 3))
def test_a_window_ends_with_its_last_goal(runs: list[list[tuple[int, float]]], goals: int) -> None:
    logs = [made([[far] for _, far in run], np.cumsum([new for new, _ in run]).tolist()) for run in runs]
    expected, seconds, risk, reached = [], 0, 0, 0
    before: int | None = None
    for log in logs:
        for count, far in zip(log.goals.tolist(), log.nearest.tolist(), strict=True):
            seconds, risk = seconds + 1, risk + (far < 0.5)
            reached += before is not None and count > before
            before = count
            if reached == goals:
                expected.append((risk / goals, seconds / goals))
                seconds, risk, reached = 0, 0, 0
    assert windows(logs, goals).tolist() == [pytest.approx(pair) for pair in expected]
