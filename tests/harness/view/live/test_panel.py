"""The controls of a page with two rovers, used over the wire as a browser uses them: they act on one."""

import math
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("viser", reason="needs the extra [live]")

from harness.base.interrupt import StopRequest
from harness.episode.direct import run_direct
from harness.episode.helm import Helm, Order
from harness.episode.metrics_feed import metric_settings
from harness.episode.result import Outputs
from harness.robots import find_rover
from harness.spec.fleet import parse_rovers
from harness.spec.live import LiveOptions
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.view.live.page import LivePage
from tests.support.visitor import Visitor
from tests.support.waiting import PATIENCE, free_port, wait_until

FLEET = ("leo:a", "rover_zero4wd:b,x=3,y=3,yaw=2.5")
PERIODS = 45  # of 50 ms: two rows


class Told(Helm):
    """A helm that keeps what is ordered."""

    def __init__(self) -> None:
        super().__init__(None, StopRequest())
        self.ordered: list[Order] = []

    def order(self, number: int, order: Order) -> None:
        super().order(number, order)
        self.ordered.append(order)


class Session:
    """A paused run of two rovers, and who looks at its page; `steps` goes on where the run waits."""

    def __init__(self, folder: Path) -> None:
        run = Run.of(terrain="rolling", duration=4.0, lidar_beams=36, driver="wander")
        self.run = run.but(rovers=parse_rovers(FLEET, run.rover))
        self.logs = [folder / rover.name for rover in self.run.rovers]
        self.helm = Told()
        self.helm.paused = True

    def drive(self) -> None:
        address = LiveOptions(live=f"127.0.0.2:{free_port()}")  # through a gate, without a token
        with LivePage(self.run, self.helm, address) as page, Visitor(page.address) as visitor:
            self.page, self.visitor, steps = page, visitor, self.steps()
            self.helm.idle = partial(next, steps)
            outputs = [
                Outputs(
                    log_dir=log,
                    observers=(one,),
                    settings=metric_settings(self.run, {}, number, extended=True),
                )
                for number, (log, one) in enumerate(zip(self.logs, page.observers, strict=True))
            ]
            options = RosOptions(log_dir=self.logs[0])
            run_direct(self.run, outputs, options, StopRequest(), None, self.helm)
            assert next(steps, "over") == "over"

    def steps(self) -> Iterator[None]:
        helm, visitor = self.helm, self.visitor
        for _ in range(PERIODS):
            helm.step()
            yield
        for number in (1, 0):
            yield from self.use(number)
        for speed, rate in (("2x", 2.0), ("as fast as it can", None)):
            visitor.choose("Speed", speed)
            wait_until(lambda rate=rate: helm.rate == rate)  # type: ignore[misc] # a bound default
        before = self.page.observers[0].time_s
        visitor.press("Step")
        yield from self.until(lambda: self.page.observers[0].time_s > before)
        assert self.page.observers[0].time_s == pytest.approx(before + 0.05)
        visitor.press("Go on")
        wait_until(lambda: not helm.paused)
        yield

    def use(self, number: int) -> Iterator[None]:
        """Uses all that acts on one of the rovers."""
        visitor, helm, setup = self.visitor, self.helm, self.run.rovers[number]
        rover = find_rover(setup.robot)
        wait_until(lambda: f"**{self.page.observers[0].time_s:.1f} s**" in visitor.texts)  # all is drawn
        visitor.choose("Rover", setup.name)
        wait_until(lambda: f"**{setup.name}, a {setup.robot}**" in visitor.texts)
        wait_until(partial(self.is_drawn, number))
        watch = self.page.observers[number]
        wait_until(lambda: f"{watch.truth.path_length:.1f} m, {watch.speed:.2f} m/s" in visitor.texts)

        other = helm.thresholds(1 - number)
        visitor.choose("collision_threshold [m]", 0.4 + 0.1 * number)
        wait_until(lambda: helm.thresholds(number).collision_threshold == 0.4 + 0.1 * number)
        assert helm.thresholds(1 - number) == other

        assert watch.sight is not None
        x, y, _ = watch.sight.position
        yield from self.ordered(number, partial(visitor.click, 1.0, -2.0), "goal")
        self.assert_goal(x + 1.0, y - 2.0, (x, y))

        yield from self.ordered(number, partial(visitor.command, "Drive backwards"), "command")
        command = self.last.command
        assert command is not None
        assert (command.linear, command.angular) == (-rover.cruise_speed, 0.0)
        yield from self.ordered(number, partial(visitor.press, "Let it drive by itself"), "driver")
        assert self.last.driver == ""
        yield from self.ordered(number, partial(visitor.press, "Reset"), "reset")
        assert self.last.reset

    def ordered(self, number: int, act: partial[None], what: str) -> Iterator[None]:
        """Acts; once that was ordered, however late, lets the period pass in which it is followed."""
        helm, before = self.helm, (len(self.helm.ordered), len(self.helm.given))

        def found() -> list[Order]:
            return [one for one in helm.ordered[before[0] :] if getattr(one, what) not in (None, False)]

        act()
        wait_until(found)
        self.last, *_ = found()
        helm.step()
        yield
        assert {each.number for each in helm.given[before[1] :]} == {number}  # the chosen one

    def until(self, condition: Callable[[], bool]) -> Iterator[None]:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline
            yield

    def assert_goal(self, x: float, y: float, of: tuple[float, float]) -> None:
        goal = self.last.goal
        assert goal is not None
        assert (goal.x, goal.y) == pytest.approx((x, y), abs=0.02)
        assert goal.yaw == pytest.approx(math.atan2(y - of[1], x - of[0]), abs=0.05)

    def is_drawn(self, number: int) -> bool:
        """Whether the charts are the columns of a rover's log."""
        (file,) = self.logs[number].glob("*.csv")
        log, charts = pd.read_csv(file), self.visitor.charts()
        numbers = log.select_dtypes("number").dropna(axis=1, how="all")
        assert numbers.isna().any(axis=None)  # rates are empty at first
        time, *names = numbers.columns
        return charts.keys() == {*names} and all(
            np.array_equal(charts[name], numbers[[time, name]].dropna().to_numpy(float).T)
            for name in names
        )


def test_each_control_acts_on_the_rover_that_is_chosen(tmp_path: Path) -> None:
    Session(tmp_path).drive()
