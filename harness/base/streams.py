"""The random streams of a run: each purpose draws from a generator of its own, spawned from a seed.

What is switched off therefore changes nothing else. A stream of a seed is its key and the words behind
that, e.g. a fault's place or a sensor's name.
"""

import numpy as np

EPISODE = 10  # spawns three: the driver's, the scans' noise, the IMU's noise
GOALS = 11  # without further words: the goals of a rover's area
FAULTS = 11  # with a fault's place in the run
OPTIONAL_SENSORS = 12  # with a sensor's name
FLEET = 13  # with a rover's place in the run: the seed of that rover
COURSE = 14  # with the name of a track: its goals
VIBRATION = 15  # the shaking of an IMU by a surface
PEOPLE = 20  # with a person's name; of the world's seed
TARGETS = 21  # with a target's name; of the world's seed
DETAIL = 22  # of a heightmap, below its cells; of the world's seed
# In the entropy beside the seed instead of in the spawn key:
VALIDATION_GROUND = 20
VALIDATION_AGENT = 30


def seeded(seed: int, *key: int | str) -> np.random.SeedSequence:
    """Returns the source of a stream of a run, a rover or a world: a constant from above, and words."""
    words = (word.encode() if isinstance(word, str) else (word,) for word in key)
    return np.random.SeedSequence(seed, spawn_key=tuple(n for word in words for n in word))


def generator(seed: int, *key: int | str) -> np.random.Generator:
    """Returns the generator of a stream, whose key is that of `seeded`."""
    return np.random.default_rng(seeded(seed, *key))
