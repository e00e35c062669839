"""Shapes, limits, losses, followers and sensors of SDF in the words of URDF, and what shapes weigh."""

import math
import re
from collections.abc import Iterable, Iterator
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError, told
from harness.base.sdf.poses import Transform
from harness.base.sdf.reader import numbers, text_of
from harness.robots.frames.urdf import text_of_numbers
from rover_metrics.number import number

SIZES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}
SIZES["capsule"] = SIZES["cylinder"]
KINDS = {name: getattr(mujoco.mjtGeom, f"mjGEOM_{name.upper()}") for name in SIZES}
IN_HALVES = {"size": 0.5, "radius": 1.0, "length": 0.5}  # as MuJoCo has sizes
WATER = "1000"  # [kg/m^3], which SDF takes where no density is said
FRAME_TAGS = ("gz_frame_id", "ignition_frame_id", "frame_name", "frameName")  # of plugins, too


def angle_seen(sensor: Element) -> float:
    """Returns the angle that a sensor sees [rad], to a tenth; 0 of a single ray, as of cliff sensors."""
    horizontal = next(sensor.iter("horizontal"), None)
    if horizontal is None:
        return 2 * math.pi
    usual = {"samples": "640", "min_angle": "0", "max_angle": "0"}
    text = " ".join(text_of(horizontal, tag, value) for tag, value in usual.items())
    samples, start, end = numbers(text, 3, f"<horizontal> of sensor '{sensor.get('name')}'")
    return round(end - start, 1) if samples > 1 else 0.0


def frame_of(sensor: Element) -> str:
    """Returns the frame that a sensor's messages are in, in letters of a link's name; "" if untold."""
    told = (item.text or "" for tag in FRAME_TAGS for item in sensor.iter(tag))
    return re.sub(r"\W", "_", next(told, "").strip().lstrip("/").replace("::", "_"))


def shape_of(part: Element, owner: str) -> Element | str:
    """Returns the shape of a visual or a collision as in URDF, or why there is none.

    Args:
        part: The visual or collision.
        owner: What it is called in messages.
    """
    shape = next(iter(part.find("geometry") or ()), None)
    if shape is None:
        return "it has no shape"
    if shape.tag == "mesh":
        if text_of(shape.find("submesh"), "name"):
            return "a part of a mesh is not taken alone"
        scale = text_of_numbers(numbers(text_of(shape, "scale", "1 1 1"), 3, f"<scale> of {owner}"))
        return Element("mesh", filename=text_of(shape, "uri", text_of(shape, "filename")), scale=scale)
    if shape.tag not in SIZES:
        return f"no shape here is a <{shape.tag}>"
    sizes = {tag: text_of(shape, tag) for tag in SIZES[shape.tag]}
    for tag, text in sizes.items():
        numbers(text, 3 if tag == "size" else 1, f"<{tag}> of {owner}")
    return Element(shape.tag, sizes)


def lump_of(
    shapes: Iterable[tuple[Element, Transform, float]], link: str
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Returns mass [kg], centre, shape (3,) [m], and inertia about it, shape (3, 3) [kg m^2], of shapes.

    Each is full of one matter, as <inertial auto="true"> says.

    Args:
        shapes: Each one, as `shape_of` gives it, its pose, shape (4, 4), and its density [kg/m^3].
        link: What they belong to, for messages.

    Raises:
        UsageError: There is none, or one of which that is not known.
    """
    spec = mujoco.MjSpec()
    body, quaternion, matrix = spec.worldbody.add_body(), np.empty(4), np.empty(9)
    for shape, pose, density in shapes:
        if shape.tag not in KINDS:
            raise UsageError(
                f"link '{link}' leaves its inertia to a mesh; give <mass> and <inertia>, not auto"
            )
        mujoco.mju_mat2Quat(quaternion, pose[:3, :3].ravel())
        size = [
            IN_HALVES[tag] * value
            for tag, text in shape.items()
            for value in numbers(text, len(text.split()), f"a shape of link '{link}'")
        ]
        of = {"size": [*size, 0.0, 0.0][:3], "pos": pose[:3, 3], "quat": quaternion, "density": density}
        body.add_geom(type=KINDS[shape.tag], **of)
    try:
        model = spec.compile()
    except ValueError as error:
        raise UsageError(f"shapes of link '{link}' have no inertia: {told(error)}") from error
    if not (mass := float(model.body_mass[1])) > 0.0:
        raise UsageError(
            f"link '{link}' leaves its inertia to shapes that weigh nothing; give <density>"
        )
    mujoco.mju_quat2Mat(matrix, model.body_iquat[1])
    turned = matrix.reshape(3, 3)
    return mass, model.body_ipos[1].copy(), turned @ np.diag(model.body_inertia[1]) @ turned.T


def limit_of(limit: Element | None, tag: str) -> float:
    """Returns a limit of a joint, which may be inf; without one SDF's usual."""
    usual = {"lower": "-1e16", "upper": "1e16"}.get(tag, "-1")
    try:
        return number(text_of(limit, tag, usual))
    except ValueError as error:
        raise UsageError(f"<{tag}> of a joint: {error}") from error


def dynamics_of(dynamics: Element | None) -> Iterator[tuple[str, str]]:
    """Yields what URDF says of losses in a joint, and the spring that it has no word for."""
    for tag in ("damping", "friction", "spring_stiffness", "spring_reference"):
        text = text_of(dynamics, tag, "0")
        yield tag, text_of_numbers(numbers(text, 1, f"<{tag}> of a joint"))


def mimic_of(mimic: Element, name: str) -> dict[str, str]:
    """Returns SDF's multiplier x (leader - reference) + offset as multiplier x leader + offset."""
    usual = {"multiplier": "1", "offset": "0", "reference": "0"}
    texts = [text_of(mimic, tag, value) for tag, value in usual.items()]
    multiplier, offset, reference = numbers(" ".join(texts), 3, f"<mimic> of joint '{name}'")
    values = text_of_numbers([multiplier]), text_of_numbers([offset - multiplier * reference])
    return {"joint": mimic.get("joint", ""), "multiplier": values[0], "offset": values[1]}
