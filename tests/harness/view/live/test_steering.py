"""Drawn orders from keys, clicks and elsewhere: what drives a rover is what a small model says."""

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import settings, strategies
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.drivers import takes_goals
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.fingerprint import StreamHash
from harness.episode.helm import Helm, Order
from harness.episode.result import Outputs
from harness.robots import find_rover
from harness.samples import Place, Twist
from harness.spec.ros import RosOptions
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.spec.run import Run
from harness.view.live.keys import DIRECTIONS, HELD, STANDING, Keys
from harness.view.live.wheel import GOAL, Wheel
from rover_metrics.core.thresholds import Thresholds

PERIOD = 0.05  # [s]
ROBOTS = "leo", "rover_zero4wd"
EITHER = strategies.sampled_from((0, 1))
Threshold = tuple[str, int]
THRESHOLD = strategies.tuples(
    strategies.sampled_from(("collision_threshold", "distance_threshold")), strategies.integers(1, 9)
)
COORDINATE = strategies.integers(-9, 9).map(float)


@dataclass
class Rover:
    """What drives a rover, its command and its goal: of who follows orders, and of who is asked for."""

    own: str
    driver: str = ""
    commanded: Twist | None = None
    goal: Place | None = None
    is_back: bool = False

    @property
    def state(self) -> tuple[object, ...]:
        return self.driver or self.own, self.commanded or Twist(), self.goal, self.is_back

    def reset(self) -> None:
        self.is_back = True
        self.hand_over("")

    def hand_over(self, driver: str) -> None:
        self.driver, self.commanded, self.goal = driver, None, None

    def follow(self, order: Order) -> None:
        if order.reset:
            self.reset()
        if order.driver is not None:
            self.hand_over(order.driver)
        if order.command is not None and (self.driver or self.own) == CMD_VEL:
            assert order.held
            self.commanded = order.command
        if order.goal is not None and takes_goals(self.driver or self.own):
            self.goal = order.goal


class Metrics:
    """The metrics of a rover, which use thresholds from when they are told on.

    Attributes:
        meanwhile: What happens the next time that they are told.
        has_more: Whether something happened the last time.
    """

    last_row = None

    def __init__(self) -> None:
        self.thresholds, self.has_more = Thresholds(), False
        self.meanwhile: Callable[[], None] | None = None

    def use(self, thresholds: Thresholds) -> None:
        act, self.meanwhile = self.meanwhile, None
        self.thresholds, self.has_more = thresholds, act is not None
        if act is not None:
            act()


@dataclass
class Grip:
    """The keys of a rover that are held, as somebody would tell it who looks at the keyboard."""

    shares: tuple[float, float] = STANDING
    until: float = -1.0


