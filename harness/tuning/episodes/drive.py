"""Drives one planned episode and keeps its extrema."""

from harness.config import EpisodeConfig
from harness.episode.episode import Episode
from harness.errors import Diverged, RunFailed
from harness.robots import find_rover
from harness.tuning.episodes.contacts import event_rows
from harness.tuning.episodes.recompute import Collected, scan_rows, window_rows
from harness.tuning.episodes.record import Ending, EpisodeRecord


def drive(config: EpisodeConfig) -> EpisodeRecord:
    """Drives an episode to its end, or until the rover lies on its side.

    The same configuration gives the same record, to the bit, on one machine.
    """
    episode, collected = Episode(config), Collected()
    ending = _drive(episode, collected)
    rover = find_rover(config.robot)
    scans = scan_rows(collected, rover)
    return EpisodeRecord(
        scans=scans,
        windows=window_rows(collected),
        events=event_rows(
            collected.events, collected.placed_scans(), scans["speed"], config.world(), rover
        ),
        ending=ending,
        path_length=collected.path_length,
        driver=config.driver,
        terrain=config.terrain,
    )


def _drive(episode: Episode, collected: Collected) -> Ending:
    try:
        for batch in episode.batches():
            collected.take(batch)
            if batch.truth.tipped_over:
                return Ending.TIPPED_OVER
    except Diverged:
        return Ending.DIVERGED
    except RunFailed:
        return Ending.LEFT_THE_MAP
    return Ending.COMPLETE
