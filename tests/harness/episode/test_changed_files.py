"""A file that has changed under its name counts anew in a process that knew the old one."""

import json
import os
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest

from harness.episode.assembly import graded_world
from harness.episode.episode import Episode
from harness.episode.fingerprint import StreamHash
from harness.robots import ROVERS
from harness.spec.run import Run
from tests.golden.drive import BOX, MODEL, SDF

TETRAHEDRON = "v {0} {0} 0\nv -{0} {0} 0\nv 0 -{0} 0\nv 0 0 {0}\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n"
LEO = (ROVERS["leo"].folder / "leo.xml").read_text()
BUMPS, HALVES = (
    (np.arange(101) // 20 % 2).repeat(101).reshape(101, 101),
    np.indices((401, 401))[1] // 201,
)
MESH = MODEL.format("m", "1 0 0.2 0 0 0", "<mesh><uri>rock.obj</uri></mesh>")
INCLUDE = "<include><uri>model://box</uri><name>other</name><pose>1 0 0.5 0 0 0</pose></include>"
IN_FOLDER: dict[str, Any] = {  # that is written with all cases
    "mesh.sdf": SDF.replace("</world>", MESH + "</world>"),
    "includes.sdf": SDF.replace("</world>", INCLUDE + "</world>"),
    "box/model.config": "<model><name>box</name><sdf>model.sdf</sdf></model>",
    "guy/model.config": "<model><name>guy</name><sdf>model.sdf</sdf></model>",
    "crowd.sdf": SDF.replace("</world>", "<include><uri>model://guy</uri></include></world>"),
    "soil.yaml": "soils: [dry_sand, firm]\nmap: soil.npy\n",
}
WALK = (
    "<sdf version='1.9'><actor name='guy'><script><trajectory id='0' type='walk'><waypoint>"
    "<time>1</time><pose>{0} 1 0 0 0 0</pose></waypoint></trajectory></script></actor></sdf>"
)
BOXED = "<sdf version='1.9'>" + MODEL.format("b", "0 0 0 0 0 0", BOX) + "</sdf>"
BOXES = BOXED.format("1 1 1"), BOXED.format("1 2 1")
WALKS = WALK.format(2), WALK.format(3)
ROCKS = TETRAHEDRON.format(0.3), TETRAHEDRON.format(0.5)
BEHIND = LEO.replace('name="lidar" pos="0.174 0', 'name="lidar" pos="0.1 0')
# The file that changes, what it holds before and after, and options that name it or what leads to it.
CASES: dict[str, tuple[Any, Any, dict[str, Any]]] = {
    "bumps.npy": (0.01 * BUMPS, 0.02 * BUMPS, {"terrain": "{}/bumps.npy", "terrain_size": (14.0, 14.0)}),
    "rock.obj": (*ROCKS, {"terrain": "{}/mesh.sdf"}),
    "box/model.sdf": (*BOXES, {"terrain": "{}/includes.sdf", "resource_path": ["{}"]}),
    "target.obj": (*ROCKS, {"targets": ["{}/target.obj:x=1,y=0"]}),
    "soil.npy": (HALVES, 1 - HALVES, {"soil": "{}/soil.yaml"}),
    "guy/model.sdf": (*WALKS, {"terrain": "{}/crowd.sdf", "resource_path": ["{}"]}),
    "leo/leo.xml": (LEO, BEHIND, {"robot": "{}/leo"}),
}


def write(path: Path, content: Any, at_s: float) -> None:  # noqa: ANN401 - text or numbers
    path.parent.mkdir(exist_ok=True)
    if isinstance(content, str):
        path.write_text(content)
    else:
        np.save(path, content.astype(np.uint8 if content.dtype.kind == "i" else float))
    os.utime(path, (at_s, at_s))  # of which clocks tell no more than some milliseconds


def driven(folder: Path, options: dict[str, Any]) -> tuple[str, dict[str, bytes]]:
    """The hash of a short run, and where it could drive."""
    told = json.loads(
        json.dumps({"terrain": "posts", "duration": 0.5} | options).replace("{}", str(folder))
    )
    run, stream = Run.of(**told), StreamHash()
    for batch in Episode(run).batches():
        stream.take(batch)
    return stream.hexdigest(), {k: v.tobytes() for k, v in graded_world(run).layers.items()}


@pytest.mark.parametrize("name", CASES)
def test_a_file_that_has_changed_gives_what_it_gives_under_a_new_name(name: str, tmp_path: Path) -> None:
    _, after, options = CASES[name]
    for place in ("a", "b"):
        copytree(ROVERS["leo"].folder, tmp_path / place / "leo")
        for file, content in (IN_FOLDER | {n: first for n, (first, *_) in CASES.items()}).items():
            write(tmp_path / place / file, content, 1_000_000_000)
    old = driven(tmp_path / "a", options)
    write(tmp_path / "a" / name, after, 1_000_000_000.25)
    write(tmp_path / "b" / name, after, 1_000_000_000.25)
    assert old != driven(tmp_path / "a", options) == driven(tmp_path / "b", options)
