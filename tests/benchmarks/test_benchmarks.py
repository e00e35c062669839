"""The benchmarks still run, take turns, and write what they measured; their figures are not tested."""

import re
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import pytest

from benchmarks import lidar
from benchmarks.__main__ import main
from benchmarks.measuring import QUICK, Rounds, Table
from benchmarks.readme import README, SOAK, TEMPLATE, markdown, write_readme, write_soak
from benchmarks.registry import BENCHMARKS, Benchmark
from tests.support.complaint import complaint
from tests.support.forking import ForkServer

SMALLEST = replace(QUICK, seconds=1.0, maps=1)
SHORT = [name for name, benchmark in BENCHMARKS.items() if not benchmark.takes_minutes]
IN_ROS = {"runs", "lockstep", "sensors", "start"}
LESS = {  # of what only repeats
    "gym.get_context": ForkServer().get_context,
    "lockstep.ELSEWHERE": {"two": 2},
    "lockstep.GOALS": {"one, in this process": 1.0, "two": 0.75},
    "obstacles.COUNTS": (0, 10),
    "runs.ROVERS": ("leo",),
    "scenarios.get_context": ForkServer().get_context,
    "soil.ROVERS": ("leo",),
    "sensors.TARGETS": {"depth": ("-", "-")},
    "sensors._run": lambda *_: (1.0, 1.0),  # that of "runs"
    "start.WAYS": {"--direct": ("--direct",)},
    "start.IMPORTS": "import harness",
    "start.PROGRAMS": ["harness.call"],
    "tuning.ROVERS": ("leo",),
    "tuning.TARGETS": {1: "-"},
}


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("name", SHORT)
def test_every_benchmark_measures_something(
    name: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    if name in IN_ROS:
        pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    monkeypatch.setattr("benchmarks.__main__.QUICK", SMALLEST)
    if name == "gym":
        monkeypatch.setattr("harness.gym.many.multiprocessing", ForkServer())
    for place, less in LESS.items():
        if place.startswith(f"{name}."):
            monkeypatch.setattr(f"benchmarks.{place}", less)
    assert main(["--quick", name]) == 0
    told = capfd.readouterr().out
    assert "skipped: No module named 'rclpy'" not in told
    assert len(told.splitlines()) > 5


def test_every_benchmark_has_its_module() -> None:
    assert all(callable(import_module(f"benchmarks.{name}").measure) for name in ("lidar", "growth"))
    assert Benchmark("no_such_module", "?").measure(QUICK).columns == ("skipped",)


def test_contestants_take_turns_and_ratios_are_those_of_the_rounds() -> None:
    turns: list[str] = []

    def contestant(name: str, *times: float) -> Callable[[], float]:
        waiting = list(times)

        def run() -> float:
            turns.append(name)
            return waiting.pop(0)

        return run

    # The machine gets ten times slower and recovers: each ratio stays 2, though no time does.
    rounds = Rounds(
        {"slow": contestant("slow", 2.0, 20.0, 4.0), "fast": contestant("fast", 1.0, 10.0, 2.0)}, 3
    )
    assert turns == ["slow", "fast"] * 3
    assert rounds.ratio("slow", "fast") == 2.0
    assert rounds.median("fast") == 2.0


def test_scan_on_small_maps_is_that_of_mujoco_to_a_hundredth_of_a_millimetre() -> None:
    table = lidar.measure(QUICK)
    against, differing, largest = map(
        table.columns.index, ("against", "hits that differ", "largest difference")
    )
    rows = [row for row in table.rows if row[against].startswith("mj_multiRay")]
    assert all(row[differing].startswith("0 of ") for row in rows)
    assert all(float(row[largest].split()[0]) <= 1e-5 for row in rows)


def test_readme_is_the_one_that_the_benchmarks_wrote() -> None:
    text = README.read_text()
    assert text.startswith(TEMPLATE)
    assert text.partition(SOAK)[0].count("\n### ") == len(BENCHMARKS)


FIRST_PAGE = (README.parents[1] / "README.md").read_text()
FIGURES = {  # what the first page says: the row it is from, and its column
    r"to (\d+) times real time": ("| leo | through ROS 2 |", "times real time"),
    r"Of ([\d,]+) messages": ("| one, in this process |", "messages"),
    r"messages (\d+) are lost": ("| one, in this process |", "lost"),
    r"row (\d\.\d) s after": ("| through ROS 2 |", "to the first row, or to the end"),
    r"any of ([\d,]+) in two hours of breaking": ("| metrics_node hosted |", "messages"),
    r"20 m (\d+) times as\s+fast": ("| 20 m, 10 cm | mj_multiRay", "ratio"),
}


@pytest.mark.parametrize("sentence", FIGURES)
def test_a_figure_of_the_first_page_is_the_measured_one(sentence: str) -> None:
    (told,) = re.findall(sentence, FIRST_PAGE)
    row, column = FIGURES[sentence]
    (before, found) = README.read_text().split(f"\n{row}")
    titles = before.rpartition("\n\n")[2].partition("\n")[0].split(" | ")
    cell = (row + found).split(" | ")[[title.strip("| ") for title in titles].index(column)]
    measured, figure = (float(re.sub(r"[^\d.]", "", text)) for text in (cell, told))
    assert figure == pytest.approx(measured, rel=0.1), f"README.md should say {cell}"


def test_each_command_writes_its_part_of_the_readme_and_keeps_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    readme = tmp_path / "README.md"
    readme.write_text("")
    monkeypatch.setattr("benchmarks.readme.README", readme)
    speed, growth, hours, days = (
        Table(title=title, columns=("way",), rows=(("here",),))
        for title in ("Speed", "Growth", "Hours", "Days")
    )
    write_readme("Alder.", {"runs": speed, "growth": growth})
    write_soak("Birch.", hours)
    write_soak("Cedar.", days)
    write_readme("Dogwood.", {"runs": speed})
    text = readme.read_text()
    assert text.startswith(TEMPLATE)
    assert [text.count(machine) for machine in ("Alder", "Birch", "Cedar", "Dogwood")] == [1, 0, 1, 1]
    places = [
        text.index(part) for part in ("### Growth", "Alder", "### Speed", "Dogwood", SOAK, "Cedar")
    ]
    assert places == sorted(places)
    assert text.partition(SOAK)[2] == f"\n\nCedar.\n\n{markdown(days)}"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["speed"], "benchmark 'speed' does not exist; available: lidar, growth"),
        (["--write", "--quick"], "--write measures in full"),
    ],
)
def test_bad_argument_is_one_line(
    arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert expected in complaint(main, arguments, capsys)
