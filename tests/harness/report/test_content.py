import csv
import re
from dataclasses import replace
from html.parser import HTMLParser
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from harness.base.interrupt import StopRequest
from harness.episode.direct import run_direct
from harness.episode.result import RunResult, TopicCount
from harness.page.figure import MINUS, TIMES
from harness.report.content import content, render
from harness.report.recorder import RunRecorder
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.truth.traversal import ContactEvent
from rover_metrics.core.columns import COLUMNS
from rover_metrics.extended.metrics import EXTENDED_HEADER


class Outline(HTMLParser):
    """Collects headings and tags with their attributes, and sees that all are closed."""

    VOID = ("meta", "link")

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.headings: list[tuple[str, str]] = []
        self.open: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("title", "h1", "h2", "h3"):
            self.headings.append((self.open[-1], data))


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, RunRecorder]:
    """Five seconds on rocky, with their recording."""
    recorder = RunRecorder()
    with StopRequest() as stop:
        options = RosOptions(log_dir=tmp_path_factory.mktemp("logs"))
        result = run_direct(Run.of(duration=5.0), options, stop, observers=[recorder])
    return result, recorder


def without_plotly(page: str) -> str:
    bundle = files("harness.page").joinpath("assets", "plotly-basic.min.js")
    return page.replace(bundle.read_text(encoding="utf-8"), "")


def test_page_has_a_plot_for_every_column_that_changes_and_a_line_for_every_other(
    run: tuple[RunResult, RunRecorder],
) -> None:
    page = without_plotly(render(*run))
    outline = Outline(page)
    assert outline.open == []
    assert run[0].log_path is not None
    with run[0].log_path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    steady = [name for name in COLUMNS[1:-1] if len({row[name] for row in rows}) == 1]
    steady = [name for name in steady if name != "IMU Acceleration Magnitude"]  # has a band beside it
    assert "Current Collision Status" in steady
    h3 = [text for tag, text in outline.headings if tag == "h3"]
    changing = [name for name in COLUMNS[1:-1] if name not in steady]
    assert [name for name in h3 if name in COLUMNS] == changing
    plots = [attributes for tag, attributes in outline.tags if attributes.get("class") == "plot"]
    assert len(plots) == 1 + len(changing)
    assert all(attributes["role"] == "img" and attributes["aria-label"] for attributes in plots)
    folded = page[page.index("<details") : page.index("</details>")]
    assert re.findall(r'<th scope="row">([^<]+)</th>', folded) == steady
    assert '"row">Current Collision Status</th><td>0</td><td>1 while things have been near' in folded
    assert "Normal operation” in 5 rows" in page


def test_every_column_has_the_caption_of_the_data_dictionary(
    run: tuple[RunResult, RunRecorder], tmp_path: Path
) -> None:
    result, recorder = run
    log = tmp_path / "extended.csv"
    headers = [name for name in EXTENDED_HEADER if name != COLUMNS[-1]]
    rows = (",".join([str(row)] * len(headers)) for row in (1, 2))  # so that every column changes
    log.write_text("\n".join([",".join(headers), *rows]))
    plots = content(replace(result, log_path=log), recorder)["series"]
    captions = {plot.heading: plot.caption for plot in plots}
    assert list(captions) == headers[1:]
    dictionary = (Path(__file__).parents[3] / "docs" / "metrics.md").read_text(encoding="utf-8")
    for line in re.findall(r"^\| `.+", dictionary, re.MULTILINE):
        header, _, meaning, formula, *_ = re.split(r" (?<!\\)\| ", line.removeprefix("| "))
        if header.strip("`") in captions:
            entry = f"{meaning} {formula}".replace("\\|", "|").replace("^2", "²").replace("^3", "³")
            assert captions.pop(header.strip("`")) == entry
    assert captions == {}


def test_no_folder_of_whoever_ran_it_is_in_the_titles_or_the_name_of_the_log(
    run: tuple[RunResult, RunRecorder], tmp_path: Path
) -> None:
    heights = tmp_path / "private" / "yard.npy"
    heights.parent.mkdir()
    np.save(heights, np.zeros((20, 20)))
    config = Run.of(terrain=str(heights), terrain_size=(10.0, 10.0), terrain_height=1.0)
    outline = Outline(page := without_plotly(render(replace(run[0], config=config), run[1])))
    assert [text for tag, text in outline.headings if tag in ("title", "h1")] == [
        "leo on yard.npy, seed 0: complete",
        "leo on yard.npy",
    ]
    assert page.count("private") == 1  # among the arguments, as they were given
    assert run[0].log_path is not None
    assert f"5 rows in {run[0].log_path.name}" in page


