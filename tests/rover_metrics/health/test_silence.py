from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.health.silence import Silence, SilenceWatch

SECOND = 10**9
BEGUN, OVER = False, True


def changes_of_the_rule(looks: Sequence[tuple[int, int]], limit: int) -> list[Silence | None]:
    """The rule by its words, over all looks so far: count and time in seconds."""
    told: list[Silence | None] = []
    quiet, silent, previous = 0, False, (0, looks[0][1])
    for count, now in looks:
        quiet += sorted((0, now - previous[1], 2))[1]  # a leap is no silence
        change = None
        if count != previous[0]:
            change = Silence(OVER, quiet) if silent else None
            quiet, silent = 0, False
        elif limit and quiet >= limit and not silent:
            change, silent = Silence(BEGUN, quiet), True
        told.append(change)
        previous = count, now
    return told


@given(
    st.lists(st.tuples(st.integers(0, 2), st.integers(-1, 3)), min_size=1, max_size=60),
    st.integers(0, 6),
)
def test_begin_and_end_of_a_silence_are_those_of_the_rule(
    steps: list[tuple[int, int]], limit: int
) -> None:
    looks, now = [], 0
    for count, passed in steps:
        now += passed
        looks.append((count // 2, now))  # mostly the same count
    watch, silent = SilenceWatch(), False
    for (count, at), expected in zip(looks, changes_of_the_rule(looks, limit), strict=True):
        assert watch.look(count, at * SECOND, limit * SECOND) == expected
        silent = silent if expected is None else not expected.is_over
        assert watch.is_silent is silent


@pytest.mark.parametrize(
    ("looks", "expected"),
    [
        ([(3, s) for s in range(6)], []),  # heard at 0, quiet for 4.999 s at most
        ([(0, s) for s in range(9)], [Silence(BEGUN, 5.0)]),  # never heard
        (
            [(3, s) for s in range(100)] + [(4, 100), (5, 101)],
            [Silence(BEGUN, 5.0), Silence(OVER, 100.0)],
        ),
        ([(s, s) for s in range(99)], []),
        ([(9, 0), (9, 3), (1, 4), (2, 8)], []),  # a count that starts again
        ([(1, 10), (1, 3610), (2, 3611)], []),  # a clock that jumps an hour
        ([(1, 3600), (1, 0), (1, 1), (1, 2), (1, 3), (1, 4)], []),  # one that is reset
    ],
)
def test_a_silence_of_five_seconds_is_told_once_and_so_is_its_end(
    looks: list[tuple[int, float]], expected: list[Silence]
) -> None:
    watch = SilenceWatch()
    limit = 5 * SECOND + (looks[-1] == (3, 5))
    changes = [watch.look(count, round(now * SECOND), limit) for count, now in looks]
    assert [change for change in changes if change is not None] == expected
