"""One step of all wheels on a bed of soil, as MuJoCo calls it: compiled by numba.

`BED` is what the step is passed: arrays, those of MuJoCo by its names, and numbers.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.base.passing import doubles, integers, layout, pointer, reader, singles
from harness.soil.prints import Frame, Grids, Pair, heap, let_near_touch, level, press_down
from harness.soil.rim import Doubles
from harness.soil.wheel_force import REBOUND, UNPLACED, wheel_force

HEAPED = 0.002  # [m] of the height of a cell, which are put beside a wheel at a time
FELT = 8  # numbers that are passed of a wheel

NUMBERS = ("x", "y", "cell", "base", "relief", "dt", "solid_cell")
OWN = (
    "soils",  # a row for each, as Soil.numbers
    "sizes",  # of each wheel: radius, width [m], grousers, 1 where its axis points left, else -1
    "ids",  # of each wheel: body, joint and root body
    "spins",  # of each wheel: its degrees of freedom, first and last, and its servo, -1 for none
    "inertias",  # of each wheel: armatures of these, its inertia [kg m^2], the servo's gain [N m s]
    "virgin",  # the grids of `prints`
    "surface",
    "field",
    "states",
    "felt",  # sinkage [m], forces ahead, left, up [N], speed of rim and hub [m/s], rut ahead [m]
    "near",  # geoms that are no wheel and touch soil
    "boxes",  # middle and half sizes of these
    "solid",  # heights that they meet [m]
    "patches",  # which soil lies there
)
MUJOCO: tuple[str, ...] = ("xpos", "xaxis", "cvel", "subtree_com", "xipos", "xfrc_applied")
MUJOCO += ("geom_xpos", "geom_xmat", "geom_conaffinity", "dof_armature")
MUJOCO += ("ctrl", "actuator_velocity", "actuator_forcerange")
BED = layout((*OWN, *MUJOCO), NUMBERS)
_passed = reader(BED)

Triple = tuple[float, float, float]
# spins, inertias, and MuJoCo's dof_armature to actuator_forcerange.
Motors = tuple[NDArray[np.int64], Doubles, Doubles, Doubles, Doubles, Doubles]


@inlined
def _ground_under(virgin: Doubles, at: Pair, ahead: Pair, size: Pair, cell: float) -> Triple:
    """Height of the ground without ruts under a wheel [m], its slopes ahead and to the left."""
    (u, v), (ex, ey), (r, b) = at, ahead, size
    lx, ly = 0.8 * r / cell, 0.4 * b / cell
    middle = level(virgin, u, v)
    front, back = level(virgin, u + lx * ex, v + lx * ey), level(virgin, u - lx * ex, v - lx * ey)
    left, right = level(virgin, u - ly * ey, v + ly * ex), level(virgin, u + ly * ey, v - ly * ex)
    slope_x, slope_y = (front - back) / (1.6 * r), (left - right) / (0.8 * b)
    return (2.0 * middle + front + back + left + right) / 6.0, slope_x, slope_y


@inlined
def _cross(a: Triple, b: Triple) -> Triple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def _rut(virgin: Doubles, surface: Doubles, u: float, v: float) -> float:
    """Depth of the ruts there [m], none where soil is heaped."""
    return max(level(virgin, u, v) - level(surface, u, v), 0.0)


@inlined
def _make_implicit(motors: Motors, wheel: int, inertia: float, dt: float) -> None:
    """Gives a wheel's rim the inertia with which a step is implicit in what turns it.

    That is the soil's, and that of a servo at its limit. MuJoCo takes its torque as constant there, and
    a step may turn a small error round; on soil, which yields, the rim would tremble for ever.

    Args:
        motors: Of all wheels.
        wheel: Which.
        inertia: What the soil asks for [kg m^2].
        dt: [s].
    """
    spins, inertias, armature, command, speed, limits = motors
    servo, gain = spins[wheel, 2], inertias[wheel, 3]
    if servo >= 0:
        asked = gain * abs(command[servo, 0] - speed[servo, 0])
        if asked > limits[servo, 1]:
            bare = inertias[wheel, 2] + inertia
            inertia += max(limits[servo, 1] / asked * (bare + gain * dt) - bare, 0.0)
    for k in range(2):
        armature[spins[wheel, k], 0] = inertias[wheel, k] + inertia


@inlined
def _press(  # noqa: PLR0913, PLR0917 - MuJoCo's arrays one by one, as numba takes them
    soils: Doubles,
    sizes: Doubles,
    ids: NDArray[np.int64],
    grids: Grids,
    frame: Frame,
    states: Doubles,
    felt: Doubles,
    moving: tuple[Doubles, Doubles, Doubles, Doubles, Doubles],
    pushed: Doubles,
    motors: Motors,
    dt: float,
    patches: NDArray[np.uint8],
    patch_cell: float,
) -> None:
    """Presses all wheels into the ground for one step; `moving` is MuJoCo's xpos to xipos."""
    xpos, xaxis, cvel, subtree_com, xipos = moving
    virgin, surface, _ = grids
    x0, y0, cell = frame[0], frame[1], frame[2]
    for i in range(ids.shape[0]):
        body, joint, root = ids[i, 0], ids[i, 1], ids[i, 2]
        r, b, to_left = sizes[i, 0], sizes[i, 1], sizes[i, 3]
        hub = xpos[body, 0], xpos[body, 1], xpos[body, 2]
        axle = to_left * xaxis[joint, 0], to_left * xaxis[joint, 1], to_left * xaxis[joint, 2]
        flat = math.sqrt(axle[0] * axle[0] + axle[1] * axle[1])
        ex, ey = (axle[1] / flat, -axle[0] / flat) if flat > 1e-6 else (1.0, 0.0)
        u, v = (hub[0] - x0) / cell, (hub[1] - y0) / cell
        height, slope_x, slope_y = _ground_under(virgin, (u, v), (ex, ey), (r, b), cell)
        up = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
        normal = (slope_y * ey - slope_x * ex) * up, (-slope_x * ey - slope_y * ex) * up, up
        tilt = _dot(normal, axle)
        reach = r * math.sqrt(max(1.0 - tilt * tilt, 0.0)) + 0.5 * b * abs(tilt)
        sinkage = reach - (hub[2] - height) * up
        # Ahead is across the axle and along the ground, left is across both.
        fx, fy, fz = _cross(axle, normal)
        norm = math.sqrt(fx * fx + fy * fy + fz * fz)
        ahead = (fx / norm, fy / norm, fz / norm) if norm > 1e-6 else (fx, fy, fz)
        left = _cross(normal, ahead)
        turning = cvel[body, 0], cvel[body, 1], cvel[body, 2]
        arm = hub[0] - subtree_com[root, 0], hub[1] - subtree_com[root, 1], hub[2] - subtree_com[root, 2]
        moves = (
            cvel[body, 3] + turning[1] * arm[2] - turning[2] * arm[1],
            cvel[body, 4] + turning[2] * arm[0] - turning[0] * arm[2],
            cvel[body, 5] + turning[0] * arm[1] - turning[1] * arm[0],
        )
        velocity = (_dot(turning, axle) * r, _dot(moves, ahead), _dot(moves, left), _dot(moves, normal))
        length = r * math.sin(math.acos(1.0 - min(max(sinkage, 0.0), r) / r)) / cell + 1.2
        rut = _rut(virgin, surface, u + length * ex, v + length * ey)
        behind = _rut(virgin, surface, u - length * ex, v - length * ey)
        row = min(max(int((hub[1] - y0) / patch_cell + 0.5), 0), patches.shape[0] - 1)
        col = min(max(int((hub[0] - x0) / patch_cell + 0.5), 0), patches.shape[1] - 1)
        soil, size = soils[patches[row, col]], (r, b, sizes[i, 2])
        pull, side, lift, brake, inertia = wheel_force(
            soil, size, (sinkage, rut), (sinkage, behind), velocity, states[i], dt
        )
        force = (
            pull * ahead[0] + side * left[0] + lift * normal[0],
            pull * ahead[1] + side * left[1] + lift * normal[1],
            pull * ahead[2] + side * left[2] + lift * normal[2],
        )
        _make_implicit(motors, i, inertia, dt)
        tilting = side * (r - 0.5 * max(sinkage, 0.0))  # the side force acts at the ground
        off = hub[0] - xipos[body, 0], hub[1] - xipos[body, 1], hub[2] - xipos[body, 2]
        moment = _cross(off, force)
        for k in range(3):
            pushed[body, k] = force[k]
            pushed[body, 3 + k] = moment[k] - brake * axle[k] + tilting * ahead[k]
        felt[i, 0], felt[i, 1], felt[i, 2], felt[i, 3] = sinkage, pull, side, lift
        felt[i, 4], felt[i, 5], felt[i, 6], felt[i, 7] = velocity[0], velocity[1], velocity[2], rut
        if lift > 0.0 and soil[REBOUND] < 1.0:
            place, plane = (hub[0], hub[1]), (height, slope_x, slope_y, sinkage)
            moved = states[i, UNPLACED]
            moved += press_down(grids, frame, place, (ex, ey), (r, b), plane)
            reach = r * math.sin(math.acos(1.0 - min(sinkage, r) / r))
            if moved > HEAPED and heap(grids, frame, place, (ex, ey), (reach, b), moved):
                moved = 0.0
            states[i, UNPLACED] = moved


