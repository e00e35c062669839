"""A compiled world that a rover drives in episode after episode, and the rover that varies."""

import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from harness.base.sim_time import CONTROL_PERIOD, TICKS_PER_CONTROL
from harness.episode.assembly import rover_of, world_of
from harness.episode.sensing import installed
from harness.gym.options import Randomisation
from harness.gym.places import Places
from harness.physics.physics import Physics
from harness.physics.scene import Scene, build_scene
from harness.physics.simulation import Simulation
from harness.physics.start import check_room, check_start
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.lidar import LidarSpec
from harness.sensors.depth import DepthOptions
from harness.sensors.lidar import Lidar
from harness.sensors.ranging import RangeSensor
from harness.spec.run import Run
from harness.world.world import Start, starting_at

if TYPE_CHECKING:
    from harness.physics.rover import State
    from harness.soil.bed import Bed


@dataclass(frozen=True, kw_only=True)
class Variation:
    """One draw from a `Randomisation`, whose fields it has."""

    friction: float = 1.0
    mass: float = 1.0
    payload: float = 0.0
    motor_strength: float = 1.0
    latency: float = 0.0
    soil_stiffness: float = 1.0
    soil_friction: float = 1.0

    @property
    def late_periods(self) -> int:
        """Control periods by which readings are late."""
        return round(self.latency / CONTROL_PERIOD)


def draw_variation(randomisation: Randomisation, rng: np.random.Generator) -> Variation:
    """Returns a draw; each field takes one number from the generator, wherever its bounds are.

    But for those of soil, which take none while they do not vary: most episodes have none.
    """
    drawn = {}
    for name, (low, high) in randomisation:
        is_given = not name.startswith("soil") or low != high
        drawn[name] = rng.uniform(low, high) if is_given else low
    return Variation(**drawn)


class Course:
    """One world with one rover, compiled once.

    Args:
        run: Which world, rover and lidar.
        camera: The depth camera that the rover carries too; None for none.

    Attributes:
        run: The run that describes world, rover and lidar.
        camera: The depth camera that the rover carries.
        scene: The rover where `harness.run` starts.
        lidar: The rover's lidar in that world.
        places: Where episodes may start and end.
    """

    def __init__(self, run: Run, camera: DepthOptions | None = None) -> None:
        world, rover = world_of(run), rover_of(run.rover)
        self.run, self.camera = run, camera
        self._frames = None if camera is None else rover_frames(rover, camera.frames(rover))
        self.scene = build_scene(world, rover, run.timestep)
        self.lidar = Lidar(self.scene.model, LidarSpec(beams=run.rover.lidar_beams))
        self.places = Places(world, rover)
        self._alike: tuple[Start, Variation] | None = None  # what the last state at time zero is of
        self._settled: list[State] = []
        self._bed: Bed | None = None  # of the last simulation, if ruts are kept

    def camera_of(self, simulation: Simulation, lidar: Lidar, seed: int) -> RangeSensor | None:
        """Returns the rover's depth camera in an episode; None without one.

        Args:
            simulation: Of the episode.
            lidar: Sees the same surroundings.
            seed: Of the camera's noise.
        """
        if self.camera is None or self._frames is None:
            return None
        run, scene, surroundings = self.run.but(seed=seed), simulation.scene, lidar.surroundings
        made = installed(run, 0, self._frames, scene, surroundings, self.camera)
        return RangeSensor(simulation, made, TICKS_PER_CONTROL)

    def varied(self, start: Start, variation: Variation) -> Scene:
        """Returns the scene of an episode, whose model is its own; UsageError off the map."""
        scene, model = self.scene, copy.copy(self.scene.model)
        if variation != Variation(latency=variation.latency):
            _vary(model, variation)
        world = starting_at(scene.world, start)
        if world.soil is not None:
            world = replace(
                world, soil=world.soil.but(variation.soil_stiffness, variation.soil_friction)
            )
        return replace(scene, model=model, world=world)

    def lidar_of(self, simulation: Simulation) -> Lidar:
        """Returns the lidar of an episode; ground that gives way is its own."""
        if simulation.physics.bed is None:
            return self.lidar
        return Lidar(simulation.model, self.lidar.spec)

    def settled(self, scene: Scene, alike: tuple[Start, Variation]) -> Simulation:
        """Returns a simulation at time zero; where the last one was alike, it settles no second time.

        `alike` is what `varied` made the scene from: equal if and only if the state at time zero is. A
        UsageError says that the rover cannot stand there, a RunFailed that it left the map or diverged.
        """
        timestep_ns, ruts = self.run.timestep_ns, self._bed
        if alike == self._alike and ruts is None:
            return Simulation(scene, timestep_ns, Physics((scene,), timestep_ns, self._settled))
        chosen = scene.world.start != self.scene.world.start
        if chosen:
            check_room(scene)
        simulation = Simulation(scene, timestep_ns, Physics((scene,), timestep_ns, ruts=ruts))
        if chosen:
            check_start(scene, simulation.data)
        self._alike, bed = alike, simulation.physics.bed
        self._bed = bed if self.run.world.keep_ruts else None
        self._settled = [rover.state() for rover in simulation.physics.rovers]
        return simulation


def _vary(model: mujoco.MjModel, variation: Variation) -> None:
    """Changes friction, masses and motors of the rover."""
    base = 1  # the rover's root body
    own = model.body_rootid == base
    model.geom_friction[own[model.geom_bodyid], 0] *= variation.friction
    model.body_mass[own] *= variation.mass
    model.body_inertia[own] *= variation.mass
    model.body_mass[base] += variation.payload
    model.actuator_forcerange[:] *= variation.motor_strength
    mujoco.mj_setConst(model, mujoco.MjData(model))
