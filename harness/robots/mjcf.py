"""A shipped rover's model as text: sizes, joints and limits, read without MuJoCo.

The process that only publishes does without MuJoCo, so that its first row comes sooner.
"""

import math
from xml.etree import ElementTree as ET

from harness.robots.sections import Drive

EXACTLY_BACKWARD = 1e-6  # [rad]


def stated_by_mjcf(root: ET.Element) -> dict[str, object]:
    """Returns what a model's file, as models/README.md has it, states of a rover, by the field's name.

    For any other file it raises AttributeError, KeyError, ValueError or IndexError.
    """
    defaults: dict[str, dict[str, dict[str, str]]] = {}
    for top in root.findall("default"):
        _gather(top, {}, defaults)

    def numbers(match: ET.Element | None, attribute: str) -> list[float]:
        """An attribute of the element, or else of its class."""
        element: ET.Element = match  # type: ignore[assignment]  # None raises, and the caller reports it
        of_class = defaults.get(element.get("class", "main"), {}).get(element.tag, {})
        return [float(word) for word in (of_class | element.attrib)[attribute].split()]

    drives = root.findall("actuator/*")
    wheel = root.find(".//geom[@name='wheel_FL']")
    driven = tuple(drive.attrib["joint"] for drive in drives)
    site = root.find(".//site[@name='lidar']")
    lidar = numbers(site, "pos")
    turned = [float(word) for word in site.get("euler", "0 0 0").split()] if site is not None else []
    joints = (joint.attrib["name"] for joint in root.findall("worldbody//joint"))
    return {
        "drive": Drive(left=driven[: len(driven) // 2], right=driven[len(driven) // 2 :], driven=driven),
        "passive_joints": tuple(name for name in joints if name not in driven),
        "wheel_radius": numbers(wheel, "size")[0],
        "wheel_width": 2 * numbers(wheel, "size")[1],
        "wheel_friction": numbers(wheel, "friction")[0],
        "wheel_speed_limit": numbers(drives[0], "ctrlrange")[1],
        "lidar_x": lidar[0],
        "lidar_y": lidar[1],
        "lidar_z": lidar[2],
        "lidar_yaw": math.pi if math.pi - abs(turned[2]) < EXACTLY_BACKWARD else turned[2],
        "steered_wheels": (),
        "gravity": -numbers(root.find("option"), "gravity")[2],
    }


def _gather(
    node: ET.Element,
    inherited: dict[str, dict[str, str]],
    defaults: dict[str, dict[str, dict[str, str]]],
) -> None:
    """Takes down the attributes of a default class and of those in it, by element."""
    own = {item.tag: inherited.get(item.tag, {}) | item.attrib for item in node}
    defaults[node.get("class", "main")] = of_class = inherited | own
    for nested in node.findall("default"):
        _gather(nested, of_class, defaults)
