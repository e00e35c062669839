"""The sensors' page says what the table and the options say."""

import re
from pathlib import Path

from ruamel.yaml import YAML

from harness.frames.rover_frames import rover_frames
from harness.robots import find_rover
from harness.sensors.choice import chosen

PAGE = (Path(__file__).parents[3] / "docs" / "sensors.md").read_text()


def test_the_rover_yaml_of_the_page_is_valid_and_its_frames_hang_together() -> None:
    (example,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    rover = find_rover("leo").but(sensors=tuple(YAML(typ="safe").load(example)["sensors"]))
    given = [row.given for row in chosen(rover, None) if row.given is not None]
    assert [(some.name, some.frame_id) for some in given] == [
        ("top", "top_link"),
        ("front", "front_link"),
        ("depth", "camera_frame_optical"),
    ]
    frames = rover_frames(rover, (frame for some in given for frame in some.frames(rover)))
    assert {some.frame_id for some in given} <= {link.name for link in frames.links}
