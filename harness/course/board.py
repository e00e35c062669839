"""The leader board: a page of a folder of receipts, which needs no network."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from harness.base.errors import UsageError
from harness.course.receipt import Receipt, interval, read_receipt
from harness.course.result import EpisodeResult
from harness.course.summary import difference
from harness.course.tracks import TRACKS
from harness.page.figure import METRIC, Plot
from harness.page.shell import fill
from harness.page.strips import beside, dots, means, strips
from rover_metrics.sheet.sheet import NONE, Sheet

ROOM = (-0.03, 1.03)  # what a plot of scores shows


def read_folder(folder: Path) -> list[Receipt]:
    """Returns the receipts of a folder: those of most tracks first, and of these the best score.

    Raises:
        UsageError: There are none, or one cannot be read.
    """
    files = sorted(folder.glob("*.json")) if folder.is_dir() else []
    if not files:
        raise UsageError(f"{folder} holds no receipt (*.json); `run ENTRY --out {folder}` writes one")
    return sorted(map(read_receipt, files), key=lambda one: (-len(one.tracks), -one.score, one.entry))


def page_of(receipts: Sequence[Receipt]) -> str:
    """Returns the HTML of the board, the same bytes for the same receipts."""
    plots = [_plot(number, track, receipts) for number, track in enumerate(_tracks(receipts))]
    content = {
        "board": board_of(receipts),
        "paired": paired_of(receipts),
        "plots": plots,
        "height": f"{5.0 + 2.6 * len(receipts):.1f}rem",
    }
    return fill("board", content, "harness.course", plots)


def board_of(receipts: Sequence[Receipt]) -> Sheet:
    """Returns a row per entry: its score, and that of each track."""
    rows = (
        {
            "entry": receipt.entry,
            "score": f"{receipt.score:.3f}",
            **{track: _score(receipt, track) for track in _tracks(receipts)},
            "seeds": _seeds(receipt),
            "version": receipt.version,
            "entry's hash": receipt.entry_hash[:12],
        }
        for receipt in receipts
    )
    spare = frozenset((*_tracks(receipts), "version", "entry's hash"))
    return Sheet.of(rows, "Leader board", spare=spare)


def paired_of(receipts: Sequence[Receipt]) -> Sheet:
    """Returns by how much each entry scores less than the best one of each track, seed by seed."""
    rows: list[dict[str, str]] = []
    for track in _tracks(receipts):
        known = [one for one in receipts if track in one.tracks]
        best = max(known, key=lambda one: one.tracks[track].score.mean)
        for other in known:
            gap = difference(other.tracks[track].episodes, best.tracks[track].episodes)
            if other is not best and gap is not None:
                pair = {"track": track, "best": best.entry, "entry": other.entry}
                rows.append(pair | {"behind": f"{gap.mean:.3f}", "95 %": interval(gap)})
    return Sheet.of(rows, "Differences, paired by seed")


def _tracks(receipts: Sequence[Receipt]) -> list[str]:
    return [name for name in TRACKS if any(name in receipt.tracks for receipt in receipts)]


def _seeds(receipt: Receipt) -> str:
    count = max(len(track.episodes) for track in receipt.tracks.values())
    if receipt.own_worlds:
        return f"{count} own worlds"
    return f"{count} of nonce {receipt.nonce}" if receipt.nonce else f"{count} public"


def _score(receipt: Receipt, track: str) -> str:
    return f"{receipt.tracks[track].score.mean:.3f}" if track in receipt.tracks else NONE


def _plot(number: int, track: str, receipts: Sequence[Receipt]) -> Plot:
    known = [(one.entry, one.tracks[track]) for one in receipts if track in one.tracks]
    scores, names = [summary.score for _, summary in known], [name for name, _ in known]
    episodes = [
        (one.score, beside(row, place, len(summary.episodes)), _about(one))
        for row, (_, summary) in enumerate(known)
        for place, one in enumerate(summary.episodes)
    ]
    intervals = [None if one.low is None or one.high is None else (one.low, one.high) for one in scores]
    traces = [
        dots("episode", episodes, "%{customdata}, %{x}", METRIC),
        means("mean with its 95 % interval", [one.mean for one in scores], intervals),
    ]
    shown = "; ".join(f"{name}: {summary.score.mean:.3f}" for name, summary in known)
    summary = f"Scores on track {track}, mean of each entry: {shown}"
    figure = strips(traces, names, "score", ROOM)
    return Plot(f"track-{number}", summary, figure, track, TRACKS[track].summary)


def _about(one: EpisodeResult) -> str:
    return f"seed {one.seed}: {escape(one.ending[:60])}"