@kernel("void(int64)")
def press_bed(address: int) -> None:
    """Presses the wheels of a bed for one step; what it is passed stands at that address."""
    passed = _passed(address)
    affinity = passed.geom_conaffinity
    solid = doubles(passed.solid)
    let_near_touch(
        integers(passed.near).ravel(),
        doubles(passed.boxes),
        (doubles(passed.geom_xpos), doubles(passed.geom_xmat)),
        numba.carray(pointer(affinity[0]), (affinity[1],), np.int32),
        solid,
        (passed.x, passed.y, passed.solid_cell),
    )
    _press(
        doubles(passed.soils),
        doubles(passed.sizes),
        integers(passed.ids),
        (doubles(passed.virgin), doubles(passed.surface), singles(passed.field)),
        (passed.x, passed.y, passed.cell, passed.base, passed.relief),
        doubles(passed.states),
        doubles(passed.felt),
        (
            doubles(passed.xpos),
            doubles(passed.xaxis),
            doubles(passed.cvel),
            doubles(passed.subtree_com),
            doubles(passed.xipos),
        ),
        doubles(passed.xfrc_applied),
        (
            integers(passed.spins),
            doubles(passed.inertias),
            doubles(passed.dof_armature),
            doubles(passed.ctrl),
            doubles(passed.actuator_velocity),
            doubles(passed.actuator_forcerange),
        ),
        passed.dt,
        numba.carray(pointer(passed.patches[0]), solid.shape, np.uint8),
        passed.solid_cell,
    )
