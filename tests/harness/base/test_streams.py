"""No two purposes of a run draw the same numbers, and what a seed means stays."""

from itertools import combinations

import numpy as np

from harness.base import streams
from harness.base.streams import generator, seeded

# Every key that a run draws from, with the words behind it; validation's are entropy beside the seed.
KEYS: tuple[tuple[int | str, ...], ...] = (
    (streams.EPISODE,),
    (streams.GOALS,),
    *((streams.FAULTS, place) for place in range(20)),
    *((streams.OPTIONAL_SENSORS, name) for name in ("gnss", "a", "ab")),
    *((streams.FLEET, number) for number in range(1, 16)),
    *((streams.PEOPLE, name) for name in ("a", "ab")),
)


def test_no_two_streams_of_a_seed_are_equal() -> None:
    drawn = [generator(5, *key).random() for key in KEYS]
    drawn += [
        child.random() for child in map(np.random.default_rng, seeded(5, streams.EPISODE).spawn(3))
    ]
    drawn += [
        np.random.default_rng([5, key]).random()
        for key in (streams.VALIDATION_GROUND, streams.VALIDATION_AGENT)
    ]
    drawn.append(np.random.default_rng(5).random())
    assert all(one != other for one, other in combinations(drawn, 2))


def test_a_stream_is_numpys_of_the_seed_its_key_and_the_words_behind_it() -> None:
    """Part of what a seed means: another number here is another run."""
    names = ("EPISODE", "GOALS", "FAULTS", "OPTIONAL_SENSORS", "FLEET", "PEOPLE")
    assert [getattr(streams, name) for name in names] == [10, 11, 11, 12, 13, 20]
    expected = np.random.default_rng(np.random.SeedSequence(5, spawn_key=(12, *b"top"))).random()
    assert generator(5, streams.OPTIONAL_SENSORS, "top").random() == expected
