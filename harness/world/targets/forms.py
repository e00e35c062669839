"""What targets are made of: bodies, which everything meets, and skins, which cameras see on them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harness.spec.target import DICTIONARIES, TargetOptions
from harness.world.obstacles import Color, Obstacle, ObstacleKind, convex, orientation

Points = NDArray[np.float64]
Place = tuple[float, float, float, float]  # x, y, z of the ground [m], yaw [rad]
Vector3 = tuple[float, float, float]
Bodies = tuple[Obstacle, ...]

SUNK = 0.1  # [m] of everything that stands, below the ground at its middle
# [m] Radius of a marker's pole, half the thickness of a board of one or two faces.
POLE, BOARD = 0.025, 0.01
LIFT = 0.002  # [m] of a skin off its body, so that the body does not show through
WHITE, WOOD = (0.85, 0.85, 0.85, 1.0), (0.45, 0.31, 0.16, 1.0)
ORANGE, BLUE = (0.95, 0.35, 0.05, 1.0), (0.12, 0.35, 0.75, 1.0)
# [m] A rubber mallet as shops have it: radius and length of its head and its handle.
HEAD, HANDLE = (0.03, 0.10), (0.0125, 0.28)
# [m] A wide-mouth bottle of one litre: radius and height of its body, of its neck with the cap.
BOTTLE, NECK = (0.045, 0.17), (0.0315, 0.045)
CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])  # right and up of a face
IMAGE = np.array([(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)])  # right and down in its picture
QUAD = np.array([(0, 1, 2), (0, 2, 3)])


@dataclass(frozen=True, eq=False)
class Skin:
    """A picture on triangles, which is seen and not touched."""

    vertices: Points  # in the world [m], shape (v, 3)
    faces: NDArray[np.int64]  # numbers of vertices, shape (f, 3), counter-clockwise from outside
    picture: Points  # where in the image each vertex is, right and down, 0 to 1, shape (v, 2)
    image: NDArray[np.uint8]  # RGB, shape (height, width, 3)


Made = tuple[Bodies, tuple[Skin, ...]]


def _upright(
    shape: Literal["box", "cylinder"], half: Sequence[float], place: Place, base: float, color: Color
) -> Obstacle:
    """Returns a box or a cylinder that stands upright, its foot `base` metres above the ground."""
    x, y, z, yaw = place
    at = (x, y, z + base + half[-1])
    return Obstacle(ObstacleKind.HAZARD, shape, tuple(half), at, orientation(yaw), color=color)


def _lying(half: tuple[float, float], at: Vector3, across: float, color: Color) -> Obstacle:
    """Returns a cylinder that lies; its axis is at right angles to the heading `across` [rad]."""
    turned = orientation(across, 0.5 * math.pi)
    return Obstacle(ObstacleKind.HAZARD, "cylinder", half, at, turned, color=color)


def _pole(place: Place, radius: float, height: float, color: Color) -> Obstacle:
    """A pole that reaches up to a height above the ground [m]."""
    return _upright("cylinder", (radius, 0.5 * (height + SUNK)), place, -SUNK, color)


def _marker_post(options: TargetOptions, place: Place, marker: int) -> Made:
    """Returns a pole with a prism at its top whose sides carry a marker: three in URC 2023."""
    edge, count = face_edge(options.dictionary, options.size), options.faces
    if not count:
        return (_pole(place, POLE, options.height + 0.5 * edge, WHITE),), ()
    x, y, z, yaw = place
    middle = np.array([x, y, z + options.height])
    inner = BOARD if count < 3 else 0.5 * edge / math.tan(math.pi / count)
    skins = []
    for side in range(count):
        turn = yaw + (math.pi * side if count < 3 else math.tau * side / count)
        normal = np.array([math.cos(turn), math.sin(turn), 0.0])
        right = np.array([-normal[1], normal[0], 0.0])  # of a viewer in front of it
        across = CORNERS[:, :1] * right + CORNERS[:, 1:] * np.array([0.0, 0.0, 1.0])
        corners = middle + (inner + LIFT) * normal + 0.5 * edge * across
        skins.append(Skin(corners, QUAD, IMAGE, face_image(options.dictionary, marker)))
    foot = options.height - 0.5 * edge
    if count == 3:
        rim = np.concatenate([skin.vertices for skin in skins]) - middle
        inside = inner / (inner + LIFT)
        hull = convex(ObstacleKind.HAZARD, middle + rim * [inside, inside, 1.0])
        head = replace(hull, color=WHITE)
    else:
        thickness = BOARD if count < 3 else 0.5 * edge
        head = _upright("box", (thickness, 0.5 * edge, 0.5 * edge), place, foot, WHITE)
    return (_pole(place, POLE, foot, WOOD), head), tuple(skins)


def post(options: TargetOptions, place: Place) -> Made:
    """Returns a plain post."""
    return (_pole(place, options.radius, options.height, ORANGE),), ()


def gate(options: TargetOptions, left: Place, right: Place) -> Made:
    """Returns two posts with the markers of `id` and the next one.

    Args:
        options: Their height, size and markers.
        left: x, y, z of the ground [m], yaw [rad].
        right: x, y, z of the ground [m], yaw [rad].
    """
    (one, seen), (other, also) = (
        _marker_post(options, at, options.id + n) for n, at in enumerate((left, right))
    )
    return (*one, *other), (*seen, *also)


def mallet(_: TargetOptions, place: Place) -> Made:
    """Returns an orange rubber mallet that lies on the ground, its handle along the heading."""
    x, y, z, yaw = place
    (radius, length), (thin, handle) = HEAD, HANDLE
    along = 0.5 * handle + radius
    where = (x + along * math.cos(yaw), y + along * math.sin(yaw), z + radius)
    return (
        _lying((radius, 0.5 * length), (x, y, z + radius), yaw, ORANGE),
        _lying((thin, 0.5 * handle), where, yaw + 0.5 * math.pi, WOOD),
    ), ()


def bottle(_: TargetOptions, place: Place) -> Made:
    """Returns a bottle of one litre that stands on the ground, 21.5 cm high and 9 cm wide."""
    (radius, height), (thin, neck) = BOTTLE, NECK
    body = _upright("cylinder", (radius, 0.5 * height), place, 0.0, BLUE)
    return (body, _upright("cylinder", (thin, 0.5 * neck), place, height, WHITE)), ()


FORMS: dict[str, Callable[[TargetOptions, Place], Made]] = {
    "aruco": lambda options, place: _marker_post(options, place, options.id),
    "post": post,
    "mallet": mallet,
    "bottle": bottle,
}


# OpenCV's published dictionaries of ArUco markers: cv2.aruco's own, without its 70 MB.
CODES = Path(__file__).with_name("aruco.txt")
CELL = 16  # [pixels] of a cell in an image


@lru_cache(maxsize=1)
def _codes() -> dict[str, str]:
    lines = CODES.read_text(encoding="ascii").splitlines()
    return dict(line.split(maxsplit=1) for line in lines if not line.startswith("#"))


def cells(dictionary: str, marker: int) -> NDArray[np.bool_]:
    """Returns which cells of the marker of an id are white, shape (n + 2, n + 2); its border is not."""
    _, n = DICTIONARIES[dictionary]
    digits = -(-n * n // 4)
    codes = _codes()
    code = codes.get(dictionary) or codes[dictionary.rpartition("_")[0]]
    number = int(code[digits * marker :][:digits], 16)
    bits = [number >> place & 1 for place in reversed(range(n * n))]
    return np.pad(np.array(bits, bool).reshape(n, n), 1)


@lru_cache(maxsize=64)
def face_image(dictionary: str, marker: int) -> NDArray[np.uint8]:
    """Returns a marker in a white margin of one cell, as URC prints it: RGB, shape (p, p, 3)."""
    white = np.pad(cells(dictionary, marker), 1, constant_values=True)
    grey = np.kron(white, np.full((CELL, CELL), 255)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def face_edge(dictionary: str, size: float) -> float:
    """Returns the edge of a face by that of its marker's black square [m]: 0.2 m of 0.15 m in 4x4."""
    _, n = DICTIONARIES[dictionary]
    return size * (n + 4) / (n + 2)
