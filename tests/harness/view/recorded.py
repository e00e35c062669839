"""A short recording of an episode."""

from contextlib import closing
from pathlib import Path

from harness.episode.episode import Episode
from harness.spec.run import Run
from harness.view.states import States, StateWriter, read_states

CONFIG = Run.of(terrain="rocky", driver="straight", duration=2.0)


def recorded(path: Path, config: Run = CONFIG) -> States:
    with closing(StateWriter(path, config)) as writer:
        for batch in Episode(config).batches():
            writer.take(batch)
    return read_states(path)
