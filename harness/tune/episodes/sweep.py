"""Drives what is left of a plan on a backend's workers; whatever happens, no episode counts twice."""

from collections.abc import Callable, Sequence
from operator import attrgetter

from harness.base.errors import Diverged, RunFailed
from harness.episode.assembly import world_of
from harness.episode.episode import Episode
from harness.robots import find_rover
from harness.spec.run import Run
from harness.tune.backend import Backend
from harness.tune.backend.work_off import work_off
from harness.tune.episodes.contacts import event_rows
from harness.tune.episodes.plan import Planned
from harness.tune.episodes.recompute import Collected, scan_rows, window_rows
from harness.tune.episodes.record import Ending, EpisodeRecord
from harness.tune.episodes.store import Store, encode

KEPT = "the episodes so far are kept, and the same command goes on with them"


def drive(run: Run) -> EpisodeRecord:
    """Drives an episode to its end, or until the rover lies on its side.

    The same run gives the same record, to the bit, on one machine.
    """
    episode, collected = Episode(run), Collected()
    ending = _drive(episode, collected)
    rover = find_rover(run.rover.robot)
    scans, placed = scan_rows(collected, rover), collected.placed_scans()
    return EpisodeRecord(
        scans=scans,
        windows=window_rows(collected),
        events=event_rows(collected.events, placed, scans["speed"], world_of(run), rover),
        ending=ending,
        path_length=collected.path_length,
        driver=run.rover.driver,
        terrain=run.world.terrain,
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


def drive_to_bytes(planned: Planned) -> tuple[Planned, bytes]:
    """Returns an episode and its record as bytes: a worker shares no file system with the sweep."""
    return planned, encode(drive(planned.run))


def sweep(
    planned: Sequence[Planned], store: Store, backend: Backend, show: Callable[[int], None]
) -> dict[Planned, EpisodeRecord]:
    """Drives every episode that the store does not hold yet, and returns all records.

    Args:
        planned: The episodes.
        store: Where each goes as soon as it is done.
        backend: Who drives.
        show: Told how many are done.

    Raises:
        RunFailed: Workers died again and again, or an episode cannot be written.
    """
    left = {episode: episode for episode in planned if store.read(episode) is None}
    done = len(planned) - len(left)
    show(done)

    def keep(episode: Planned, content: bytes) -> None:
        nonlocal done
        _write(store, episode, content)
        done += 1
        show(done)

    work_off(left, drive_to_bytes, backend, keep, name=attrgetter("name"), mend=KEPT)
    return {episode: record for episode in planned if (record := store.read(episode)) is not None}


def _write(store: Store, episode: Planned, content: bytes) -> None:
    try:
        store.write(episode, content)
    except OSError as error:
        message = f"cannot write episode {episode.name} to {store.folder}: {error.strerror}; {KEPT}"
        raise RunFailed(message) from error
