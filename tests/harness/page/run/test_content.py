import html
import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from harness.episode.result import RunResult, TopicCount
from harness.page.figure import AXIS, TIMES
from harness.page.run.content import render
from harness.page.run.recorder import RunRecorder
from harness.spec.run import Run
from tests.harness.page.run.made import RESULT, recorder, stretches, write_log
from tests.support.pages import Outline, without_plotly
from tests.support.rovers import LEO
from tests.support.snapshots import check_snapshot


def short(value: object) -> object:
    """A figure with what is long in it cut short: pictures, and lists by ends and extremes."""
    if isinstance(value, dict):
        return {name: short(item) for name, item in value.items() if name != "source"}
    if not isinstance(value, list) or len(value) <= 16 or not all(map(is_number, value)):
        return [short(item) for item in value[:16]] if isinstance(value, list) else value
    known = [number for number in value if number is not None]
    return f"{value[0]} .. {value[-1]}, {len(value)}, {min(known)} to {max(known)}"


def drawn(figure: dict[str, Any]) -> Iterator[str]:
    """A line for each trace, axis and shape of a figure."""
    layout = figure["layout"]
    axes = (layout[name] for name in ("xaxis", "yaxis", "title") if name in layout)
    for item in (*figure["data"], *axes, *layout.get("shapes", ()), *layout.get("images", ())):
        own = {name: value for name, value in item.items() if AXIS.get(name, ...) != value}
        yield json.dumps(short(own), ensure_ascii=False)


def is_number(value: object) -> bool:
    return value is None or isinstance(value, int | float)


def test_page_and_figures_of_a_run_are_as_somebody_has_checked(tmp_path: Path) -> None:
    result = replace(RESULT, log_path=write_log(tmp_path / "metrics_log.csv"))
    others = {"other": stretches({}, {})}
    page = without_plotly(render(result, recorder(), others))
    assert not re.search(r"https?://|(src|href)=\"(?!data:)", page)
    outline = Outline(page)
    assert all(later <= earlier + 1 for earlier, later in pairwise(outline.levels))
    assert len(page) < 1_000_000
    (figures,) = re.findall(r'id="figures">(.*?)</script>', page)
    lines = (f"{name}: {line}\n" for name, one in json.loads(figures).items() for line in drawn(one))
    shown = re.sub(r"<(script|style).*?</\1>|<meta.*?>|; written [^<]*", "", page, flags=re.DOTALL)
    shown = re.sub(r'<section aria-labelledby="facts-.*?</section>', "", shown, flags=re.DOTALL)
    check_snapshot("report.html.txt", shown + "".join(lines))


def test_no_folder_of_whoever_ran_it_is_in_the_titles_or_the_name_of_the_log(tmp_path: Path) -> None:
    heights = tmp_path / "private" / "yard.npy"
    heights.parent.mkdir()
    np.save(heights, np.add.outer(np.arange(20.0), np.zeros(20)))
    config = Run.of(terrain=str(heights), terrain_size=(10.0, 10.0), terrain_height=1.0)
    outline = Outline(page := without_plotly(render(replace(RESULT, run=config), RunRecorder())))
    titles = [text for tag, text in outline.headings if tag in ("title", "h1")]
    assert titles == ["leo on yard.npy, seed 0: failed", "leo on yard.npy"]
    assert f"10 m {TIMES} 10 m, heights 0.00 to 1.00 m. +x is right and +y is up" in page
    assert "difficulty" not in page
    assert page.count("private") == 1  # among the arguments, as they were given
    log = replace(RESULT, log_path=write_log(heights.with_name("log.csv")))
    assert "private" not in (page := without_plotly(render(log, recorder())))
    assert "8 rows in log.csv" in page


def test_names_from_users_are_text_and_never_markup(tmp_path: Path) -> None:
    evil = "<script>alert(1)<img src=x onerror=alert(2)>[b]$x$"
    heights, robot, log = (tmp_path / f"{evil}{end}" for end in (".npy", "", ".csv"))
    np.save(heights, np.zeros((20, 20)))
    shutil.copytree(LEO.folder, robot)
    log.write_text(f"Timestamp,{evil},Notes\r\n1,2.0,{evil}\r\n2,3.0,{evil}\r\n")
    run = RESULT.run.alone(terrain=str(heights), terrain_size=20, robot=str(robot))
    values = {"failure": evil, "topics": {evil: TopicCount(1)}, "mode": evil}
    page = render(replace(RESULT, run=run, log_path=log, **values), recorder())  # type: ignore[arg-type]
    assert "<script>alert" not in page
    assert "<img" not in page
    assert page.count(f"{html.escape(evil)}") >= 8


def test_the_page_says_at_the_top_how_the_run_ended_even_if_it_never_began() -> None:
    stopped = replace(RESULT, topics={}, interrupted="SIGINT")
    top = render(stopped, recorder()).partition("<main>")[0]
    assert re.search(r"<strong>Interrupted</strong> by SIGINT after\s+8.0 of 60.0 s", top)
    result = RunResult(run=Run.of(terrain="flat"), mode="ROS 2", failure="it never began")
    page = without_plotly(render(result, RunRecorder()))
    assert "This run wrote no metrics log." in page
    assert "it never began" in page.partition("<main>")[0]
