"""The leader board: a page of a folder of receipts, which needs no network."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.version import __version__
from harness.course.receipt import Receipt, interval, read_receipt
from harness.course.summary import TrackSummary, difference
from harness.course.tracks import TRACKS
from harness.page.figure import (
    INK,
    METRIC,
    PANEL,
    Layout,
    Plot,
    Trace,
    common_layout,
    named,
    numbers,
    titled,
)
from harness.page.shell import fill
from rover_metrics.sheet.sheet import NONE, Sheet

SPREAD = 0.3  # of a row's height: how far its dots lie apart
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
        "version": __version__,
        "board": board_of(receipts),
        "paired": paired_of(receipts),
        "plots": plots,
        "height": f"{5.0 + 2.6 * len(receipts):.1f}rem",
        "figures": named(plots),
    }
    return fill("board", content, package="harness.course")


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
    means = "; ".join(f"{name}: {summary.score.mean:.3f}" for name, summary in known)
    rows = {"tickvals": [*range(len(known))], "ticktext": [escape(name) for name, _ in known]}
    layout = common_layout(
        margin={"l": 10, "r": 14, "t": 24, "b": 44},
        xaxis=titled("score", range=list(ROOM)),
        yaxis=titled("", range=[len(known) - 0.5, -0.5], **rows),
    )
    summaries = [summary for _, summary in known]
    figure = {"data": [_episodes(summaries), _means(summaries)], "layout": layout}
    summary = f"Scores on track {track}, mean of each entry: {means}"
    return Plot(f"track-{number}", summary, figure, track, TRACKS[track].summary)


def _episodes(known: Sequence[TrackSummary]) -> Trace:
    """A dot per episode, those of an entry over its row's height."""
    dots = [
        (one, row + SPREAD * (2 * (place + 0.5) / len(summary.episodes) - 1))
        for row, summary in enumerate(known)
        for place, one in enumerate(summary.episodes)
    ]
    return {
        **_markers("episode", PANEL, {"symbol": "circle", "size": 6, "line": METRIC}),
        "x": numbers([one.score for one, _ in dots]),
        "y": numbers([y for _, y in dots]),
        "customdata": [f"seed {one.seed}: {escape(one.ending[:60])}" for one, _ in dots],
        "hovertemplate": "%{customdata}, %{x}<extra></extra>",
    }


def _means(known: Sequence[TrackSummary]) -> Trace:
    """The mean of each entry with its interval."""
    scores = [summary.score for summary in known]
    # Both ways: an interval that meets 0 or 1 is cut there.
    below = numbers([0.0 if one.low is None else one.mean - one.low for one in scores])
    above = numbers([0.0 if one.high is None else one.high - one.mean for one in scores])
    whiskers = {"type": "data", "symmetric": False, "array": above, "arrayminus": below}
    return {
        **_markers(
            "mean with its 95 % interval", INK, {"symbol": "diamond-open", "size": 11, "line": INK}
        ),
        "x": numbers([one.mean for one in scores]),
        "y": [*range(len(scores))],
        "error_x": whiskers | {"color": INK, "thickness": 1.5, "width": 4},
        "hovertemplate": "%{x}<extra></extra>",
    }


def _markers(name: str, color: str, style: Layout) -> Trace:
    marker = style | {"color": color, "line": {"color": style["line"], "width": 1.5}}
    return {"type": "scatter", "mode": "markers", "name": name, "marker": marker}