class Page(RuleBasedStateMachine):
    """Two rovers and a page, on which anything is pressed at any time."""

    @initialize(
        own=strategies.tuples(*[strategies.sampled_from(("wander", CMD_VEL, GOAL, "wander"))] * 2)
    )
    def begin(self, own: tuple[str, str]) -> None:
        self.now, self.helm = 0.0, Helm(None, StopRequest())
        self.helm.idle = self.helm.step
        each = zip("ab", ROBOTS, own, strict=True)
        self.run = Run(rovers=tuple(RoverSetup(name=n, robot=r, driver=d) for n, r, d in each))
        self.wheels = [
            Wheel(self.helm, n, setup, Keys(lambda: self.now)) for n, setup in enumerate(self.run.rovers)
        ]
        self.driven, self.wanted = ([Rover(each) for each in own] for _ in range(2))
        self.grips, self.judged = [Grip(), Grip()], [Thresholds(), Thresholds()]
        self.helm.metered = self.metered = [Metrics(), Metrics()]
        followers = [SimpleNamespace(give=rover.follow, is_shared=False) for rover in self.driven]
        batches = partial(iter, lambda: self.now, None)
        stream: Any = SimpleNamespace(batches=batches, rovers=followers, next_ns=1)
        self.periods = self.helm.steered(stream)

    @rule(number=EITHER, key=strategies.sampled_from(tuple(DIRECTIONS.values())))
    def press(self, number: int, key: tuple[str, float, float]) -> None:
        _, *pressed = key
        self.wheels[number].press(*pressed)
        grip, wanted, rover = self.grips[number], self.wanted[number], find_rover(ROBOTS[number])
        held = grip.shares if self.now < grip.until else STANDING
        forward, left = (new or old for new, old in zip(pressed, held, strict=True))
        self.grips[number] = Grip((forward, left), self.now + HELD)
        if (wanted.driver or wanted.own) != CMD_VEL:
            wanted.hand_over(CMD_VEL)
        wanted.commanded = Twist(forward * rover.cruise_speed, left * rover.cruise_yaw_rate)

    @rule(number=EITHER, x=COORDINATE, y=COORDINATE)
    def click(self, number: int, x: float, y: float) -> None:
        self.wheels[number].head_for(x, y, (0.5, 0.5, 0.0))
        self.grips[number], wanted = Grip(), self.wanted[number]
        if wanted.driver or not takes_goals(wanted.own):
            wanted.hand_over(GOAL)
        wanted.goal = Place(x, y, math.atan2(y - 0.5, x - 0.5))

    @rule(number=EITHER)
    def give_back(self, number: int) -> None:
        self.wheels[number].give_back()
        wanted, grip = self.wanted[number], self.grips[number]
        if wanted.driver or self.now < grip.until:
            wanted.hand_over("")
        self.grips[number] = Grip()

    @rule(number=EITHER)
    def reset(self, number: int) -> None:
        self.wheels[number].reset()
        self.grips[number] = Grip()
        self.wanted[number].reset()

    @rule(number=EITHER, threshold=THRESHOLD, meanwhile=strategies.none() | THRESHOLD)
    def judge(self, number: int, threshold: Threshold, meanwhile: Threshold | None) -> None:
        self.move(number, *threshold)
        if meanwhile is not None:
            self.metered[number].meanwhile = partial(self.move, number, *meanwhile)

    def move(self, number: int, name: str, value: int) -> None:
        self.helm.judge(number, replace(self.helm.thresholds(number), **{name: value / 10}))
        self.judged[number] = replace(self.judged[number], **{name: value / 10})
        assert [self.helm.thresholds(each) for each in (0, 1)] == self.judged

    @rule()
    def pause(self) -> None:
        self.helm.paused = not self.helm.paused

    @rule(periods=strategies.sampled_from((1, 2, 16, 16)), others=strategies.booleans())
    def drive(self, periods: int, others: bool) -> None:
        for _ in range(periods):
            self.now += PERIOD
            for wheel, grip, wanted in zip(self.wheels, self.grips, self.wanted, strict=True):
                wheel.let_go()
                if 0.0 < grip.until <= self.now:
                    wanted.commanded, grip.until = Twist(), -1.0
            next(self.periods)
        for driven, wanted in zip(self.driven, self.wanted, strict=True):
            assert driven.state == wanted.state
        assert [self.helm.thresholds(each) for each in (0, 1)] == self.judged
        for metrics, judged in zip(self.metered, self.judged, strict=True):
            assert metrics.thresholds == judged or metrics.has_more
        assert self.helm.driven(self.run) is self.run  # no plan says what is ordered of one of several
        is_judged = self.judged != [Thresholds()] * 2
        assert self.helm.note(self.run).endswith("do not repeat it") == (
            is_judged or bool(self.helm.given)
        )
        for rovers in zip(self.driven, self.wanted, self.grips, strict=True):
            for rover in rovers[:2]:
                if others and rovers[2].until <= self.now and rover.own != GOAL:  # unseen
                    rover.reset()
                rover.is_back = False


Page.TestCase.settings = settings(max_examples=100, stateful_step_count=30, derandomize=True)
TestPage = Page.TestCase


