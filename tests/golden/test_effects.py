"""What each option of a soil, a sensor, a target or a person does alone is as somebody has looked at."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import astuple, fields, is_dataclass
from functools import cache
from typing import Any, Literal, get_args, get_origin
from zlib import crc32

import gymnasium
import numpy as np
import pytest
from pydantic import BaseModel

import harness.gym  # noqa: F401 - registers its environments
from harness.base.errors import UsageError
from harness.episode.assembly import world_of
from harness.episode.episode import Episode
from harness.episode.sensing import installed
from harness.messages.fillers import filler
from harness.robots import REAL, ROVERS, equipped
from harness.robots.frames.rover_frames import RoverFrames, rover_frames
from harness.robots.lidar import LidarSpec
from harness.robots.sections import FrameRow
from harness.sensors.base import EpisodeParts
from harness.sensors.choice import chosen
from harness.sensors.rays.bundle import Surroundings
from harness.sensors.table import OPTIONAL
from harness.soil.soils import Soil
from harness.soil.wheel_force import STATE, wheel_force
from harness.spec.actor import ActorOptions
from harness.spec.run import Run
from harness.spec.target import KINDS, MESH, TargetOptions
from harness.validate.replay import replay
from tests.golden import kept
from tests.support.kernels import compiled
from tests.support.rovers import LEO
from tests.support.snapshots import check_snapshot

SOIL = {
    "k_c": 900.0,
    "k_phi": 1.2e6,
    "n": 1.1,
    "slip_n": 0.1,
    "cohesion": 900.0,
    "friction_angle_deg": 25.0,
}
SOIL |= {"shear_length": 0.01, "rebound": 0.2, "dig_grousers": 0.5, "grouser_friction": 0.3}
SOIL |= {"grouser_shear": 0.4, "flow_pressing": 0.5, "flowing": 0.4, "side_friction": 0.2}
# What only worlds of files have, what is no number, and what is not to repeat itself.
OF_FILES = ("terrain", "rock", "mesh", "reward_fn", "terminate_fn", "observe_fn", "datum", "defects")
OF_SOIL = ("soil_", "sinkage", "stuck", "ruts", "energy")  # what does nothing on firm ground
WHOLE = "as they are"
TEXTS = {"parent": LEO.imu_frame, "frame": "eye_frame", "topic": "up/front"}


def changed(options: BaseModel) -> Iterator[tuple[str, dict[str, Any]]]:
    """Names of options, each with values in which it alone is another."""
    yield WHOLE, {}
    for name, field in type(options).model_fields.items():
        value, choices = getattr(options, name), get_args(field.annotation)
        if get_origin(field.annotation) is Literal:
            value = choices[choices.index(value) - 1]
        elif isinstance(value, bool | int):
            value = not value if isinstance(value, bool) else 5 if name == "rate" else value + 1
        elif isinstance(value, float) or value is None:
            value = 0.3 if value is None else 0.8 * value + 0.1
        elif isinstance(value, BaseModel):
            yield from ((f"{name}.{key}", {name: own}) for key, own in list(changed(value))[1:])
            continue
        elif isinstance(value, tuple) and value and isinstance(value[0], int | float):
            value = tuple(part + 0.1 * place for place, part in enumerate(value, 1))
        elif name in TEXTS or name == "preset":
            value = TEXTS.get(name) or list(getattr(options, "presets", {}))[-1]
        else:
            continue
        yield name, {name: value}


def told(value: object) -> str:
    """A value by its numbers, to four digits; of many their mean, weighted sum and count."""
    if is_dataclass(value):
        return told({field.name: getattr(value, field.name) for field in fields(value)})
    if isinstance(value, dict):
        return " ".join(f"{key} {told(part)}" for key, part in value.items())
    if isinstance(value, np.ndarray) and value.size > 16:
        finite = np.where(np.isfinite(value), value, 0.0).astype(float).ravel()
        weighted = float(finite @ np.linspace(0.0, 1.0, finite.size))
        return f"<{told([finite.mean(), weighted, np.isfinite(value).sum()])}>"
    if isinstance(value, list | tuple | np.ndarray):
        return ",".join(map(told, value))
    return f"{value:.4g}" if isinstance(value, float | np.floating) else str(value)


def of_soil() -> Iterator[str]:
    for name, values in changed(Soil.model_validate(SOIL)):
        numbers, forces = Soil.model_validate(SOIL | values).numbers(0.2, 3.7), list[object]()
        for rim, ahead in ((0.5, 0.3), (0.2, 0.4)):
            state = np.zeros(STATE)
            speeds = (rim, ahead, 0.1, -0.01)
            forces += compiled(wheel_force)(
                numbers, (0.15, 0.2, 0.5), (0.03, 0.005), (0.02, 0.01), speeds, state, 0.1
            )
        yield f"soil {name}: {told(forces)}"


@cache
def frames_of(rows: tuple[FrameRow, ...]) -> RoverFrames:
    return rover_frames(LEO, rows)


def of_sensors() -> Iterator[str]:
    episode = Episode(Run.of(terrain="rocky", duration=0.05, seed=2, robot="leo", noise="hardware"))
    simulation, scene = episode.simulation, episode.simulation.scene
    surroundings = Surroundings(scene.model)
    for kind, row in OPTIONAL.shipped.items():
        if kind in ("battery", "camera"):  # of motors and pictures
            continue
        assert row.options is not None
        for name, values in changed(row.options(name=kind)):
            try:
                *_, carried = chosen(LEO.but(sensors=({"kind": kind} | values,)), None)
            except UsageError as refused:
                yield f"{kind} {name}: {str(refused).partition('; ')[0].rpartition(': ')[2]}"
                continue
            given: Any = carried.given
            install = installed(episode.run, 0, frames_of(given.frames(LEO)), scene, surroundings, given)
            parts = EpisodeParts(simulation=simulation)
            sensor: Any = carried.make(parts, 10, {given: install}.__getitem__)
            reading = sensor.read()
            made = [filler(carried, topic, LEO, LidarSpec())(reading) for topic in carried.topics]
            sent = [(t.name, crc32(m or b"")) for t, m in zip(carried.topics, made, strict=True)]
            said = [carried.frame_on(LEO), f"{carried.rate_on(LEO)} Hz", sent, reading]
            yield f"{kind} {name}: {told(said)}"


def of_targets() -> Iterator[str]:
    for kind in KINDS.keys() - {MESH}:
        for name, values in changed(TargetOptions()):
            if values and name not in (*KINDS[kind], "yaw", "within"):
                continue
            place = {} if name == "within" else {"x": 1, "y": 2}
            (made,) = world_of(
                Run.of(terrain="slope", seed=2, targets=[worded(kind, place | values)])
            ).targets
            skins = [(skin.vertices, skin.picture, skin.image) for skin in made.skins]
            bodies = [astuple(body) for body in made.bodies]
            yield f"{kind} {name}: {told([made.position, made.yaw, made.posts, bodies, skins])}"


def of_people() -> Iterator[str]:
    for way in ("a=0,2/4,2/4,6", "a=random"):
        for name, values in changed(ActorOptions()):
            (person,) = world_of(Run.of(terrain="slope", seed=2, actors=[worded(way, values)])).people
            walk: Any = person.walk()
            places = [walk.place(at) for at in (0.0, 3.3, 14.0)]
            yield f"{way} {name}: {told([person.begin, [(p.x, p.y, p.yaw) for p in places]])}"


def of_environments() -> Iterator[str]:
    flat: dict[str, Any] = {"terrain": "flat"}
    on_soil = flat | {"soil": "dry_sand", "robot": "husky", "actuators": "real"}
    on_soil |= {"depth": (4, 3), "noise": "hardware"}
    for label, kind, world in (
        ("PointNav", "PointNav", flat),
        ("RoboTerrain", "RoboTerrain", flat),
        ("OnSoil", "PointNav", on_soil),
    ):
        with closing(gymnasium.make(f"RoverHarness/{kind}-v0", **world)) as env:
            options: Any = env.unwrapped
        for name, values in changed(options.options):
            is_asked = world is flat or name == WHOLE or any(word in name for word in OF_SOIL)
            if is_asked and not name.startswith(OF_FILES):
                yield f"{label} {name}: {_driven(kind, world | values)}"


def _driven(kind: str, options: dict[str, Any]) -> str:
    """What an environment shows and pays in its first steps, or why there is none."""
    try:
        with closing(gymnasium.make(f"RoverHarness/{kind}-v0", **options)) as env:
            return told([env.reset(seed=4), *(env.step(env.action_space.high) for _ in range(3))])  # type: ignore[attr-defined]  # a Box
    except UsageError as refused:
        return str(refused).partition("; ")[0]


def of_motors() -> Iterator[str]:
    rover, commands = equipped(ROVERS["husky"], REAL, "sandy_loam"), np.array([[0.0, 0.5, 0.9]])
    for section in ("actuators", "tyres"):
        for name, values in changed(getattr(rover, section)):
            other = rover.but(**{section: getattr(rover, section).but(**values)})
            series = replay(other, commands, 0.4).series
            yield f"{section} {name}: {told([one[-1] for one in series.values()])}"


def worded(what: str, options: dict[str, Any]) -> str:
    return f"{what}:{','.join(f'{key}={value}' for key, value in options.items())}".rstrip(":")


def test_what_each_option_does_alone_is_as_somebody_has_looked_at() -> None:
    if kept.references()[kept.ARITHMETIC] != kept.arithmetic():
        pytest.skip("another arithmetic: the last digits of poses differ")
    every = (of_soil, of_environments, of_motors, of_sensors, of_targets, of_people)
    told_of = dict(line.split(": ", 1) for of in every for line in of())
    whole = {what: told_of[f"{what.partition(' ')[0]} {WHOLE}"] for what in told_of}
    for what, text in told_of.items():
        if text == whole[what] and not what.endswith(WHOLE):
            told_of[what] = "the same"
    lines = sorted(f"{what}: {text}" for what, text in told_of.items())
    check_snapshot("effects.txt", "\n".join(lines) + "\n")
