"""An SDF file or a mesh -> a world: ground, obstacles as rocks and hazards, a place for a rover."""

import hashlib
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.ndimage import distance_transform_edt

from harness.base.errors import UsageError
from harness.base.mesh import Mesh, joined
from harness.base.mesh_file import SUFFIXES
from harness.base.sdf.poses import IDENTITY
from harness.base.sdf.resources import Resources
from harness.spec.world import WorldSpec
from harness.world.heightfield import EDGE_MARGIN
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.occupancy import FREE, occupancy
from harness.world.sdf.reading import read_document
from harness.world.solid import MeshFile, Solid
from harness.world.solids.ground import Partition, map_bounds, partition
from harness.world.solids.kinds import Kinds
from harness.world.solids.pieces import obstacle_of, obstacles_of
from harness.world.solids.surface import Surface, chosen_grid, room_without_pits, surface_of
from harness.world.world import ORIGIN, STEEPEST_START, RoverNeeds, Start, World
from rover_metrics.errors import counted

LONG = 2000.0  # [m] of a mesh whose unit is doubted
START_ROOM = 0.7  # [m] around the start that is free
START_RESOLUTION = 0.1  # [m], or that of the heights
BUILT = {  # RGBA of what a file gives no colour: weathered concrete, not the rocks of the named terrains
    ObstacleKind.ROCK: (0.56, 0.52, 0.47, 1.0),
    ObstacleKind.HAZARD: (0.40, 0.42, 0.44, 1.0),
    ObstacleKind.DECK: (0.58, 0.57, 0.54, 1.0),
}


def solid_world(spec: WorldSpec, rover: RoverNeeds, seed: int) -> World:
    """Makes a world from an SDF file or a mesh.

    Args:
        spec: Names the file.
        rover: What a rover needs of a world.
        seed: Of the world, which has no randomness of its own.

    Raises:
        UsageError: It is not readable or cannot be driven.
    """
    path, resources = Path(spec.terrain), Resources([*map(Path, spec.resource_path)])
    try:
        if path.suffix.lower() in SUFFIXES:
            return assembled([Solid(path.stem, MeshFile(path), IDENTITY)], spec, rover, seed, [])
        document = read_document(path, resources)
        notes = [*document.notes]
        if document.actors:
            notes.append(f"actors: {', '.join(person.name for person in document.actors)}")
        # Gazebo reads the unit of COLLADA, not its up_axis: gz-common, graphics/src/ColladaLoader.cc.
        spec = spec.but(mesh_up=spec.mesh_up or "z")
        world = assembled(document.solids, spec, rover, seed, notes, is_loose=document.is_loose)
    except UsageError as error:
        message = str(error)
        for prefix in (f"{path}: ", f"mesh {path}: ", f"{path} "):
            message = message.removeprefix(prefix)
        raise UsageError(f"terrain {path}: {message}") from error
    hashes = {str(file): hashlib.sha256(file.read_bytes()).hexdigest() for file in document.files}
    return replace(world, gravity=document.gravity, files=(*hashes.items(), *world.files))


def assembled(
    solids: Sequence[Solid],
    spec: WorldSpec,
    rover: RoverNeeds,
    seed: int,
    notes: list[str],
    *,
    is_loose: bool = False,
) -> World:
    """Returns the world of some solids; UsageError if nothing of it can be driven.

    Args:
        solids: What can be collided with.
        spec: The terrain's name, and how the solids are to be taken.
        rover: What the rover needs of the world.
        seed: Of the world, which has no randomness of its own.
        notes: What is known of it; takes what was done.
        is_loose: Whether solids without a ground are put on a level plane.
    """
    kinds = Kinds(spec, rover.clearance, [solid.name for solid in solids])
    parts = partition(solids, notes, spec.mesh_unit, spec.mesh_up, is_loose=is_loose)
    grid = chosen_grid(map_bounds(parts), spec.terrain_cell)
    whole = joined(parts.ground)
    surface = surface_of(whole, grid, parts.plane, notes)
    ground = surface.ground
    relief = np.ptp(ground.heights[surface.has_floor])
    middle = f"middle at {grid.middle[0]:.4g},{grid.middle[1]:.4g}"
    notes.append(f"{ground.describe()}, relief {relief:.4g} m, {middle}")
    is_of_file = any(isinstance(solid.shape, MeshFile) for solid in parts.grounds)
    if is_of_file and not spec.mesh_unit and 2 * max(ground.half_size) > LONG:
        notes.append(f"its ground is taken to be in metres, more than {LONG:g} of them; --mesh-unit mm?")
    obstacles = _obstacles(parts, whole, surface, kinds, notes)
    friction = min((s.friction for s in parts.grounds if s.friction is not None), default=None)
    if friction is not None and friction < 1.0:
        notes.append(f"no wheel has more friction than {friction:g}, the lowest <mu> of its ground")
    world = World(
        Path(spec.terrain).name,
        ground,
        tuple(obstacles),
        seed,
        None,
        room=room_without_pits(surface),
        friction=friction,
        files=tuple((str(path), digest) for path, digest in sorted(parts.hashes.items())),
    )
    start = free_start(world, surface, rover.step_limit, notes) if rover.needs_start else ORIGIN
    return replace(world, start=start, notes=tuple(notes))


