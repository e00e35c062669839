"""What commands show on the terminal: live progress, the summary of a run, and what can be chosen."""

import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from shlex import quote

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Column, Table
from rich.text import Text

from harness.base.errors import how_many
from harness.drivers import DRIVERS
from harness.drivers.base import OF_POLICY, Driver
from harness.drivers.policy import PolicyDriver
from harness.episode import result
from harness.episode.mishaps import mishaps
from harness.faults.kinds import FAULTS
from harness.robots import ROVERS
from harness.sensors.noise import PRESETS
from harness.sensors.table import OPTIONAL
from harness.soil.soils import SOILS
from harness.world.terrain import Terrain
from harness.world.terrains import TERRAINS
from rover_metrics.errors import printable, sibling
from rover_metrics.extended.further import FURTHER
from rover_metrics.plugins import installed
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import Sheet

PERIOD = 10.0  # [s] between lines about progress in a pipe


class Heartbeat:
    """Tells on stderr how far something is, every PERIOD of wall time, where no bar can be shown."""

    def __init__(self, console: Console, title: str) -> None:
        self._silent, self._title = console.is_terminal, title
        self._began = self._printed = time.monotonic()

    def tell(self, done: float, total: float, unit: str) -> None:
        """Takes how far the work is; prints if it is time.

        Args:
            done: So much of the work.
            total: All of it, in the same unit.
            unit: Behind the total, e.g. " s"; "" without one.
        """
        now = time.monotonic()
        if self._silent or now - self._printed < PERIOD or not 0 < done < total:
            return
        self._printed, left = now, (now - self._began) * (total - done) / done
        text = f"{self._title}: {done:g} of {total:g}{unit}, about {left:.0f} s left"
        print(printable(text), file=sys.stderr, flush=True)


@contextmanager
def driving(console: Console, title: str, total_s: float) -> Iterator[result.Show]:
    """Yields what moves a bar over simulated time [s]; in a pipe it prints a line every PERIOD."""
    heartbeat = Heartbeat(console, title)
    bar = Progress(
        TextColumn("{task.description}", style="bold", markup=False),
        BarColumn(bar_width=None),
        TextColumn("{task.completed:.1f} / {task.total:.1f} s"),
        TextColumn("{task.fields[factor]:.1f}x real time"),
        TextColumn("{task.fields[distance]:.1f} m"),
        TextColumn("{task.fields[messages]:,} messages"),
        console=console,
        disable=not console.is_terminal,
    )
    task = bar.add_task(title, total=total_s, factor=0.0, distance=0.0, messages=0)

    def show(run: result.RunResult) -> None:
        heartbeat.tell(run.simulated_s, run.run.duration, " s")
        bar.start()  # with the first call, below what nodes say as they start
        bar.update(
            task,
            completed=run.simulated_s,
            factor=run.real_time_factor,
            distance=run.truth.path_length,
            messages=run.messages,
        )

    try:
        yield show
    finally:
        bar.stop()


