"""The leader board: a page of a folder of receipts, which needs no network."""

from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.version import __version__
from harness.course.receipt import Receipt, read_receipt
from harness.course.sheets import interval
from harness.course.summary import difference
from harness.course.tracks import TRACKS
from harness.page.figure import (
    INK,
    METRIC,
    PANEL,
    Figure,
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
    """Returns the receipts of a folder, the best score first.

    Raises:
        UsageError: There are none, or one cannot be read.
    """
    files = sorted(folder.glob("*.json")) if folder.is_dir() else []
    if not files:
        raise UsageError(f"{folder} holds no receipt (*.json); `run ENTRY --out {folder}` writes one")
    return sorted(map(read_receipt, files), key=lambda receipt: (-receipt.score, receipt.entry))


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
    """Returns a row an entry: its score, and that of each track."""
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
    return Sheet.of(rows, "Leader board")


def paired_of(receipts: Sequence[Receipt]) -> Sheet:
    """Returns by how much each entry scores less than the best one of each track, seed by seed."""
    rows: list[dict[str, str]] = []
    for track in _tracks(receipts):
        known = [one for one in receipts if track in one.tracks]
        best = max(known, key=lambda one: one.tracks[track].score.mean)
        for other in known:
            gap = difference(other.tracks[track].episodes, best.tracks[track].episodes)
            if other is not best and gap is not None:
                told = {"track": track, "best": best.entry, "entry": other.entry}
                rows.append(told | {"behind": f"{gap.mean:.3f}", "95 %": interval(gap)})
    return Sheet.of(rows, "Differences, paired by seed")


def _tracks(receipts: Sequence[Receipt]) -> list[str]:
    return [name for name in TRACKS if any(name in receipt.tracks for receipt in receipts)]


def _seeds(receipt: Receipt) -> str:
    if receipt.own_worlds:
        return "own worlds"
    return f"nonce {receipt.nonce}" if receipt.nonce else "public"


def _score(receipt: Receipt, track: str) -> str:
    return f"{receipt.tracks[track].score.mean:.3f}" if track in receipt.tracks else NONE


def _plot(number: int, track: str, receipts: Sequence[Receipt]) -> Plot:
    known = [receipt for receipt in receipts if track in receipt.tracks]
    means = "; ".join(f"{one.entry}: {one.tracks[track].score.mean:.3f}" for one in known)
    summary = f"Scores on track {track}, mean of each entry: {means}"
    return Plot(f"track-{number}", summary, _figure(track, known), track, TRACKS[track].summary)


def _figure(track: str, known: Sequence[Receipt]) -> Figure:
    layout = common_layout(
        margin={"l": 10, "r": 14, "t": 24, "b": 44},
        xaxis=titled("score", range=list(ROOM)),
        yaxis=titled(
            "",
            range=[len(known) - 0.5, -0.5],
            tickvals=list(range(len(known))),
            ticktext=[escape(receipt.entry) for receipt in known],
        ),
    )
    return {"data": list(_traces(track, known)), "layout": layout}


def _traces(track: str, known: Sequence[Receipt]) -> Iterator[Trace]:
    """Each episode a dot, the mean of each entry with its interval."""
    summaries = [receipt.tracks[track] for receipt in known]
    points = [
        (one.score, index + SPREAD * (2 * (place + 0.5) / len(summary.episodes) - 1), one)
        for index, summary in enumerate(summaries)
        for place, one in enumerate(summary.episodes)
    ]
    yield {
        **_markers("episode", METRIC, "circle", 6),
        "x": numbers([x for x, _, _ in points]),
        "y": numbers([y for _, y, _ in points]),
        "customdata": [f"seed {one.seed}: {escape(one.ending[:60])}" for _, _, one in points],
        "hovertemplate": "%{customdata}, %{x}<extra></extra>",
    }
    ends = [(s.score.mean if s.score.low is None else s.score.low, s.score.mean) for s in summaries]
    yield {
        **_markers("mean with its 95 % interval", INK, "diamond-open", 11),
        "x": numbers([mean for _, mean in ends]),
        "y": list(range(len(known))),
        "error_x": {
            "type": "data",
            "array": numbers([mean - low for low, mean in ends]),
            "color": INK,
            "thickness": 1.5,
            "width": 4,
        },
        "hovertemplate": "%{x}<extra></extra>",
    }


def _markers(name: str, color: str, symbol: str, size: int) -> Trace:
    fill_color = PANEL if symbol == "circle" else color  # open symbols have no other colour
    line = {"color": color, "width": 1.5}
    marker = {"symbol": symbol, "size": size, "color": fill_color, "line": line}
    return {"type": "scatter", "mode": "markers", "name": name, "marker": marker}
