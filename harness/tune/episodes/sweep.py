"""Drives what is left of a plan on workers; whatever happens, no episode counts twice."""

from collections.abc import Callable, Sequence
from operator import attrgetter

from harness.base.errors import Diverged, PluginFailed, RunFailed
from harness.base.workers import Workers, work_off
from harness.episode import loop
from harness.episode.assembly import injector, world_of
from harness.episode.episode import Episode
from harness.episode.loop import Route
from harness.episode.together import Together
from harness.robots import find_rover
from harness.spec.run import Run
from harness.tune.episodes.plan import Planned
from harness.tune.episodes.recompute import Collected, event_rows
from harness.tune.episodes.record import Ending, EpisodeRecord
from harness.tune.episodes.store import Store, encode
from rover_metrics.errors import counted

KEPT = "the episodes so far are kept, and the same command goes on with them"


def drive(run: Run) -> EpisodeRecord:
    """Drives an episode to its end, or until the rover lies on its side.

    The same run gives the same record, to the bit, on one machine.
    """
    rover = find_rover(run.rover.robot)
    collected = Collected(rover)
    ending = _ending(run, collected)
    scans, placed = collected.scan_rows(), collected.placed_scans()
    return EpisodeRecord(
        scans=scans,
        windows=collected.window_rows(),
        events=event_rows(collected.events, placed, scans["speed"], world_of(run), rover),
        ending=ending,
        path_length=collected.path_length,
        driver=run.rover.driver,
        terrain=run.world.terrain,
    )


def _ending(run: Run, collected: Collected) -> Ending:
    """Drives, with nobody but `collected` to look."""
    route = Route(injector(run), lambda *_: None, (collected,))
    try:
        for _ in loop.drive(Together([Episode(run)]).batches(), [route]):
            if collected.tipped_over:
                return Ending.TIPPED_OVER
    except Diverged:
        return Ending.DIVERGED
    except PluginFailed:
        raise
    except RunFailed:
        return Ending.LEFT_THE_MAP
    return Ending.TIPPED_OVER if collected.tipped_over else Ending.COMPLETE


def drive_to_bytes(planned: Planned) -> bytes:
    """Returns an episode's record as bytes: a worker shares no file system with the sweep."""
    return encode(drive(planned.run))


def sweep(
    planned: Sequence[Planned], store: Store, workers: Workers, show: Callable[[int], None]
) -> dict[Planned, EpisodeRecord]:
    """Drives every episode that the store does not hold yet, and returns all records.

    Args:
        planned: The episodes.
        store: Gets each as soon as it is done.
        workers: Where they are driven.
        show: Called with how many are done.

    Raises:
        RunFailed: Workers died again and again, or an episode cannot be written or read again.
    """
    left = {episode: episode for episode in planned if store.read(episode) is None}
    done = len(planned) - len(left)
    show(done)

    def keep(episode: Planned, content: bytes) -> None:
        nonlocal done
        try:
            store.write(episode, content)
        except OSError as error:
            message = f"cannot write episode {episode.name} to {store.folder}: {error.strerror}; {KEPT}"
            raise RunFailed(message) from error
        done += 1
        show(done)

    work_off(left, drive_to_bytes, workers, keep, name=attrgetter("name"), mend=KEPT)
    records = {episode: record for episode in planned if (record := store.read(episode)) is not None}
    if lost := set(planned) - set(records):
        some = counted(len(lost), "episode")
        raise RunFailed(
            f"{some} in {store.folder} cannot be read again after writing; try another --out"
        )
    return records