@contextmanager
def counted(console: Console, title: str) -> Iterator[Callable[[int, int], None]]:
    """Yields a function (done, total) that moves a bar; in a pipe it prints a line every PERIOD."""
    heartbeat = Heartbeat(console, title)
    bar = Progress(
        TextColumn(title, style="bold", markup=False),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
    with bar:
        task = bar.add_task("", total=None)

        def show(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)
            heartbeat.tell(done, total, "")

        yield show


def print_summary(console: Console, run: result.RunResult) -> None:
    """Prints counts, metrics against truth, and where the CSV is."""
    console.print(*terminal((_messages(run), _metrics(run)), console.width), sep="\n")
    console.print(
        f"{run.simulated_s:.2f} simulated seconds in {run.wall_s:.2f} s: "
        f"[bold]{run.real_time_factor:.1f}x real time[/], "
        f"{run.messages:,} messages, [bold]{run.lost} lost[/]",
        markup=True,
    )
    if run.commands != result.CommandCount():
        count = run.commands
        older, refused = f"{count.older:,} of them older than the present", f"{count.refused:,} refused"
        console.print(f"{count.taken:,} commands, {older}; {refused}")
        if run.unheeded:
            console.print(run.unheeded, style="bold red", soft_wrap=True)
    for node, waited_s in run.waited_s.items():
        share = f"{waited_s / run.wall_s:.0%}" if run.wall_s > 0 else "all"
        console.print(f"{node}: {share} of the run waited for it", soft_wrap=True)
    for mishap in mishaps(run):
        console.print(f"went wrong: {mishap.text}", style="bold red", soft_wrap=True)
    if run.log_path is not None:
        console.print(f"{how_many(run.rows, 'row')} in {run.log_path}", soft_wrap=True)
    if run.social_log is not None:
        console.print(f"people: {run.social_log}", soft_wrap=True)


def next_step(results: Sequence[result.RunResult]) -> str:
    """Returns what to try after a run, as commands."""
    program, run = sibling("harness.run"), results[0]
    kinds = {mishap.kind for each in results for mishap in mishaps(each)}
    if "tipped_over" in kinds or "left_map" in kinds:
        return (
            f"{program} --seed {run.run.seed + 1}; gentler ground: --difficulty 0.2; as a film: --video"
        )
    if "hazard" in kinds:
        robot = next(e.rover.robot for e in results if "hazard" in {m.kind for m in mishaps(e)})
        return f"did the metrics notice? Thresholds that do: {sibling('harness.tune')} --robot {robot}"
    more = f"{program} --terrain dunes --robot rover_zero4wd --out other"
    if run.log_path is None:
        return more
    return f"{more}; {sibling('rover_metrics.analyze')} {quote(str(run.log_path.parent))}"


def _messages(run: result.RunResult) -> Sheet:
    rows = (
        {
            "topic": topic,
            "published": f"{count.published:,}",
            "received": "-" if count.received is None else f"{count.received:,}",
            "lost": "-" if count.received is None else f"{count.lost:,}",
        }
        for topic, count in run.topics.items()
    )
    return Sheet.of(rows, "Messages")


def _metrics(run: result.RunResult) -> Sheet:
    row, truth = run.last_row or {}, run.truth
    hits = f"{how_many(truth.hazard_contacts, 'contact')}, {truth.hazard_contact_s:.2f} s"
    rocks = f"{how_many(truth.rock_contacts, 'contact')}, {truth.rock_contact_s:.2f} s"
    tipped = ", tipped over" if truth.tipped_over else ""
    mission = [] if run.along.mission is None else run.along.mission.rows()
    rows = (
        ("distance", _metric(row, "Distance Traveled", " m"), f"{truth.path_length:.2f} m"),
        ("collisions", _metric(row, "Total Collisions", " scans"), hits),
        ("clearance", _metric(row, "Obstacle Clearance", " m"), ""),
        ("velocity", _metric(row, "Current Velocity", " m/s"), ""),
        ("slip of moving wheels", "", f"{truth.mean_slip:.2f}"),
        ("on rocks", "", rocks),
        ("scraping the ground", "", f"{how_many(truth.scrapes, 'time')}, {truth.scrape_s:.2f} s"),
        ("largest tilt", "", f"{math.degrees(truth.largest_tilt):.0f} deg{tipped}"),
        *((kind, "", words) for kind, words in mission),
    )
    return Sheet(("quantity", "metrics_node", "truth"), rows, "Metrics and truth")


def _metric(row: dict[str, int | float | str], column: str, unit: str) -> str:
    return f"{row[column]}{unit}" if column in row else "-"


def print_choices(console: Console) -> None:
    """Prints terrains, soils, robots, drivers and noise presets with what there is to know of each."""
    own = f"your own: {sibling('harness.robot')} new NAME --from robot.urdf (docs/robots.md)"
    own_robot = ("FOLDER", own)
    drivers: dict[str, type[Driver]] = {**DRIVERS.shipped, f"{OF_POLICY}FILE.npz": PolicyDriver}
    for title, lines in (
        ("terrains", [(name, _about(terrain)) for name, terrain in TERRAINS.shipped.items()]),
        ("soils", [(name, soil.summary) for name, soil in SOILS.shipped.items()]),
        ("robots", [*((name, rover.summary) for name, rover in ROVERS.items()), own_robot]),
        ("drivers", [(name, driver.summary) for name, driver in drivers.items()]),
        ("noise", [(name, preset.summary) for name, preset in PRESETS.items()]),
    ):
        columns = Column(style="bold", no_wrap=True), Column()
        table = Table(*columns, title=title, title_justify="left", show_header=False, box=None)
        for name, summary in lines:
            table.add_row(name, summary)
        console.print(table)

    _print_plugins(console)


def _print_plugins(console: Console) -> None:
    """Prints what installed packages add to any table, and what is wrong with those that cannot."""
    lines = list(installed((TERRAINS, SOILS, DRIVERS, OPTIONAL, FAULTS, FURTHER)))
    if lines:
        console.print("plug-ins", style="italic")
    for line in lines:
        console.print(f" {line}", soft_wrap=True)


def _about(terrain: type[Terrain]) -> Text:
    promise = f"at difficulty 0.5: {terrain.promise.describe()}"
    return Text.assemble(terrain.summary, (f"\n{terrain.describe()}\n{promise}", "dim"))
