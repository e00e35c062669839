"""Where targets stand: at their places, in the world's metres or on the Earth, or at free ones."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

from harness.base.errors import UsageError, repeated
from harness.base.streams import TARGETS, generator
from harness.spec.target import MESH, TargetSpec
from harness.world.actors.free_space import FreeSpace, along
from harness.world.geodesy import Datum
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.targets.forms import FORMS, Place, Skin, gate

MOST_TARGETS = 100
TRIES = 1000
NEAREST = 2.0  # [m] from the rover's start to where a free place may be
ROOM = 0.5  # [m] around a free place without a hazard
APART = 2.0  # [m] at least between a free place and another target

Where = tuple[float, float]  # x, y in the world [m]


@dataclass(frozen=True, eq=False)
class Target:
    """Something to be found, where it stands."""

    name: str  # unique in its world
    spec: TargetSpec  # what asked for it
    position: tuple[float, float, float]  # of its middle on the ground, x, y, z in the world [m]
    yaw: float  # heading of its first face, of a gate its way through [rad]
    # x and y of a gate's left and right post, from before it; of others the place itself
    posts: tuple[Where, ...]
    bodies: tuple[Obstacle, ...]  # what it consists of, which are among the world's obstacles
    skins: tuple[Skin, ...] = ()  # what cameras see on them
    files: tuple[tuple[str, str], ...] = ()  # those that it was read from, each with its SHA-256

    def digest(self) -> bytes:
        """Returns what tells it from others beside its bodies, for the hash of a world."""
        seen = b"".join(part.tobytes() for skin in self.skins for part in (skin.vertices, skin.image))
        return f"{self.name} {self.spec.kind} {self.position} {self.yaw}".encode() + seen


def target_names(specs: Sequence[TargetSpec]) -> tuple[str, ...]:
    """Returns each target's name, its kind and a number without one; UsageError if two are the same."""
    if len(specs) > MOST_TARGETS:
        raise UsageError(f"{len(specs)} targets are too many; give at most {MOST_TARGETS}")
    names: list[str] = []
    for spec in specs:
        kind = "object" if spec.kind == MESH else spec.kind
        free = (name for name in chain((kind,), (f"{kind}{n}" for n in range(2, MOST_TARGETS + 2))))
        names.append(spec.name or next(name for name in free if name not in names))
    if twice := repeated(names):
        raise UsageError(f"two targets are called '{twice}'; give each a name of its own: NAME=KIND")
    return tuple(names)


def placed_targets(
    specs: Sequence[TargetSpec],
    ground: Heightfield,
    obstacles: Sequence[Obstacle],
    start: tuple[float, float],
    seed: int,
    datum: Datum,
) -> tuple[Target, ...]:
    """Returns targets on the ground.

    Args:
        specs: What is asked for.
        ground: On which they stand.
        obstacles: What stands there already; free places keep clear of hazards and of other targets.
        start: Where the rover starts: x, y [m].
        seed: Of free places, each drawn from a stream of its name.
        datum: Of latitudes and longitudes.

    Raises:
        UsageError: One is off the map, a file is not readable, or there is no room.
    """
    space = FreeSpace(ground, obstacles)
    names = target_names(specs)
    where = [_given_place(spec, datum) for spec in specs]
    taken = [place for place in where if place is not None]
    targets = []
    for name, spec, given in zip(names, specs, where, strict=True):
        place = given or _free_place(spec, name, space, start, seed, taken)
        taken += [] if given else [place]
        targets.append(_standing(spec, name, place, ground, start))
    return tuple(targets)


def _given_place(spec: TargetSpec, datum: Datum) -> Where | None:
    options = spec.options
    if options.x is not None and options.y is not None:
        return options.x, options.y
    if options.lat is not None and options.lon is not None:
        return datum.local(options.lat, options.lon)
    return None


def _free_place(
    spec: TargetSpec, name: str, space: FreeSpace, start: Where, seed: int, taken: Sequence[Where]
) -> Where:
    rng, within = generator(seed, TARGETS, name), spec.options.within
    for u, turn in rng.uniform((0.0, 0.0), (1.0, math.tau), size=(TRIES, 2)).tolist():
        distance = math.sqrt(NEAREST**2 + u * (within**2 - NEAREST**2))  # evenly over the ring
        place = start[0] + distance * math.cos(turn), start[1] + distance * math.sin(turn)
        if any(math.dist(place, other) < APART for other in taken):
            continue
        posts = _posts(spec, place, _heading(spec, place, start))
        if space.blocked(along((posts[0], posts[-1])), ROOM) is None:
            return place
    raise UsageError(
        f"target '{spec}': there is no free place within {within:g} m of the start; "
        "give x and y, or more within"
    )


def _heading(spec: TargetSpec, place: Where, start: Where) -> float:
    """The yaw of its options; else towards the start, of a gate away from it."""
    if spec.options.yaw is not None:
        return spec.options.yaw
    ends = (start, place) if spec.kind == "gate" else (place, start)
    return math.atan2(ends[1][1] - ends[0][1], ends[1][0] - ends[0][0])


def _posts(spec: TargetSpec, place: Where, yaw: float) -> tuple[Where, ...]:
    if spec.kind != "gate":
        return (place,)
    (x, y), half = place, 0.5 * spec.options.width
    left = -half * math.sin(yaw), half * math.cos(yaw)
    return (x + left[0], y + left[1]), (x - left[0], y - left[1])


def _standing(spec: TargetSpec, name: str, where: Where, ground: Heightfield, start: Where) -> Target:
    yaw = _heading(spec, where, start)
    posts = _posts(spec, where, yaw)
    for x, y in posts:
        ground.check_place(f"target '{spec}':", x, y)
    places = [(x, y, ground.height_at(x, y), yaw) for x, y in (where, *posts)]
    files: tuple[tuple[str, str], ...] = ()
    if spec.kind == "gate":
        # What is read from before it: its faces look back along the way through.
        facing = [(*place[:3], yaw + math.pi) for place in places[1:]]
        bodies, skins = gate(spec.options, *facing)
    elif spec.kind == MESH:
        bodies, skins, files = _mesh(spec, places[0], ground)
    else:
        bodies, skins = FORMS[spec.kind](spec.options, places[0])
    return Target(name, spec, places[0][:3], yaw, posts, bodies, skins, files)


def _mesh(
    spec: TargetSpec, place: Place, ground: Heightfield
) -> tuple[tuple[Obstacle, ...], tuple[Skin, ...], tuple[tuple[str, str], ...]]:
    from harness.world.targets.mesh import mesh_target  # noqa: PLC0415 - scipy's hulls, trimesh

    try:
        return mesh_target(spec, place, ground)
    except UsageError as error:
        raise UsageError(f"target '{spec}': {error}") from error
