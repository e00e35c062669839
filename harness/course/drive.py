"""All episodes of an entry, on one process or many, and again a tenth of those of a receipt."""

import hashlib
import random
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.version import __version__, packages
from harness.base.workers import Show, Workers, work_off
from harness.course.attempt import attempt
from harness.course.entry import Entry
from harness.course.receipt import Receipt
from harness.course.result import FIELDS, EpisodeResult
from harness.course.task import Case
from harness.course.tracks import Track, find_track

MEND = "run the same command again, with fewer --jobs"
SEED_BYTES = 6
SHARE = 10  # one episode in ten is driven again


def cases_of(
    tracks: Sequence[Track], entry: Entry, seeds: int, *, nonce: str = "", worlds: Path | None = None
) -> list[Case]:
    """Returns the episodes to be driven.

    Args:
        tracks: In this order.
        entry: On whose files unseen seeds depend.
        seeds: How many on each.
        nonce: For seeds that nobody could train on; "" for the public ones.
        worlds: Folder of the user's own worlds; None for those that ship.
    """
    if nonce and worlds is not None:
        raise UsageError("--nonce draws worlds, --worlds brings them; give one of them")
    if not nonce:
        return [case for track in tracks for case in track.cases(seeds, worlds)]
    return [
        track.unseen(unseen_seed(entry, nonce, track.name, n)) for track in tracks for n in range(seeds)
    ]


def unseen_seed(entry: Entry, nonce: str, track: str, number: int) -> int:
    """Returns the seed of an unseen episode, from SHA-256 over all arguments.

    Args:
        entry: Its hash goes in.
        nonce: What somebody else has chosen, so that nobody knows the seed before.
        track: The track's name.
        number: Of the episode in its track, from 0.
    """
    text = f"{entry.digest} {nonce} {track} {number}"
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:SEED_BYTES], "big")


def drive_all(
    cases: Sequence[Case], entry: Entry, workers: Workers, show: Show
) -> dict[str, list[EpisodeResult]]:
    """Returns the results of episodes by track, in their order.

    Args:
        cases: The episodes.
        entry: Who drives.
        workers: Where.
        show: Called with how many are done, and of how many.
    """
    done: dict[int, EpisodeResult] = {}

    def keep(number: int, result: EpisodeResult) -> None:
        done[number] = result
        show(len(done), len(cases))

    work = partial(attempt, entry=entry)
    items = dict(enumerate(cases))
    work_off(items, work, workers, keep, name=lambda number: cases[number].name, mend=MEND)
    by_track: dict[str, list[EpisodeResult]] = {}
    for number, case in items.items():
        by_track.setdefault(case.track, []).append(done[number])
    return by_track


def check_origin(receipt: Receipt, entry: Entry) -> None:
    """Makes sure that a receipt is of an entry and of this version; else UsageError."""
    if receipt.version != __version__:
        raise UsageError(
            f"the receipt is of rover-harness {receipt.version}, this is {__version__}; "
            f"pip install rover-harness=={receipt.version}"
        )
    theirs = receipt.machine.packages
    differ = [f"{n} {theirs.get(n)}" for n, own in packages().items() if theirs.get(n) != own]
    if differ:
        raise UsageError(f"the receipt was made with {', '.join(differ)}; install the same here")
    if receipt.entry_hash != entry.digest:
        raise UsageError(f"{entry.name} is not the entry of the receipt: its files have another hash")


def drawn(receipt: Receipt, seed: int, worlds: Path | None = None) -> list[Case]:
    """Returns a random tenth of a receipt's episodes, one of each track or more.

    Args:
        receipt: Of the episodes.
        seed: Of the draw.
        worlds: Folder of the user's own worlds; None for those that ship.

    Raises:
        UsageError: A world is not among those that are given.
    """
    rng = random.Random(seed)  # noqa: S311 - the user chooses the seed
    cases: list[Case] = []
    for name, track in receipt.tracks.items():
        count = -(-len(track.episodes) // SHARE)
        numbers = sorted(rng.sample(range(len(track.episodes)), count))
        cases += _cases(receipt, name, [track.episodes[n] for n in numbers], worlds)
    return cases


def _cases(
    receipt: Receipt, name: str, episodes: Sequence[EpisodeResult], worlds: Path | None
) -> Iterable[Case]:
    track = find_track(name)
    if receipt.nonce:
        return [track.unseen(one.seed) for one in episodes]
    if receipt.own_worlds and worlds is None:
        raise UsageError("the receipt is of worlds from a folder; give it: --worlds FOLDER")
    known = {case.seed: case for case in track.cases(10_000, worlds if receipt.own_worlds else None)}
    if missing := [one.world for one in episodes if one.seed not in known]:
        raise UsageError(f"world {missing[0]} is not among those of --worlds")
    return [known[one.seed] for one in episodes]


def differences(receipt: Receipt, again: dict[str, list[EpisodeResult]]) -> list[str]:
    """Returns a line for each figure that was not the same again."""
    receipted = {(one.track, one.seed): one for t in receipt.tracks.values() for one in t.episodes}
    return [
        f"{one.track} {one.seed}: {field} was {getattr(before, field)}, now {getattr(one, field)}"
        for some in again.values()
        for one in some
        for before in (receipted[one.track, one.seed],)
        for field in FIELDS
        if getattr(before, field) != getattr(one, field)
    ]