def _obstacles(
    parts: Partition, whole: Mesh, surface: Surface, kinds: Kinds, notes: list[str]
) -> list[Obstacle]:
    ground = surface.ground
    placed = [obstacle_of(solid, ground, kinds.of(solid.name)) for solid in parts.primitives]
    obstacles = [obstacle for obstacle in placed if obstacle is not None]
    over = joined([whole.part(surface.left_over)])
    obstacles += obstacles_of(over, ground, kinds.by_height, kinds.clearance)
    for solid, mesh in parts.standing:
        pieces = obstacles_of(joined([mesh]), ground, kinds.of(solid.name), kinds.clearance)
        obstacles += (replace(piece, color=solid.color) for piece in pieces)
    if buried := len(placed) - sum(obstacle is not None for obstacle in placed):
        notes.append(counted(buried, "solid", " in the ground or off the map: left out"))
    rocks, hazards, decks = (sum(o.kind is kind for o in obstacles) for kind in ObstacleKind)
    if obstacles:
        notes.append(
            counted(rocks, "rock", f" (no higher than {kinds.limit:g} m above the ground), ")
            + f"{counted(hazards, 'hazard')}, {counted(decks, 'facet', ' of decks')}"
        )
    return [replace(obstacle, color=obstacle.color or BUILT[obstacle.kind]) for obstacle in obstacles]


def free_start(world: World, surface: Surface, step_limit: float, notes: list[str]) -> Start:
    """Returns the free and gentle place nearest to the origin or the map's middle; else UsageError.

    Args:
        world: Ground and obstacles.
        surface: Where the ground has a floor.
        step_limit: Highest step that the rover climbs [m].
        notes: Takes the start, if it is neither.
    """
    ground = world.ground
    resolution = max(START_RESOLUTION, ground.cell)  # finer than its heights, kilometres take gigabytes
    cells = occupancy(world, math.radians(STEEPEST_START), step_limit, resolution)
    rows, columns = cells.cells.shape
    x_from, _, y_from, _ = ground.bounds()
    x, y = (
        (np.arange(count) + 0.5) * resolution + start
        for count, start in ((columns, x_from), (rows, y_from))
    )
    nearest = [
        np.rint((places - start) / ground.cell).astype(int).clip(0, count - 1)
        for places, start, count in zip((y, x), (y_from, x_from), ground.heights.shape, strict=True)
    ]
    free = (cells.cells == FREE) & surface.has_floor[np.ix_(*nearest)]
    room = distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * resolution
    wanted = (0.0, 0.0) if ground.contains(0.0, 0.0, EDGE_MARGIN) else ground.middle
    distance = np.hypot(y[:, None] - wanted[1], x[None, :] - wanted[0])
    fit = room >= START_ROOM
    if not fit.any():
        raise UsageError(
            f"there is no place of {START_ROOM:g} m around that is free and no steeper than "
            f"{STEEPEST_START:g} deg; choose a --start"
        )
    row, column = np.unravel_index(np.argmin(np.where(fit, distance, np.inf)), fit.shape)
    if distance[row, column] < resolution:
        return *wanted, 0.0
    start = round(float(x[column]), 3), round(float(y[row]), 3), 0.0
    notes.append(f"starts at {start[0]:g},{start[1]:g}, the free and gentle place next to its middle")
    return start
