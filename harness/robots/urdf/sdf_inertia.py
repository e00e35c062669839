"""What shapes of SDF weigh that are full of one matter each: <inertial auto="true">."""

from collections.abc import Iterable
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError, told
from harness.base.sdf.poses import Transform
from harness.base.sdf.reader import numbers
from harness.robots.urdf.sdf_elements import SIZES

WATER = "1000"  # [kg/m^3], which SDF takes where no density is said
KINDS = {name: getattr(mujoco.mjtGeom, f"mjGEOM_{name.upper()}") for name in SIZES}
IN_HALVES = {"size": 0.5, "radius": 1.0, "length": 0.5}  # as MuJoCo has sizes


def lump_of(
    shapes: Iterable[tuple[Element, Transform, float]], link: str
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Returns mass [kg], centre, shape (3,) [m], and inertia about it, shape (3, 3) [kg m^2], of shapes.

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
