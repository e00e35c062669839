"""What in a scenario's file contradicts another part of it."""

from collections.abc import Iterator

from harness.base.errors import unknown
from harness.scenario.bound import Bound
from harness.scenario.names import COUNT, LATENCY, OF_TARGET, heard_quantity
from harness.scenario.quantities import GOAL, ROUTE, TARGETS
from harness.scenario.spec import Scenario
from harness.scenario.steps import CommandEvent, Event, PauseEvent
from harness.world.targets.placing import target_names

Place = tuple[str | int, ...]  # keys and indices from the file's top
PAUSE = "without nodes nobody would notice a pause; it needs 'launch:' or an expectation of a topic"


def problems(scenario: Scenario) -> Iterator[tuple[Place, str]]:
    """Yields what in a file contradicts another part of it: where it stands, and why it is a mistake."""
    for name in sorted(scenario.matrix.model_fields_set & scenario.model_fields_set):
        yield (name,), f"give one of {name} and matrix: {name}"
    for name in sorted(scenario.matrix.model_fields_set):
        if not getattr(scenario.matrix, name):
            yield ("matrix", name), "an empty list drives nothing; leave it out, or fill it"
    if scenario.seeds is not None and "seed" in scenario.model_fields_set:
        yield ("seed",), "give one of seed and seeds"
    if not scenario.measured:
        yield (), "key 'expect' is missing, or 'measure'"
    lists = {name: values for name, values in scenario.matrix if len(values) > 1}
    if scenario.compare and scenario.compare not in lists:
        known = ", ".join(lists) or "none has several values"
        yield ("compare",), f"'{scenario.compare}' is no list of matrix; available: {known}"
    late = f"after the run of {scenario.duration:g} s"
    yield from _problems_of_quantities(scenario)
    for index, event in enumerate(scenario.events):
        if event.at >= scenario.duration:
            yield ("events", index), f"an event at {event.at:g} s is {late}"
        if problem := _problem_of_event(scenario, event):
            yield ("events", index), problem


def _problems_of_quantities(scenario: Scenario) -> Iterator[tuple[Place, str]]:
    late = f"after the run of {scenario.duration:g} s"
    for name, bound in scenario.measured:
        part = "expect" if name in scenario.expect else "measure"
        if bound.window is not None and bound.window[1] > scenario.duration:
            yield (part, name), f"a window to {bound.window[1]:g} s ends {late}"
        if name.startswith(GOAL) and scenario.goal is None:
            yield (part, name), "it needs a goal, e.g. goal: {at: [5, 0]}"
        if problem := _problem_of_mission(scenario, name) or _problem_of_topic(name, bound):
            yield (part, name), problem


def _problem_of_mission(scenario: Scenario, name: str) -> str | None:
    given = scenario.run_values()
    if name.startswith(ROUTE) and given.get("route") is None:
        return "it needs a route, e.g. route: 5,0/8,2"
    targets = given.get("targets", ())
    if name.startswith(TARGETS) and not targets:
        return "it needs targets, e.g. targets: [aruco]"
    match, known = OF_TARGET.fullmatch(name), target_names(targets)
    if match is not None and match["name"] not in known:
        return unknown("target", match["name"], known)
    return None


def _problem_of_event(scenario: Scenario, event: Event) -> str | None:
    drivers = set(scenario.matrix.driver or (scenario.run_values().get("driver"),))
    if isinstance(event, CommandEvent) and drivers != {"cmd_vel"}:
        return "commands need 'driver: cmd_vel'; others drive by themselves"
    if isinstance(event, PauseEvent) and not scenario.needs_ros:
        return PAUSE
    return None


def _problem_of_topic(name: str, bound: Bound) -> str | None:
    """What is wrong with a bound because of the topic's quantity that it is of."""
    quantity = heard_quantity(name)
    measure = "" if quantity is None else quantity.measure
    if measure == LATENCY and bound.of is None:
        return "a latency needs the topic of the input, e.g. of: /scan"
    if measure != LATENCY and bound.of is not None:
        return "'of' belongs to the latency of a topic"
    if measure == COUNT and bound.over not in ("always", "end"):
        return f"a count is one number; leave out 'over: {bound.over}'"
    return None
