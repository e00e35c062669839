"""The leader board: ranks and differences of the receipts, and a page that Chromium draws offline."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from harness.base.errors import UsageError
from harness.course.__main__ import main
from harness.course.board import board_of, page_of, paired_of, read_folder
from harness.course.entry import find_entry
from harness.course.receipt import Receipt, read_receipt, receipt_of, sheet_of, write_receipt
from harness.course.result import FIELDS, EpisodeResult
from tests.support.browser import NEEDS_CHROMIUM, Visit
from tests.support.snapshots import check_snapshot

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="module")
def folder(kept: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Receipts of `straight`, and of one that is named like markup and scores 0.1 more everywhere."""
    made, content = tmp_path_factory.mktemp("board"), read_receipt(kept)
    write_receipt(content, made / "straight.json")
    better = {
        name: [one.__class__(**{**vars(one), "score": one.score + 0.1}) for one in track.episodes]
        for name, track in content.tracks.items()
    }
    receipt = receipt_of(find_entry("goal"), better)
    write_receipt(receipt.but(entry="<b>better</b>"), made / "better.json")
    return made


def test_the_best_stands_first_and_differences_are_paired(folder: Path) -> None:
    receipts = read_folder(folder)
    assert [row[0] for row in board_of(receipts).rows] == ["<b>better</b>", "straight"]
    assert [row[3] for row in paired_of(receipts).rows] == ["0.100", "0.100"]


def test_every_number_of_a_receipt_and_of_the_board_is_as_somebody_has_looked_at() -> None:
    names, receipts, told = ("goal", "gap", "mppi"), list[Receipt](), list[str]()
    for place, entry in enumerate(names):
        episodes = list[EpisodeResult]()
        for seed in range(3):
            texts = ("barn", seed, "", f"w{seed}", "m", "reached" if seed else "time", seed, 2)
            numbers = (0.01 * (7 * seed + number * (place + 3) % 13) for number in range(12))
            values: dict[str, Any] = dict(zip(FIELDS, (*texts, *numbers), strict=True))
            episodes.append(EpisodeResult(**values))
        tracks = {
            name: [
                replace(one, track=name, score=one.score + n * (1 + place * one.seed))
                for one in episodes
            ]
            for n, name in ((0.1, "barn"), (0.3, "rocky"))
        }
        more: dict[str, Any] = {"nonce": "n" * (place == 1), "own_worlds": place == 2}
        receipts.append(receipt_of(find_entry(entry), tracks, **more).but(version=f"V{place}"))
    for sheet in (*map(sheet_of, receipts), board_of(receipts), paired_of(receipts)):
        told += [" | ".join(row) for row in (sheet.titles, *sheet.rows)]
    figures = re.search(r'id="figures">(.*?)</script>', page_of(receipts))
    assert figures
    told += [json.dumps(part) for plot in json.loads(figures[1]).values() for part in plot["data"]]
    for one in receipts:
        told = [line.replace(one.entry_hash[:12], f"hash of {one.entry}") for line in told]
    check_snapshot("board.txt", "\n".join(told) + "\n")


def test_who_left_out_tracks_stands_below_whatever_its_score(folder: Path, tmp_path: Path) -> None:
    best, worst = read_folder(folder)
    some = {"barn": best.tracks["barn"].episodes}
    write_receipt(receipt_of(find_entry("gap"), some).but(entry="one track"), tmp_path / "one.json")
    write_receipt(worst, tmp_path / "all.json")
    assert [one.entry for one in read_folder(tmp_path)] == ["straight", "one track"]


def test_names_are_text_and_the_page_is_the_same_bytes(folder: Path) -> None:
    page = page_of(read_folder(folder))
    assert "<b>better</b>" not in page
    assert page == page_of(read_folder(folder))


def test_whiskers_end_where_the_interval_is_cut(folder: Path) -> None:
    first, second = read_folder(folder)[1].tracks["blind"].episodes
    spread = [replace(first, score=0.0), replace(second, score=0.6)]
    page = page_of([receipt_of(find_entry("gap"), {"blind": spread})])
    figures = re.search(r'id="figures">(.*?)</script>', page)
    assert figures
    (plot,) = json.loads(figures[1]).values()
    whiskers = plot["data"][1]["error_x"]
    assert (whiskers["arrayminus"], whiskers["array"]) == ([0.3], [0.7])


def test_folders_without_receipts_are_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no receipt"):
        read_folder(tmp_path)
    (tmp_path / "other.json").write_text(json.dumps({"format": 2}))
    with pytest.raises(UsageError, match=r"other\.json"):
        read_folder(tmp_path)


@NEEDS_CHROMIUM
def test_every_plot_is_drawn_without_a_complaint_or_a_request(folder: Path, browser: "Browser") -> None:
    assert main(["board", str(folder)]) == 0
    file = folder / "board.html"
    visit = Visit(browser, file)
    assert visit.page.locator(".plot .main-svg").count() >= 2
    empty = "[...document.querySelectorAll('.plot')].filter((p) => !p.querySelector('.trace, .points'))"
    assert visit.page.evaluate(f"{empty}.length") == 0
    assert visit.said == []
    assert [url for url in visit.asked_for if not url.startswith("data:")] == [file.as_uri()]
