"""The angles and axes of an attitude against SciPy's."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rover_metrics.core.rotation import matrix, roll_pitch, upright, yaw


def test_matrix_and_angles_of_an_attitude_are_those_of_scipy() -> None:
    for truth in (Rotation.identity(), *Rotation.random(200, random_state=1)):
        x, y, z, w = truth.as_quat().tolist()
        attitude = x, y, z, w
        np.testing.assert_allclose(matrix(attitude), truth.as_matrix(), atol=1e-12)
        heading, pitch, roll = truth.as_euler("ZYX")
        assert (*roll_pitch(attitude), yaw(attitude)) == pytest.approx((roll, pitch, heading), abs=1e-9)
        assert upright(attitude) == matrix(attitude)[2][2]


def test_a_pitch_of_ninety_degrees_is_no_domain_error() -> None:
    half = math.sqrt(0.5) + 1e-16
    assert roll_pitch((0.0, half, 0.0, half))[1] == pytest.approx(math.pi / 2)