def test_a_key_of_turning_goes_with_one_of_driving_as_long_as_either_is_held() -> None:
    now = [0.0]
    keys = Keys(lambda: now[0])
    for forward, left, both in (
        (1.0, 0.0, (1.0, 0.0)),
        (0.0, 1.0, (1.0, 1.0)),
        (-1.0, 0.0, (-1.0, 1.0)),
    ):
        keys.press(forward, left)
        now[0] += 0.9 * HELD
        assert keys.share == both
    now[0] += 0.2 * HELD
    assert keys.share == STANDING


class Hand:
    """An observer that presses, clicks and resets on the page of a rover, as drawn."""

    def __init__(self, helm: Helm, run: Run, number: int, rng: np.random.Generator) -> None:
        self._rng, self._now = rng, 0.0
        self._wheel = Wheel(helm, number, run.rovers[number], Keys(lambda: self._now))

    def take(self, batch: Batch) -> None:
        self._now += PERIOD
        for act in self._rng.integers(6, size=self._rng.poisson(0.25)).tolist():
            if act < 3:
                self._wheel.press(*self._rng.choice([key[1:] for key in DIRECTIONS.values()]).tolist())
            elif act == 3:
                x, y = self._rng.uniform(-4.0, 4.0, 2).tolist()
                self._wheel.head_for(x, y, batch.truth.position)
            else:
                (self._wheel.give_back, self._wheel.reset)[act - 4]()
        self._wheel.let_go()


def driven(
    folder: Path, run: Run, helm: Helm | None, watching: dict[int, Hand] | None = None
) -> list[tuple[bytes, str]]:
    """The log and the hash of the samples of each rover."""
    streams, hands = [StreamHash() for _ in run.rovers], watching or {}
    outputs = [
        Outputs(log_dir=folder / str(n), observers=(stream, *([hands[n]] if n in hands else [])))
        for n, stream in enumerate(streams)
    ]
    results = run_direct(run, outputs, RosOptions(log_dir=folder), StopRequest(), None, helm)
    logs = [one.log_path.read_bytes() for one in results if one.log_path is not None]
    return [(log, stream.hexdigest()) for log, stream in zip(logs, streams, strict=True)]


@pytest.mark.parametrize(
    "own",
    [
        {"driver": "wander"},
        {"driver": CMD_VEL, "faults": ["cmd_vel:dropout=0.5"]},
        {"driver": CMD_VEL, "cmd_vel_timeout": 0.4, "soil": "dry_sand"},
        {"driver": "goal", "noise": "hardware"},
        {"driver": "goal", "goal_area": "-3,3,-3,3"},
        {"driver": "goal", "route": "2,0/0,2"},
        {"driver": "dwa", "robot": "husky", "actuators": "real", "actors": ["social"]},
    ],
)
def test_what_is_drawn_on_a_page_and_in_a_plan_is_the_plan_of_a_run_with_the_same_bytes(
    own: dict[str, Any], tmp_path: Path
) -> None:
    rng = np.random.default_rng(7)
    run = Run.of(terrain="rocky", duration=4.0, lidar_beams=36, **own)
    drawn = rng.integers(1, round(run.duration / PERIOD), 16) * PERIOD  # often when a page orders
    times = drawn.round(2).tolist()
    plan = run.plan.but(
        resets=times[:2],
        drivers=[*zip(times[2:5], (CMD_VEL, GOAL, ""), strict=True)],
        commands=[(at, 0.3, 0.1) for at in times[5:10]],
        goals=[(at, 1.0, 1.0, 0.0) for at in times[10:13]],
        link_losses=[(times[13], 0.5)],
        aborts=times[14:15],
        resumes=times[15:],
    )
    is_led = run.rover.goal_area is not None or plan.route is not None  # then there are no other goals
    helm, run = Helm(None, StopRequest()), run.but(plan=plan.but(goals=()) if is_led else plan)
    steered = driven(tmp_path / "a", run, helm, {0: Hand(helm, run, 0, rng)})
    assert len(helm.given) > 5
    assert ("not" in helm.note(run)) == is_led
    with pytest.raises(UsageError) if is_led else nullcontext():
        assert driven(tmp_path / "b", helm.driven(run), None) == steered