def test_page_has_one_title_and_headings_in_order(run: tuple[RunResult, RunRecorder]) -> None:
    headings = Outline(without_plotly(render(*run))).headings
    assert headings[0] == ("title", "leo on rocky, seed 0: complete")
    assert [text for tag, text in headings if tag == "h1"] == ["leo on rocky"]
    levels = [int(tag[1]) for tag, _ in headings[1:]]
    assert all(later <= earlier + 1 for earlier, later in pairwise(levels))


def test_page_tells_arguments_versions_hashes_and_truth(run: tuple[RunResult, RunRecorder]) -> None:
    result, _ = run
    page = without_plotly(render(*run))
    assert result.info is not None
    assert result.info.terrain_hash in page
    assert result.info.model_hash in page
    assert re.search(r"mujoco</th><td>\d", page)
    assert re.search(r"timestep</th><td>0.0025 s<", page)
    assert f"{result.truth.path_length:.2f} m" in page
    assert "g = 9.8 m/s²" in page  # of the rover's model, not the standard's


def test_page_tells_which_way_the_map_lies_and_where_the_rover_starts(
    run: tuple[RunResult, RunRecorder], tmp_path: Path
) -> None:
    result, recorder = run
    page = without_plotly(render(result, recorder))
    assert f"40 m {TIMES} 40 m, heights" in page
    assert "starts at x 0.00 m, y 0.00 m, heading 0.00 rad from +x" in page
    assert "Seed 0, difficulty 0.5, driver wander" in " ".join(page.split())
    np.save(tmp_path / "a.npy", np.zeros((21, 41)))
    config = replace(
        result.config, terrain=str(tmp_path / "a.npy"), terrain_size=(40.0, 20.0), start=(-3.0, 4.0, 1.5)
    )
    page = without_plotly(render(replace(result, config=config), recorder))
    assert f"40 m {TIMES} 20 m, heights 0.00 to 0.00 m. +x is right and +y is up" in page
    assert f"starts at x {MINUS}3.00 m, y 4.00 m, heading 1.50 rad" in page
    assert "Seed 0, driver wander" in " ".join(page.split())
    assert "difficulty" not in page


def test_page_lists_contacts_and_says_how_many_there_are_more(
    run: tuple[RunResult, RunRecorder],
) -> None:
    result, recorder = run
    touched = ContactEvent("hazard", 10**9, 15 * 10**8, "wheel_FL", "hazard_3", 41.6, (0.2, 0.1, 0.0))
    along = replace(result.along, events=(touched,) * 60, event_count=2000)
    page = without_plotly(render(replace(result, along=along), recorder))
    row = ">wheel_FL hits hazard_3</th><td>1.00 s</td><td>0.50 s</td><td>42 N<"
    assert page.count(row) == 50
    assert "The first 50 of 2000." in page


def test_page_refers_to_nothing_outside_itself(run: tuple[RunResult, RunRecorder]) -> None:
    page = without_plotly(render(*run))
    assert not re.search(r"https?://|(src|href)=\"(?!data:)", page)
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]+)"', page)
    assert policy.startswith("default-src &#39;none&#39;; script-src &#39;sha256-")


def test_page_stays_small_enough_to_send(run: tuple[RunResult, RunRecorder]) -> None:
    assert len(render(*run).encode()) < 2_000_000


def test_names_from_users_are_text_and_never_markup(run: tuple[RunResult, RunRecorder]) -> None:
    result, recorder = run
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"
    result = replace(result, failure=evil, topics={evil: TopicCount(1)}, mode=evil)
    assert result.log_path is not None
    log = result.log_path.with_name("evil.csv")
    log.write_text(f"Timestamp,{evil},Notes\r\n1,2.0,{evil}\r\n")
    page = render(replace(result, log_path=log), recorder)
    assert "<script>alert" not in page
    assert "<img" not in page
    assert page.count("&lt;script&gt;alert(1)") >= 5


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            {"failure": "the rover left the map"},
            r"<strong>Failed</strong> after 5.0 of\s+5.0 s: the rover",
        ),
        ({"interrupted": "SIGINT"}, r"<strong>Interrupted</strong> by SIGINT after\s+5.0 of 5.0 s"),
        ({"topics": {"/scan": TopicCount(4, 3, 1)}}, r"<strong>Failed</strong>.*\s.*1 messages lost"),
    ],
)
def test_page_says_at_the_top_how_the_run_ended(
    changes: dict[str, object], expected: str, run: tuple[RunResult, RunRecorder]
) -> None:
    page = render(replace(run[0], **changes), run[1])  # type: ignore[arg-type]  # a table of keywords
    assert re.search(expected, page[: page.index("<main>")])


def test_run_without_a_log_or_a_single_batch_gets_a_page() -> None:
    result = RunResult(run=Run.of(terrain="flat"), mode="ROS 2", failure="it never began")
    page = without_plotly(render(result, RunRecorder()))
    assert "This run wrote no metrics log." in page
    assert "it never began" in page
