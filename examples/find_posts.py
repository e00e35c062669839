"""A node that is not part of the harness: it finds posts with ArUco markers in images, by OpenCV.

    pip install opencv-python-headless
    python examples/find_posts.py --ros-args -p use_sim_time:=true -p size:=0.15

Each marker is published on marker_ID as a PoseStamped in the camera's optical frame: z ahead, the
marker's own z out of its face.
"""

import math
from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
import rclpy
from geometry_msgs.msg import PoseStamped
from numpy.typing import NDArray
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image

SIDES = np.array([(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])  # corners as OpenCV orders them
LARGEST_ERROR = 2.0  # [pixels] between corners and those of the pose: more is no square


def detector(dictionary: str) -> cv2.aruco.ArucoDetector:
    """Returns a detector of a dictionary, e.g. "4x4_50", that takes no bit for another."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    parameters.errorCorrectionRate = 0.0
    known = getattr(cv2.aruco, f"DICT_{dictionary.upper()}")
    return cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(known), parameters)


def find(image: NDArray[np.uint8], by: cv2.aruco.ArucoDetector) -> list[tuple[int, NDArray[np.float32]]]:
    """Returns id and corners [pixels], shape (4, 2), of each marker in an RGB image."""
    corners, ids, _ = by.detectMarkers(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY))
    numbers = [] if ids is None else ids.ravel().tolist()
    return [(number, four.reshape(4, 2)) for number, four in zip(numbers, corners, strict=True)]


def pose(
    corners: NDArray[np.float32], size: float, matrix: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Returns where a marker is: position [m] and rotation vector [rad] in the optical frame.

    None where no square of that size looks so.

    Args:
        corners: As `find` returns them.
        size: Edge of the black square [m].
        matrix: Intrinsic matrix of the camera, which has no distortion, shape (3, 3).
    """
    square = np.column_stack([0.5 * size * SIDES, np.zeros(4)])
    known, turned, place = cv2.solvePnP(square, corners, matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    if not known:
        return None
    again, _ = cv2.projectPoints(square, turned, place, matrix, None)
    if np.abs(again.reshape(4, 2) - corners).max() > LARGEST_ERROR:
        return None
    return place.ravel(), turned.ravel()


class FindPosts(Node):
    """Looks for markers in each image of image_raw, once camera_info has told the lens."""

    def __init__(self, topics: Mapping[str, str] | None = None) -> None:
        super().__init__("find_posts")
        topics = topics or {"image": "camera/image_raw", "info": "camera/camera_info"}
        dictionary = self.declare_parameter("dictionary", "4x4_50").value
        self._size = float(self.declare_parameter("size", 0.15).value)
        self._detector, self._matrix = detector(dictionary), None
        self._markers: dict[int, Any] = {}  # a publisher each
        self.create_subscription(CameraInfo, topics["info"], self._on_info, 10)
        self.create_subscription(Image, topics["image"], self._on_image, 10)

    def _on_info(self, info: CameraInfo) -> None:
        self._matrix = np.array(info.k).reshape(3, 3)

    def _on_image(self, image: Image) -> None:
        if self._matrix is None or image.encoding != "rgb8":
            return
        pixels = np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)
        for number, corners in find(pixels, self._detector):
            found = pose(corners, self._size, self._matrix)
            if found is not None:
                self._publish(number, image, *found)

    def _publish(
        self, number: int, image: Image, place: NDArray[np.float64], turned: NDArray[np.float64]
    ) -> None:
        if number not in self._markers:
            self._markers[number] = self.create_publisher(PoseStamped, f"marker_{number}", 10)
        message, angle = PoseStamped(header=image.header), float(np.linalg.norm(turned))
        x, y, z = (turned * (math.sin(angle / 2) / angle if angle else 0.0)).tolist()
        message.pose.position.x, message.pose.position.y, message.pose.position.z = place.tolist()
        orientation = message.pose.orientation
        orientation.x, orientation.y, orientation.z, orientation.w = x, y, z, math.cos(angle / 2)
        self._markers[number].publish(message)


def main() -> None:
    """Runs the node until Ctrl-C."""
    try:
        with rclpy.init():
            rclpy.spin(FindPosts())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
