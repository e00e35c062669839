"""The receipt of a run of the Course: what was judged, on what, and every figure that came of it."""

import math
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from harness.base.documents import read_json
from harness.base.errors import UsageError
from harness.base.files import write_whole
from harness.base.version import __version__, packages
from harness.course.entry import Entry
from harness.course.result import EpisodeResult
from harness.course.summary import DECIMALS, Mean, TrackSummary, summarise
from harness.spec.value import Value, made
from rover_metrics.sheet.sheet import NONE, Sheet, formatted

LARGEST = 64 * 2**20  # bytes


class Machine(Value):
    """Where the episodes were driven; a figure must not depend on it."""

    system: str = Field(default_factory=platform.system)
    processor: str = Field(default_factory=platform.machine)
    python: str = Field(default_factory=platform.python_version)
    packages: dict[str, str] = Field(default_factory=packages)


class Receipt(Value):
    """What a run of the Course came to.

    Attributes:
        format: Of this file.
        version: Of this project.
        entry: Name of what was judged.
        entry_hash: SHA-256 of its files, or of a baseline's name.
        nonce: From which the seeds were made; "" for the public ones.
        own_worlds: Whether worlds of the user's own were driven.
        score: Mean of the tracks' scores.
        tracks: By name.
    """

    format: Literal[1] = 1
    version: str = __version__
    entry: Annotated[str, Field(min_length=1, max_length=60)]
    entry_hash: str
    nonce: str = ""
    own_worlds: bool = False
    machine: Machine = Field(default_factory=Machine)
    score: float
    tracks: Annotated[dict[str, TrackSummary], Field(min_length=1)]


def receipt_of(
    entry: Entry,
    episodes: Mapping[str, Sequence[EpisodeResult]],
    nonce: str = "",
    *,
    own_worlds: bool = False,
) -> Receipt:
    """Returns the receipt of an entry.

    Args:
        entry: What drove.
        episodes: Results by track.
        nonce: From which the seeds were made; "" for the public ones.
        own_worlds: Whether worlds of the user's own were driven.
    """
    tracks = {name: summarise(some) for name, some in episodes.items()}
    return Receipt(
        entry=entry.name,
        entry_hash=entry.digest,
        nonce=nonce,
        own_worlds=own_worlds,
        score=score_of(tracks),
        tracks=tracks,
    )


def score_of(tracks: Mapping[str, TrackSummary]) -> float:
    """Returns the mean of the tracks' scores."""
    return round(math.fsum(track.score.mean for track in tracks.values()) / len(tracks), DECIMALS)


def write_receipt(receipt: Receipt, path: Path) -> None:
    """Writes a receipt, whole or not at all."""
    write_whole(path, receipt.model_dump_json(indent=1) + "\n", "the receipt", UsageError)


def read_receipt(path: Path) -> Receipt:
    """Returns the receipt of a file; UsageError if it is none, or its sums are not its parts'."""
    content = read_json(path, LARGEST)
    if not isinstance(content, dict):
        raise UsageError(f"{path} is no receipt of harness.course")
    receipt = made(Receipt, content, str(path))
    for name, track in receipt.tracks.items():
        if track != summarise(track.episodes):
            raise UsageError(f"{path}: the figures of track {name} are not those of its episodes")
    if receipt.score != score_of(receipt.tracks):
        raise UsageError(f"{path}: its score is not the mean of its tracks")
    return receipt


def sheet_of(receipt: Receipt) -> Sheet:
    """Returns a row per track: its score with its interval, and what stands beside it."""
    rows = (
        {
            "track": name,
            "score": f"{track.score.mean:.3f}",
            "95 %": interval(track.score),
            "success": f"{track.success.mean:.0%}",
            "SPL": f"{track.spl.mean:.3f}",
            "time": formatted(track.seconds, ".1f"),
            "risk": formatted(track.risk_s_per_goal, ".2f"),
            "tilt": f"{math.degrees(track.tilt_p95):.1f}",
            "runs": str(len(track.episodes)),
        }
        for name, track in receipt.tracks.items()
    )
    about = (
        "time: of successes [s]; risk: near hazards for each goal [s]; tilt: its 95th percentile [deg]"
    )
    return Sheet.of(rows, receipt.entry, caption=about)


def interval(value: Mean) -> str:
    """Returns the 95 % interval of a mean; a dash without one."""
    if value.low is None or value.high is None:
        return NONE
    return f"{value.low:.3f} to {value.high:.3f}"
